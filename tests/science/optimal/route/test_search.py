"""Routes on grids: against every drive there is on a tiny one, against known times, and more time never costs more."""

from __future__ import annotations

from itertools import pairwise, product
from math import inf, isfinite

import numpy as np
import pytest

from app.science.optimal.fuel_checks import fuel_power_w
from app.science.optimal.problem import PolynomialEngine, Route
from app.science.optimal.route.car import car_of
from app.science.optimal.route.driving import driven
from app.science.optimal.route.search import Search, gridded, in_time
from app.science.optimal.route.solving import solve
from app.science.optimal.route.stages import Stages, finest_edges, limits_at, staged
from app.science.progress import silent
from tests.science.optimal.documents import SIX_GEARS
from tests.science.optimal.route.roads import CONVEX, GEARS, WILLANS, hills, posed

NODES = [np.array(one) for one in ([12.0], [10.5, 12.0, 13.5], [11.0, 12.5, 14.0], [10.0, 12.0, 14.0], [13.0])]
TWO = {"type": "gears", "ratios": [7.37, 4.208], "neutral": True, "shift_cost_j": 2500.0}
CHARGE = 2500.0


def tiny() -> tuple[Route, Stages, Search]:
    """Return four stages of a hill with up to three speeds at each edge, two gears and neutral."""
    road = {"distance_m": [0, 40, 100, 130, 200], "elevation_m": [0, 1, 0, -2, -1], "speed_limit_mps": [20.0] * 5}
    problem = posed(
        engine=CONVEX, transmission=TWO, road=road, from_speed_mps=12.0, to_speed_mps=13.0, max_time_s=None,
        brake_max_n=1500.0,
    )  # fmt: skip
    stages = staged(problem, np.array(road["distance_m"], dtype=np.float64))
    return problem, stages, gridded(stages, NODES, car_of(problem), CHARGE, between=False)


def burned(problem: Route, stages: Stages, k: int, gear: int, v0: float, v1: float) -> float:
    """Return a stage's fuel by many points, and infinity where a bound is broken: the plain way to say it."""
    engine, load = problem.engine, problem.load
    assert isinstance(engine, PolynomialEngine)
    length = stages.length_m[k]
    rise = np.diff(np.interp(stages.edges_m, problem.road.distance_m, problem.road.elevation_m))[k] / length
    weight = load.mass_kg * load.gravity_mps2
    x, w = np.polynomial.legendre.leggauss(24)
    v = np.concatenate(([v0, v1], 0.5 * (v0 + v1) + 0.5 * (v1 - v0) * x))
    push = load.accelerated_mass_kg * (v1**2 - v0**2) / (2.0 * length)
    force = push + weight * (rise + load.crr * np.sqrt(1.0 - rise**2)) + load.drag_kgpm * v**2
    seconds = 2.0 * length / (v0 + v1)
    if gear == 0:
        able = (force <= 0.0).all() and (force >= -problem.brake_max_n).all()
        return engine.idle_fuel_power_w * seconds if able else inf
    spd = problem.transmission.ratios[gear - 1] / load.wheel_radius_m
    omega, torque = spd * v, force / spd
    rpm = omega * 30.0 / np.pi
    able = (torque >= engine.torque_nm[0]).all() and (torque <= engine.torque_nm[1]).all()
    able &= (rpm >= engine.speed_rpm[0]).all() and (rpm <= engine.speed_rpm[1]).all()
    return float(0.5 * seconds * w @ fuel_power_w(engine, omega, torque)[2:]) if able else inf


@pytest.mark.parametrize("mu_w", [0.0, 6000.0, 30000.0])
def test_least_of_every_drive_on_a_tiny_grid(mu_w: float) -> None:
    problem, stages, search = tiny()
    fuel = {
        (k, gear, v0, v1): burned(problem, stages, k, gear, v0, v1)
        for k in range(4)
        for gear in range(3)
        for v0 in NODES[k].tolist()
        for v1 in NODES[k + 1].tolist()
    }
    least = inf
    for speeds in product(*(one.tolist() for one in NODES)):
        seconds = sum(2.0 * ds / (a + b) for ds, (a, b) in zip(stages.length_m, pairwise(speeds), strict=True))
        for gears in product(range(3), repeat=4):
            whole = sum(fuel[k, gears[k], speeds[k], speeds[k + 1]] for k in range(4))
            changes = sum(a != b for a, b in pairwise(gears))
            least = min(least, whole + mu_w * seconds + CHARGE * changes)
    found = search.at(mu_w)
    assert found is not None
    assert isfinite(least)
    assert found.taken_j + mu_w * found.time_s == pytest.approx(least, rel=1e-6)


