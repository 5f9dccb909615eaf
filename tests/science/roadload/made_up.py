"""Windows of a made-up car whose road load is known exactly."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from app.science.arrays import FloatArray
from app.science.roadload.windows import Regime, RoadLoadWindows
from app.science.vehicle.model import Vehicle
from tests.synthetic import RATIOS

CAR = Vehicle(
    gear_ratios=RATIOS, max_power_w=60e3, max_power_rpm=5250.0, max_torque_nm=110.0, displacement_l=0.698, crr=0.010
)


def made_up(
    count: int = 1500, *, seed: int = 1, mass_kg: float = CAR.mass_kg, noise_mps2: float = 0.0, coasting: int = 0
) -> RoadLoadWindows:
    """Drive `CAR`, of another mass if wanted, in all gears with an engine whose power is a polynomial of its fuel.

    The last ``coasting`` windows roll with an open clutch; every third of these brakes.
    """
    rng = np.random.default_rng(seed)
    gear = rng.integers(1, 7, count)
    omega = rng.uniform(130.0, 500.0, count)
    speed = omega / np.array(RATIOS)[gear - 1] * CAR.wheel_radius_m
    fuel = rng.uniform(12e3, 120e3, count)
    kind = np.full(count, Regime.DRIVE, np.int8)
    power = engine_power_w(omega, fuel)
    rolls = np.arange(count) >= count - coasting
    kind[rolls], gear[rolls] = Regime.COAST, 0
    omega[rolls], fuel[rolls] = 90.0, 4e3
    brakes = np.where(np.arange(count) % 3 == 0, -rng.uniform(0.2, 2.0, count), 0.0)
    slope = rng.normal(0.0, 0.02, count)
    normal = CAR.gravity_mps2 * np.sqrt(1.0 - slope**2)
    push = np.where(rolls, brakes, power / (mass_kg * speed))
    force = push - CAR.drag_area_kgpm / mass_kg * speed**2 - CAR.crr * normal
    return RoadLoadWindows(
        t_s=2.0 * np.arange(count),
        length_s=np.full(count, 2.0),
        kind=kind,
        gear=gear.astype(np.int8),
        speed_mps=speed,
        speed_squared_m2ps2=speed**2,
        normal_mps2=normal,
        slope=slope,
        acceleration_mps2=force - CAR.gravity_mps2 * slope,
        engine_speed_radps=omega,
        fuel_power_w=fuel,
        torque_nm=np.where(rolls, np.nan, power / omega / 0.95),
        specific_force_mps2=force + rng.normal(0.0, 1.0, count) * noise_mps2,
        specific_force_sd_mps2=np.full(count, max(noise_mps2, 0.001)),
        thrust_n=push * mass_kg,
        mass_kg=CAR.mass_kg,
        drag_area_kgpm=CAR.drag_area_kgpm,
        crr=CAR.crr,
        gravity_mps2=CAR.gravity_mps2,
        bias_sd_mps2=0.001,
    )


def engine_power_w(omega: FloatArray, fuel_w: FloatArray) -> FloatArray:
    """Power at the wheels: friction that grows with speed, and a marginal efficiency that falls towards full load."""
    return np.asarray(0.40 * fuel_w - 6e-7 * fuel_w**2 - 8.0 * omega - 0.02 * omega**2)


def told(cd: float, crr: float) -> Vehicle:
    """Return `CAR` with another file: so many times its drag and its rolling resistance."""
    return replace(CAR, cd=CAR.cd * cd, crr=CAR.crr * crr)
