"""How one knows that a drive over a distance is the best: Hamiltonian, maximality, and a convex programme."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from app.science.arrays import FloatArray
from app.science.optimal.answer import Certificate, Independent, Verdict
from app.science.optimal.controllability import bracket_rank
from app.science.optimal.distance.convex import Lines, least_fuel_j
from app.science.optimal.distance.course import Course
from app.science.optimal.distance.extremals import Extremal
from app.science.optimal.distance.hull import lower_hull
from app.science.optimal.distance.legs import Car
from app.science.optimal.fuel_checks import fuel_power_w, full_load_nm
from app.science.optimal.problem import RADPS_PER_RPM, Distance, PolynomialEngine, Route

GRID = 241
MOST_LINES = 60
SMOOTH, FAILS = 1e-5, 1e-3
AGREES = 3e-3
NOTHING_J, NOTHING_W = 1.0, 1.0
SLOWEST_MPS = 1e-3


@dataclass(frozen=True, slots=True)
class Controls:
    """A dense grid of what the engine can do, each array of shape (n,): power at the wheels, fuel power, W."""

    power_w: FloatArray
    fuel_w: FloatArray


def controls_of(problem: Distance | Route) -> Controls:
    """Return the grid straight from the problem, not from the curve that the solution uses."""
    engine = problem.engine
    if not isinstance(engine, PolynomialEngine):
        c0, c1, c2 = engine.willans
        power = np.linspace(
            0.0 if problem.transmission.neutral else max(engine.power_w[0], 0.0), engine.power_w[1], 4001
        )
        return Controls(power, c0 + c1 * power + c2 * power**2)
    omega = np.linspace(*engine.speed_rpm, GRID)[:, None] * RADPS_PER_RPM
    top = full_load_nm(engine, omega / RADPS_PER_RPM)
    torque = engine.torque_nm[0] + np.linspace(0.0, 1.0, GRID) * np.maximum(top - engine.torque_nm[0], 0.0)
    able = np.broadcast_to(top >= engine.torque_nm[0], torque.shape)
    power, fuel = (omega * torque)[able], fuel_power_w(engine, omega, torque)[able]
    if problem.transmission.neutral:
        power, fuel = np.append(power, 0.0), np.append(fuel, engine.idle_fuel_power_w)
    return Controls(power, fuel)


def hamiltonian_w(car: Car, course: Course, price_n: float) -> FloatArray:
    """Return H = λ_x v + λ_v v' − F along a drive, W; where the car stands still, what it is a moment later."""
    v = np.maximum(course.speed_mps, SLOWEST_MPS)
    rate = (course.power_w / v - car.resistance_n(v)) / car.load.accelerated_mass_kg
    h = price_n * course.speed_mps + course.lambda_v * rate - car.curve.fuel_w(course.power_w)
    return np.asarray(h[course.speed_mps >= SLOWEST_MPS])


def beaten_by_w(car: Car, course: Course, price_n: float, controls: Controls, force_n: float) -> float:
    """Return the largest H − μ over the grid of controls along a drive, W; μ is 0, as the time is free."""
    rows = np.flatnonzero(course.speed_mps >= SLOWEST_MPS)
    rows = rows[np.unique(np.linspace(0, rows.size - 1, 400).astype(np.int64))]
    most = -np.inf
    for k in rows:
        v = float(course.speed_mps[k])
        slope = float(course.lambda_v[k]) / (car.load.accelerated_mass_kg * v)
        gained = np.where(controls.power_w <= force_n * v, slope * controls.power_w - controls.fuel_w, -np.inf).max()
        most = max(most, price_n * v - slope * v * car.load.resistance_n(v) + float(gained))
    return most


def bounding_lines(controls: Controls, force_n: float) -> Lines:
    """Return the straight lines below which no control burns, for the convex programme."""
    order = np.lexsort((controls.fuel_w, controls.power_w))
    p, f = controls.power_w[order], controls.fuel_w[order]
    start = int(f.argmin())
    p, f = p[start:], f[start:]
    apart = np.flatnonzero(np.diff(p, prepend=-np.inf) > 1e-9 * p[-1])
    p, f = p[apart], f[apart]
    corners = lower_hull(p, f)
    thin = np.unique(np.linspace(0, len(corners) - 1, MOST_LINES).astype(np.int64))
    corners = corners[np.unique(np.concatenate((thin, [0, min(1, len(corners) - 1)])))]
    slope = np.diff(f[corners]) / np.diff(p[corners])
    return Lines(slope, f[corners][:-1] - slope * p[corners][:-1], (float(p[0]), float(p[-1])), (-1e6, force_n))


def certify(problem: Distance, car: Car, drive: Extremal, course: Course, notes: tuple[str, ...]) -> Certificate:
    """Check a drive.

    Parameters
    ----------
    problem, car
    drive : Extremal
    course : Course
        Its costate integrated backwards by its own equation from λ_v(T) = 0.
    notes : tuple of str
    """
    force = problem.engine.force_n[1] if not isinstance(problem.engine, PolynomialEngine) else 1e6
    controls = controls_of(problem)
    h = hamiltonian_w(car, course, drive.price_n)
    most = max(float(car.curve.fuel_w(course.power_w).max()), NOTHING_W)
    beaten = beaten_by_w(car, course, drive.price_n, controls, force)
    # where concave fuel power ends at a force limit, its hull changes with the speed: no convex programme then
    concave = not isinstance(problem.engine, PolynomialEngine) and problem.engine.willans[2] < 0.0
    lines = bounding_lines(controls, force)
    other = None if concave else least_fuel_j(car.load, lines, problem.from_speed_mps, problem.distance_m)
    gap = None if other is None else (drive.fuel_j - other) / max(drive.fuel_j, NOTHING_J)
    return Certificate(
        hamiltonian_drift_w=float(np.ptp(h)),
        transversality=float(abs(h[-1])),
        max_h_minus_mu_w=beaten,
        independent=None
        if gap is None
        else Independent("convex programme over distance, on the fuel's convex hull", gap),
        verdict=_verdict(drive, float(np.ptp(h)) / most, beaten / most, gap),
        notes=notes,
        more={"controllable": _controllable(car, course)},
    )


def _verdict(drive: Extremal, drift: float, beaten: float, gap: float | None) -> Verdict:
    if drive.family == "pulses":
        return "best found"
    if beaten > FAILS:
        return "rejected"
    if drift <= SMOOTH and beaten <= SMOOTH:
        return "optimal" if gap is not None and abs(gap) <= AGREES else "extremal"
    return "best found"


def _controllable(car: Car, course: Course) -> bool:
    """Tell whether power at the wheels moves distance and speed independently, along the whole drive."""
    mass = car.load.accelerated_mass_kg
    ranks = [
        bracket_rank(
            lambda x: np.array([x[1], -(car.load.drag_kgpm * x[1] ** 2 + car.load.rolling_n) / mass]),
            lambda x: np.array([0.0 * x[0], 1.0 / (mass * x[1])]),
            (0.0, float(v)),
        )
        for v in np.quantile(course.speed_mps[course.speed_mps >= SLOWEST_MPS], np.linspace(0.0, 1.0, 9))
    ]
    return min(ranks, default=0) == 2