def test_bound_on_a_tiny_grid_is_below_every_drive_in_time() -> None:
    _, _, search = tiny()
    free = search.at(0.0)
    assert free is not None
    found = in_time(search, free.time_s - 0.4, 0.0)
    assert found is not None
    assert found.way.time_s <= free.time_s - 0.4
    assert free.taken_j < found.bound_j <= found.way.taken_j


def test_more_time_never_costs_more() -> None:
    taken = []
    for seconds in (110.0, 125.0, 140.0, None):
        problem = posed(
            engine=CONVEX, transmission=GEARS | {"shift_cost_j": 2000.0}, road=hills(1500.0, 31), max_time_s=seconds
        )
        solved = solve(problem, silent)
        drive = driven(problem, solved.stages, solved.car, solved.plan.speed_mps, solved.found.way.column)
        assert seconds is None or drive.time_s <= seconds
        taken.append(solved.found.way.taken_j)
    assert all(more <= less * (1.0 + 1e-4) for less, more in pairwise(taken))
    assert taken[0] > 1.03 * taken[-1]


def test_drive_keeps_the_limits() -> None:
    """Forces make the acceleration, torque and engine speed stay in the box, speeds within the limits, ends exact."""
    problem = posed(engine=CONVEX, transmission=GEARS, road=hills(1500.0, 31), max_time_s=115.0)
    solved = solve(problem, silent)
    t = driven(problem, solved.stages, solved.car, solved.plan.speed_mps, solved.found.way.column).trajectory
    pulls = t.gear > 0
    assert t.torque_nm[pulls].min() >= -1e-6
    assert t.torque_nm[pulls].max() <= 100.0 + 1e-6
    rpm = t.engine_speed_radps[pulls] * 30.0 / np.pi
    assert rpm.min() >= 1000.0 - 1e-6
    assert rpm.max() <= 6000.0 + 1e-6
    assert (t.speed_mps[0], t.speed_mps[-1]) == (10.0, 12.0)
    limit = np.repeat(limits_at(problem, solved.stages.edges_m), 3)
    assert (t.speed_mps <= limit + 1e-9).all()
    assert t.speed_mps.min() >= problem.min_speed_mps - 1e-9
    load, spd = problem.load, np.array(SIX_GEARS["ratios"]) / problem.load.wheel_radius_m
    pull = np.where(pulls, t.torque_nm * spd[t.gear - 1], -t.brake_n)
    sine = np.repeat(
        np.diff(np.interp(solved.stages.edges_m, problem.road.distance_m, problem.road.elevation_m))
        / solved.stages.length_m,
        3,
    )
    against = load.mass_kg * load.gravity_mps2 * (sine + load.crr * np.sqrt(1.0 - sine**2))
    net = (np.where(pulls, pull, -t.brake_n) - against - load.drag_kgpm * t.speed_mps**2)[1::3]
    gained = (t.speed_mps[2::3] - t.speed_mps[0::3]) / (t.t_s[2::3] - t.t_s[0::3])
    assert net[pulls[1::3]] == pytest.approx(load.accelerated_mass_kg * gained[pulls[1::3]], abs=1e-5)


def test_fastest_drive_is_the_limit_where_the_car_is_strong() -> None:
    level = {"distance_m": [0, 900], "elevation_m": [0, 0], "speed_limit_mps": [18.0, 18.0]}
    ends = {"from_speed_mps": 18.0, "to_speed_mps": 18.0}
    solved = solve(posed(road=level, **ends, max_time_s=50.0), silent)
    assert solved.found.way.time_s == pytest.approx(50.0, rel=1e-9)
    hold = 0.5 * 1.2 * 0.39 * 1.93 * 18.0**2 + 0.01 * 920.0 * 9.805
    c0, c1, c2 = WILLANS["willans"]
    watts = hold * 18.0
    assert solved.found.way.fuel_j == pytest.approx((c0 + c1 * watts + c2 * watts**2) * 50.0, rel=1e-9)


def test_stages_end_where_slope_or_limit_changes() -> None:
    problem = posed(road=hills(1000.0, 37))
    edges = finest_edges(problem, 10.0, 100.0)
    assert np.isin(problem.road.distance_m, edges).all()
    assert np.diff(edges).max() <= 12.5
    assert np.diff(edges).min() > 0.3


def test_dearer_changes_of_gear_never_make_the_whole_cheaper() -> None:
    """At 1000 J the finest grid's drive came to a speed before the end from which nothing went on."""
    taken = []
    for charge in (1000.0, 3000.0):
        problem = posed(
            engine=CONVEX, transmission=GEARS | {"shift_cost_j": charge}, road=hills(8000.0, 161), max_time_s=520.0
        )
        taken.append(solve(problem, silent).found.way.taken_j)
    assert taken[0] < taken[1]
