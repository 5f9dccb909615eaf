"""What else could have been done at each point of a drive: the Hamiltonian of every gear beside that of the drive."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np

from app.science.arrays import FloatArray, IntArray
from app.science.optimal.costs.weighted import WeightedDrive
from app.science.optimal.fuel_checks import fuel_power_w, full_load_nm
from app.science.optimal.problem import RADPS_PER_RPM, DriveProblem, PolynomialEngine, RoadLoad, WillansDrive

LOOKS = 41
SLOWEST_MPS = 1e-3


@dataclass(frozen=True, slots=True)
class Moments:
    """Points of a drive, each array of shape (n,).

    Attributes
    ----------
    speed_mps, slope : array
        The second is dz/ds, 0 on the level.
    gear : int array
    engine_speed_radps, torque_nm : array
        NaN in neutral, and where the drive is known from the wheels only.
    fuel_power_w, brake_n : array
    lambda_v, lambda_x : array
        Costates of speed, J s/m, and of distance, J/m.
    """

    speed_mps: FloatArray
    slope: FloatArray
    gear: IntArray
    engine_speed_radps: FloatArray
    torque_nm: FloatArray
    fuel_power_w: FloatArray
    brake_n: FloatArray
    lambda_v: FloatArray
    lambda_x: FloatArray


def resistance_n(load: RoadLoad, speed_mps: FloatArray, slope: FloatArray) -> FloatArray:
    """Return drag, rolling resistance and what the slope takes, N; ``slope`` is sin θ = dz/ds."""
    upright = np.sqrt(1.0 - slope**2)
    weight = load.mass_kg * load.gravity_mps2
    return np.asarray(load.drag_kgpm * speed_mps**2 + weight * (load.crr * upright + slope))


def hamiltonian_w(problem: DriveProblem, m: Moments) -> FloatArray:
    """Return H = λ_x v + λ_v v' − P of the drive itself, W, shape (n,); NaN where the car stands still.

    P is what the problem counts: fuel power, or the weighted cost that stands in for it.
    """
    engine = problem.engine
    if isinstance(engine, WillansDrive):
        power = _willans_power_w(engine.fuel if isinstance(engine, WeightedDrive) else engine, m.fuel_power_w)
        c0, c1, c2 = engine.willans
        cost = c0 + c1 * power + c2 * power**2
    else:
        power = np.nan_to_num(m.engine_speed_radps * m.torque_nm)
        pulling = np.isfinite(m.torque_nm)
        in_gear = fuel_power_w(engine, np.nan_to_num(m.engine_speed_radps), np.nan_to_num(m.torque_nm))
        cost = np.where(pulling, in_gear, engine.idle_fuel_power_w)
    return _h(problem.load, m, power / _moving(m.speed_mps) - m.brake_n, cost)


def best_of_gears_w(problem: DriveProblem, m: Moments) -> dict[str, FloatArray]:
    """Return the largest H that each gear allows at every point, W, by its name; NaN where the gear can't be used.

    A CVT and a Willans drive have one entry, over all that they allow.
    """
    engine, transmission = problem.engine, problem.transmission
    found: dict[str, FloatArray] = {}
    share = np.linspace(0.0, 1.0, LOOKS)
    brakes = _over(_h(problem.load, m, np.full(m.speed_mps.shape, -n), 0.0) for n in (0.0, problem.brake_max_n))
    if isinstance(engine, WillansDrive):
        v = _moving(m.speed_mps)
        reach = np.clip(engine.power_w[0] + share[:, None] * np.ptp(engine.power_w), None, engine.force_n[1] * v)
        c0, c1, c2 = engine.willans
        pulls = [_h(problem.load, m, p / v, c0 + c1 * p + c2 * p**2) for p in reach]
        return {"any power": _over([*pulls, brakes - c0])}
    if transmission.kind == "cvt":
        omegas = np.linspace(*engine.speed_rpm, LOOKS) * RADPS_PER_RPM
        found["any ratio"] = _over(_best_at(problem, engine, m, np.full(m.speed_mps.shape, w), share) for w in omegas)
    for k, ratio in enumerate(transmission.ratios):
        omega = m.speed_mps * ratio / problem.load.wheel_radius_m
        found[f"gear {k + 1}"] = _best_at(problem, engine, m, omega, share)
    if transmission.neutral:
        found["neutral"] = brakes - engine.idle_fuel_power_w
    return found


def _best_at(
    problem: DriveProblem, engine: PolynomialEngine, m: Moments, omega: FloatArray, share: FloatArray
) -> FloatArray:
    """Return the largest H over torque at engine speeds, rad/s; NaN outside the engine's range."""
    rpm = omega / RADPS_PER_RPM
    low, high = engine.speed_rpm
    top = full_load_nm(engine, rpm)
    able = (rpm >= low * (1.0 - 1e-9)) & (rpm <= high * (1.0 + 1e-9)) & (top >= engine.torque_nm[0])
    torques = [engine.torque_nm[0] + part * np.maximum(top - engine.torque_nm[0], 0.0) for part in share]
    v = _moving(m.speed_mps)
    best = _over(_h(problem.load, m, omega * t / v, fuel_power_w(engine, omega, t)) for t in torques)
    return np.where(able, best, np.nan)


def _h(load: RoadLoad, m: Moments, pull_n: FloatArray, fuel_w: FloatArray | float) -> FloatArray:
    rate = (pull_n - resistance_n(load, m.speed_mps, m.slope)) / load.accelerated_mass_kg
    return np.asarray(m.lambda_x * m.speed_mps + m.lambda_v * rate - fuel_w)


def _moving(speed_mps: FloatArray) -> FloatArray:
    return np.where(speed_mps >= SLOWEST_MPS, speed_mps, np.nan)


def _over(rows: Iterable[FloatArray]) -> FloatArray:
    return np.asarray(np.max(np.stack(list(rows)), axis=0))


def _willans_power_w(drive: WillansDrive, fuel_w: FloatArray) -> FloatArray:
    """Return the power at the wheels that burns so much, on the branch where fuel grows with power."""
    c0, c1, c2 = drive.willans
    if c2 == 0.0:
        return (fuel_w - c0) / c1
    return np.asarray((np.sqrt(np.maximum(c1**2 + 4.0 * c2 * (fuel_w - c0), 0.0)) - c1) / (2.0 * c2))
