"""A driver who tries everything, and the drive that results."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from app.science.arrays import FloatArray
from app.science.vehicle.model import Vehicle
from app.science.virtualcar import kernels
from app.science.virtualcar.engine import RADPS_PER_RPM, EngineModel
from app.science.virtualcar.road import Road, RouteName

STEP_S = 0.005
ENGINE_ON_S = 1.5
LEAVE_S = 10.0
ENGINE_OFF_BEFORE_END_S = 2.0
_VARIATION_STEP_S = 0.25


@dataclass(frozen=True, slots=True)
class Drive:
    """What the car did, every `STEP_S`; arrays of shape (n,).

    Attributes
    ----------
    t_s, speed_mps, distance_m : array
    thrust_n : array
        All force along the road that is not a resistance, held over the step: engine, engine drag and brakes; at
        standstill what holds the car on the slope.
    gear : array
        0 while the clutch is open or slips.
    engine_speed_radps, engine_angle_rad : array
    fuel_power_w, fuel_energy_j : array
    """

    t_s: FloatArray
    speed_mps: FloatArray
    distance_m: FloatArray
    thrust_n: FloatArray
    gear: FloatArray
    engine_speed_radps: FloatArray
    engine_angle_rad: FloatArray
    fuel_power_w: FloatArray
    fuel_energy_j: FloatArray


def drive(
    road: Road, vehicle: Vehicle, engine: EngineModel, route: RouteName, duration_s: float, rng: np.random.Generator
) -> Drive:
    """Drive a road with changing styles of acceleration, shifting and cruising.

    Parameters
    ----------
    road : Road
    vehicle : Vehicle
    engine : EngineModel
    route : str
        ``full-load`` always opens the throttle fully.
    duration_s : float
        The car stands at the beginning and at the end.
    rng : numpy.random.Generator
    """
    steps = round(duration_s / STEP_S) + 1
    full_load = np.array(engine.full_load)
    phi, table_omega, table_nm, table_w = engine.kernel_arrays()
    points = int(duration_s / _VARIATION_STEP_S) + 2
    rows = kernels.drive_kernel(
        STEP_S,
        steps,
        ENGINE_ON_S,
        LEAVE_S,
        duration_s - ENGINE_OFF_BEFORE_END_S,
        float(road.distance_m[1]),
        road.pitch_rad,
        road.curvature_v_radpm,
        road.limit_mps,
        road.stop_m,
        road.stop_wait_s,
        _styles(road, route, rng),
        _traffic(points, rng),
        1.0 + (0.0 if route == "full-load" else 0.12) * _wander(points, 3.0, rng),
        _VARIATION_STEP_S,
        rng.uniform(0.3, 0.6, 64),
        np.array(vehicle.gear_ratios) / vehicle.wheel_radius_m,
        np.array([vehicle.accelerated_mass_kg(g) for g in range(len(vehicle.gear_ratios) + 1)]),
        vehicle.mass_kg,
        vehicle.crr,
        vehicle.drag_area_kgpm,
        vehicle.gravity_mps2,
        vehicle.idle_rpm * RADPS_PER_RPM,
        full_load[:, 0] * RADPS_PER_RPM,
        full_load[:, 1],
        engine.drag_nm,
        engine.drag_nm_per_radps,
        engine.fuel_cut_rpm * RADPS_PER_RPM,
        phi,
        table_omega,
        table_nm,
        table_w,
        engine.idle_fuel_power_w,
    )
    omega = np.ascontiguousarray(rows[:, kernels.ENGINE_SPEED])
    fuel = np.ascontiguousarray(rows[:, kernels.FUEL_POWER])
    angle = np.zeros(steps)
    np.cumsum(0.5 * STEP_S * (omega[1:] + omega[:-1]), out=angle[1:])
    energy = np.zeros(steps)
    np.cumsum(STEP_S * fuel[:-1], out=energy[1:])
    return Drive(
        t_s=np.asarray(np.arange(steps) * STEP_S, dtype=np.float64),
        speed_mps=np.ascontiguousarray(rows[:, kernels.SPEED]),
        distance_m=np.ascontiguousarray(rows[:, kernels.DISTANCE]),
        thrust_n=np.ascontiguousarray(rows[:, kernels.THRUST]),
        gear=np.ascontiguousarray(rows[:, kernels.GEAR]),
        engine_speed_radps=omega,
        engine_angle_rad=angle,
        fuel_power_w=fuel,
        fuel_energy_j=energy,
    )


def _styles(road: Road, route: RouteName, rng: np.random.Generator) -> FloatArray:
    """One row per stretch of a few hundred metres, columns as `kernels` names them."""
    begins = np.cumsum(rng.uniform(200.0, 900.0, int(road.distance_m[-1] / 500.0) + 2))
    n = len(begins)
    styles = np.empty((n, kernels.STYLE_COLUMNS))
    styles[:, kernels.STYLE_FROM_M] = begins - begins[0]
    styles[:, kernels.STYLE_ACCELERATION] = rng.uniform(0.7, 3.0, n)
    styles[:, kernels.STYLE_PEDAL] = rng.uniform(0.3, 1.05, n)
    shift_up = rng.uniform(1900.0, 5500.0, n)
    if route == "full-load":
        styles[:, kernels.STYLE_ACCELERATION] = 9.0
        styles[:, kernels.STYLE_PEDAL] = 1.0
        shift_up = rng.uniform(3500.0, 5900.0, n)
    styles[:, kernels.STYLE_SHIFT_UP] = shift_up
    styles[:, kernels.STYLE_SHIFT_DOWN] = np.maximum(1150.0, 0.6 * shift_up)
    styles[:, kernels.STYLE_LAUNCH] = rng.uniform(1200.0, 1900.0, n)
    styles[:, kernels.STYLE_SPEED] = rng.uniform(0.85, 1.0, n)
    return styles


def _traffic(points: int, rng: np.random.Generator) -> FloatArray:
    """How much of the allowed speed the traffic lets through: mostly all, now and then much less."""
    slow = _wander(points, 40.0, rng)
    fast = _wander(points, 8.0, rng)
    return np.clip(0.97 + 0.03 * fast - 0.25 * np.maximum(slow - 0.8, 0.0), 0.3, 1.0)


def _wander(points: int, correlation_s: float, rng: np.random.Generator) -> FloatArray:
    """Smooth zero-mean, unit-variance noise every `_VARIATION_STEP_S`."""
    width = max(int(correlation_s / _VARIATION_STEP_S), 1)
    window = np.hanning(2 * width + 3)[1:-1]
    window /= np.sqrt(np.sum(window**2))
    return np.convolve(rng.standard_normal(points + len(window) - 1), window, mode="valid")
