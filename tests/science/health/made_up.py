"""Windows of trips drawn straight from the physics, with no simulator and no observer, for quick tests."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from app.science.roadload.windows import Regime, RoadLoadWindows
from app.science.vehicle.model import Vehicle
from app.science.virtualcar.engine import EngineModel
from app.science.virtualcar.specification import DEFAULT_CAR

CAR = DEFAULT_CAR
ENGINE = EngineModel()
FORCE_SD_N = 25.0
BIAS_SD_MPS2 = 0.0012


@dataclass(frozen=True, slots=True)
class Truth:
    """What is off: rolling resistance and drag in %, mass in kg, efficiency in %."""

    rolling_resistance: float = 0.0
    mass: float = 0.0
    drag: float = 0.0
    efficiency: float = 0.0


def made_up_windows(seed: int, truth: Truth = Truth(), count: int = 500, vehicle: Vehicle = CAR) -> RoadLoadWindows:
    """Draw windows in all gears, uphill and downhill, at steady speed and accelerating."""
    rng = np.random.default_rng(seed)
    mass, gravity = vehicle.mass_kg + truth.mass, vehicle.gravity_mps2
    gear = rng.integers(1, 7, count)
    rpm = rng.uniform(1500.0, 4500.0, count)
    turning = rpm * np.pi / 30.0
    speed = turning * vehicle.wheel_radius_m / np.array(vehicle.gear_ratios)[gear - 1]
    torque = rng.uniform(0.15, 0.95, count) * ENGINE.full_load_nm(rpm)
    fuel = ENGINE.fuel_power_w(turning, torque) / (1.0 + 0.01 * truth.efficiency)
    rolling = vehicle.crr * (1.0 + 0.01 * truth.rolling_resistance) * mass * gravity
    drag = vehicle.drag_area_kgpm * (1.0 + 0.01 * truth.drag) * speed**2
    bias = BIAS_SD_MPS2 * rng.standard_normal()
    noise = FORCE_SD_N / vehicle.mass_kg * rng.standard_normal(count)
    specific = (torque * turning / speed - drag - rolling) / mass + bias + noise
    t = np.linspace(0.0, 1800.0, count)
    flat, unknown = np.zeros(count), np.full(count, np.nan)
    return RoadLoadWindows(
        t_s=t,
        length_s=np.full(count, 2.0),
        kind=np.full(count, Regime.DRIVE, np.int8),
        gear=gear.astype(np.int8),
        speed_mps=speed,
        speed_squared_m2ps2=speed**2,
        normal_mps2=np.full(count, gravity),
        slope=flat,
        acceleration_mps2=specific,
        engine_speed_radps=turning,
        fuel_power_w=fuel,
        torque_nm=unknown,
        specific_force_mps2=specific,
        specific_force_sd_mps2=np.full(count, FORCE_SD_N / vehicle.mass_kg),
        thrust_n=torque * turning / speed,
        mass_kg=vehicle.mass_kg,
        drag_area_kgpm=vehicle.drag_area_kgpm,
        crr=vehicle.crr,
        gravity_mps2=gravity,
        bias_sd_mps2=BIAS_SD_MPS2,
    )
