"""A driver who tries everything, and the drive that results."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from app.science.arrays import FloatArray, IntArray
from app.science.vehicle.model import Vehicle
from app.science.virtualcar import drive_kernels
from app.science.virtualcar.drive_kernels import CarNumbers, DriverNumbers, RoadNumbers
from app.science.virtualcar.engine import RADPS_PER_RPM, SMART_FULL_LOAD, EngineModel
from app.science.virtualcar.road import ROAD_STEP_M, Road
from app.science.virtualcar.specification import RouteName

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
    gear : integer array
        0 while the clutch is open or slips.
    engine_speed_radps, engine_angle_rad : array
    fuel_power_w : array
        Held over the step.
    fuel_energy_j : array
    """

    t_s: FloatArray
    speed_mps: FloatArray
    distance_m: FloatArray
    thrust_n: FloatArray
    gear: IntArray
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
    done = drive_kernels.drive(
        STEP_S,
        steps,
        RoadNumbers(ROAD_STEP_M, road.pitch_rad, road.curvature_v_radpm, road.limit_mps, road.stop_m, road.stop_wait_s),
        _car_numbers(vehicle, engine),
        engine.fuel_numbers(),
        _driver_numbers(vehicle, engine, route, float(road.distance_m[-1]), duration_s, rng),
    )
    omega = done.engine_radps
    angle, energy = np.zeros(steps), np.zeros(steps)
    np.cumsum(0.5 * STEP_S * (omega[1:] + omega[:-1]), out=angle[1:])
    np.cumsum(STEP_S * done.fuel_w[:-1], out=energy[1:])
    return Drive(
        t_s=np.asarray(np.arange(steps) * STEP_S, dtype=np.float64),
        speed_mps=done.speed_mps,
        distance_m=done.distance_m,
        thrust_n=done.thrust_n,
        gear=done.gear,
        engine_speed_radps=omega,
        engine_angle_rad=angle,
        fuel_power_w=done.fuel_w,
        fuel_energy_j=energy,
    )


def accelerated_masses(vehicle: Vehicle) -> FloatArray:
    """Accelerated mass by gear, the open clutch first, kg."""
    return np.array([vehicle.accelerated_mass_kg(gear) for gear in range(len(vehicle.gear_ratios) + 1)])


def _car_numbers(vehicle: Vehicle, engine: EngineModel) -> CarNumbers:
    full_load = np.array(engine.full_load)
    return CarNumbers(
        ratio_1pm=np.array(vehicle.gear_ratios) / vehicle.wheel_radius_m,
        accelerated_kg=accelerated_masses(vehicle),
        mass_kg=vehicle.mass_kg,
        crr=vehicle.crr,
        drag_kgpm=vehicle.drag_area_kgpm,
        gravity_mps2=vehicle.gravity_mps2,
        idle_radps=vehicle.idle_rpm * RADPS_PER_RPM,
        full_load_radps=full_load[:, 0] * RADPS_PER_RPM,
        full_load_nm=np.ascontiguousarray(full_load[:, 1]),
        drag_nm=engine.drag_nm,
        drag_nm_per_radps=engine.drag_nm_per_radps,
        cut_radps=engine.fuel_cut_rpm * RADPS_PER_RPM,
    )


def _driver_numbers(
    vehicle: Vehicle,
    engine: EngineModel,
    route: RouteName,
    road_m: float,
    duration_s: float,
    rng: np.random.Generator,
) -> DriverNumbers:
    """Draw a style for every few hundred metres; engine speeds scale with how far the engine revs."""
    from_m = np.cumsum(rng.uniform(200.0, 900.0, int(road_m / 500.0) + 2))
    n = len(from_m)
    revs = engine.full_load[-1][0] / SMART_FULL_LOAD[-1][0]
    hurried = route == "full-load"
    shift_up = revs * (rng.uniform(3500.0, 5900.0, n) if hurried else rng.uniform(1900.0, 5500.0, n))
    idle = vehicle.idle_rpm
    points = int(duration_s / _VARIATION_STEP_S) + 2
    return DriverNumbers(
        engine_on_s=ENGINE_ON_S,
        leave_s=LEAVE_S,
        engine_off_s=duration_s - ENGINE_OFF_BEFORE_END_S,
        from_m=from_m - from_m[0],
        acceleration_mps2=np.full(n, 9.0) if hurried else rng.uniform(0.7, 3.0, n),
        pedal=np.ones(n) if hurried else rng.uniform(0.3, 1.05, n),
        shift_up_radps=shift_up * RADPS_PER_RPM,
        shift_down_radps=np.maximum(1.35 * idle, 0.6 * shift_up) * RADPS_PER_RPM,
        launch_radps=rng.uniform(1.4 * idle, 1.4 * idle + 700.0 * revs, n) * RADPS_PER_RPM,
        speed_share=rng.uniform(0.85, 1.0, n),
        variation_s=_VARIATION_STEP_S,
        traffic=_traffic(points, rng),
        pedal_variation=1.0 + (0.0 if hurried else 0.12) * _wander(points, 3.0, rng),
        shift_s=rng.uniform(0.3, 0.6, 64),
    )


def _traffic(points: int, rng: np.random.Generator) -> FloatArray:
    """How much of the allowed speed the traffic lets through: mostly nearly all, now and then much less."""
    slow = _wander(points, 40.0, rng)
    fast = _wander(points, 8.0, rng)
    return np.clip(0.97 + 0.03 * fast - 0.25 * np.maximum(slow - 0.8, 0.0), 0.3, 1.0)


def _wander(points: int, correlation_s: float, rng: np.random.Generator) -> FloatArray:
    """Smooth noise of zero mean and unit variance every `_VARIATION_STEP_S`."""
    width = max(int(correlation_s / _VARIATION_STEP_S), 1)
    window = np.hanning(2 * width + 3)[1:-1]
    window /= np.sqrt(np.sum(window**2))
    return np.convolve(rng.standard_normal(points + len(window) - 1), window, mode="valid")
