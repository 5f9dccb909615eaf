"""Routes of 8 and 100 km, beside dynamic programming in plain NumPy for a known price of a second."""

from __future__ import annotations

import numpy as np

from app.cli.bench.figure import Figure, timed
from app.science.arrays import FloatArray
from app.science.optimal.answer import Answer
from app.science.optimal.fuel_checks import fuel_power_w
from app.science.optimal.problem import Engine, PolynomialEngine, Road, RoadLoad, Route, Transmission, WillansDrive
from app.science.optimal.route.answering import answer

WILLANS = WillansDrive((5000.0, 2.2, 1e-5), (0.0, 40_000.0), (0.0, 4000.0))
PER_KM_S = 60.0
SPEEDS = 60
STAGES = 160


def hills(length_m: float, points: int) -> Road:
    """Return a road of hills, five limits in turn."""
    s = np.linspace(0.0, length_m, points)
    high = 40.0 * np.sin(2.0 * np.pi * s / 4000.0) + 10.0 * np.sin(2.0 * np.pi * s / 1100.0)
    limit = np.array([25.0, 20.0, 25.0, 14.0, 25.0])[(s / 1600.0).astype(np.int64) % 5]
    return Road(tuple(s.tolist()), tuple(high.tolist()), tuple(limit.tolist()))


def routes(load: RoadLoad, engine: PolynomialEngine, ratios: tuple[float, ...]) -> list[Figure]:
    """Return the times of answers with polish and certificate, each solved once before."""
    geared = Transmission("gears", ratios, neutral=True, shift_cost_j=3000.0)
    cases: list[tuple[str, Engine, Transmission, float, int, str]] = [
        ("8 km with six gears", engine, geared, 8000.0, 81, "at most 3 s"),
        ("8 km with a Willans drive", WILLANS, Transmission("cvt"), 8000.0, 81, "at most 1 s"),
        ("100 km with six gears, 2000 points", engine, geared, 100_000.0, 2000, "at most 40 s"),
    ]
    figures = []
    for name, drive, gears, length_m, points, goal in cases:
        road = hills(length_m, points)
        problem = Route(load, drive, gears, road, 10.0, 10.0, 5.0, PER_KM_S * length_m / 1000.0, 4000.0)
        found: list[Answer] = []
        if length_m < 20_000.0:
            answer(problem)
        ours_s = timed(lambda p=problem, f=found: f.append(answer(p)))  # type: ignore[misc]
        price = found[0].multiplier_w
        plain_s = timed(lambda p=problem, mu=price: least_by_numpy(p, mu))  # type: ignore[misc]
        figures.append(Figure(name, ours_s, "s", plain_s, "one price on a grid in NumPy", goal=goal))
    return figures


def least_by_numpy(problem: Route, mu_w: float) -> float:
    """Return the least fuel, price of time and charges on a coarse even grid of speeds, J."""
    load, road = problem.load, problem.road
    edges = np.linspace(road.distance_m[0], road.distance_m[-1], STAGES + 1)
    step = edges[1] - edges[0]
    sine = np.diff(np.interp(edges, road.distance_m, road.elevation_m)) / step
    v = np.linspace(problem.min_speed_mps, max(road.speed_limit_mps), SPEEDS)
    begin, end = v[:, None], v[None, :]
    middle, seconds = 0.5 * (begin + end), 2.0 * step / (begin + end)
    push = load.accelerated_mass_kg * (end**2 - begin**2) / (2.0 * step) + load.drag_kgpm * middle**2
    limit = np.array(road.speed_limit_mps)[np.searchsorted(road.distance_m, edges[:-1], side="right") - 1]
    after = np.full((len(problem.transmission.ratios) + 1, SPEEDS), np.inf)
    after[:, np.abs(v - problem.to_speed_mps).argmin()] = 0.0
    for one, highest in zip(sine[::-1], limit[::-1], strict=True):
        force = push + load.mass_kg * load.gravity_mps2 * (one + load.crr * np.sqrt(1.0 - one**2))
        burned = _burned(problem, middle, force) * seconds + mu_w * seconds
        cost = (burned + after[: len(burned), None, :]).min(axis=2)
        after = np.minimum(cost, cost.min(axis=0) + problem.transmission.shift_cost_j)
        after[:, v > highest] = np.inf
    return float(after[:, np.abs(v - problem.from_speed_mps).argmin()].min())


def _burned(problem: Route, speed_mps: FloatArray, force_n: FloatArray) -> FloatArray:
    """Return the fuel power in each gear and in neutral, infinite where it can't be, shape (gears + 1, …)."""
    engine = problem.engine
    if isinstance(engine, WillansDrive):
        power = force_n * speed_mps
        c0, c1, c2 = engine.willans
        able = (power <= engine.power_w[1]) & (force_n >= -problem.brake_max_n)
        return np.where(able, c0 + (c1 + c2 * power.clip(0.0)) * power.clip(0.0), np.inf)[None]
    low, high = (rpm * np.pi / 30.0 for rpm in engine.speed_rpm)
    ways = []
    for ratio in problem.transmission.ratios:
        omega, torque = speed_mps * ratio / problem.load.wheel_radius_m, force_n * problem.load.wheel_radius_m / ratio
        able = (omega >= low) & (omega <= high) & (torque >= engine.torque_nm[0]) & (torque <= engine.torque_nm[1])
        ways.append(np.where(able, fuel_power_w(engine, omega, torque), np.inf))
    rolls = (force_n <= 0.0) & (force_n >= -problem.brake_max_n)
    return np.array([*ways, np.where(rolls, engine.idle_fuel_power_w, np.inf)])
