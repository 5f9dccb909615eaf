"""Polished drives against other solvers of this house, a dense grid, and what a drive must keep."""

from __future__ import annotations

from itertools import pairwise
from typing import Any

import numpy as np
import pytest

from app.science.optimal.accelerate.answering import answer as accelerate
from app.science.optimal.distance.answering import answer as distance
from app.science.optimal.problem import RADPS_PER_RPM, Accelerate, Distance, Road, Route
from app.science.optimal.reading import read_problem
from app.science.optimal.route.plan import Plan
from app.science.optimal.route.polish.burning import Powertrain, powertrain_of
from app.science.optimal.route.polish.certifying import certify
from app.science.optimal.route.polish.polishing import Polished, polish
from app.science.optimal.route.polish.smooth import rough, smoothly
from app.science.optimal.route.solving import solve
from app.science.progress import silent
from tests.science.optimal.documents import SIX_GEARS, SMART, thesis
from tests.science.optimal.route.roads import CONVEX, GEARS, WILLANS, hills, posed


def polished(problem: Route, plan: Plan | None = None) -> Polished:
    """Polish a plan that settles."""
    found = polish(problem, plan or rough(problem), silent)
    assert found is not None
    return found


@pytest.fixture(scope="module")
def hurried() -> Polished:
    return polished(posed(max_time_s=220.0))


def test_smooth_drive_is_certified(hurried: Polished) -> None:
    """H is constant, no control beats the drive, and a rigorous bound leaves less than a hundred thousandth."""
    certificate = certify(posed(max_time_s=220.0), hurried)
    peak = hurried.trajectory.fuel_power_w.max()
    assert hurried.hamiltonian_drift_w <= 1e-6 * peak
    assert hurried.max_h_minus_mu_w <= 1e-6 * peak
    assert -1e-7 < (hurried.fuel_j - hurried.lower_bound_j) / hurried.fuel_j < 1e-4
    assert certificate.verdict == "optimal"


def test_limits_are_kept(hurried: Polished) -> None:
    """Time is used up, speeds stay below limits, and the ends are exact."""
    t, road = hurried.trajectory, hills()
    assert 220.0 - 1e-6 < hurried.time_s <= 220.0
    at = np.array(road["distance_m"])
    segment = np.clip(np.searchsorted(at, t.distance_m, side="left") - 1, 0, len(at) - 2)
    assert (t.speed_mps <= np.array(road["speed_limit_mps"])[segment] + 1e-9).all()
    assert t.speed_mps[[0, -1]] == pytest.approx([10.0, 12.0], abs=1e-12)
    assert np.trapezoid(t.speed_mps, t.t_s) == pytest.approx(4000.0, rel=1e-4)
    assert np.trapezoid(t.fuel_power_w, t.t_s) == pytest.approx(hurried.fuel_j, rel=2e-4)
    assert t.brake_n.max() <= 5000.0 * (1.0 + 1e-9)


def test_price_is_what_a_second_saves(hurried: Polished) -> None:
    """The multiplier is the derivative of fuel by the longest time."""
    faster, slower = (polished(posed(max_time_s=220.0 + dt)).fuel_j for dt in (-0.5, 0.5))
    assert faster - slower == pytest.approx(hurried.price_w, rel=2e-3)


def test_agrees_with_the_solver_of_distances() -> None:
    """On the level in free time with its end speed a route is a distance."""
    problem = read_problem(
        {
            "kind": "distance",
            "vehicle": dict(SMART),
            "engine": dict(WILLANS),
            "from_speed_mps": 8.5,
            "distance_m": 3000.0,
        }
    )
    assert isinstance(problem, Distance)
    other = distance(problem)
    end = float(other.trajectory.speed_mps[-1])
    level = {"distance_m": [0.0, 3000.0], "elevation_m": [0.0, 0.0], "speed_limit_mps": [60.0, 60.0]}
    ours = polished(posed(road=level, from_speed_mps=8.5, to_speed_mps=end, min_speed_mps=0.5, max_time_s=None))
    assert ours.fuel_j == pytest.approx(other.fuel_energy_j, rel=1e-6)
    assert ours.costates["distance"].mean() == pytest.approx(other.costates["distance"][0], rel=1e-4)


def test_agrees_with_the_solver_of_accelerations() -> None:
    """Over the length that the cheapest acceleration takes, a metre is worth nothing and gears change as there."""
    problem = read_problem(thesis())
    assert isinstance(problem, Accelerate)
    other = accelerate(problem)
    t = other.trajectory
    keep = np.concatenate(([True], np.diff(t.distance_m) > 1e-9))
    edges, speeds = t.distance_m[keep], t.speed_mps[keep]
    road = Road((0.0, float(edges[-1])), (0.0, 0.0), (60.0, 60.0))
    route = Route(problem.load, problem.engine, problem.transmission, road, problem.from_speed_mps, 100.0 / 3.6, 3.0)
    gear = t.gear[np.searchsorted(t.distance_m, 0.5 * (edges[1:] + edges[:-1]) - 2.0)]
    ours = polished(route, Plan(edges, speeds, gear, 0.0))
    assert ours.fuel_j == pytest.approx(other.fuel_energy_j, rel=1e-8)
    assert ours.time_s == pytest.approx(other.time_s, rel=1e-4)
    assert np.abs(ours.costates["distance"]).max() < 0.5
    changes = np.flatnonzero(np.diff(ours.trajectory.gear))
    assert ours.trajectory.speed_mps[changes] == pytest.approx(other.switch_speeds_mps, abs=1e-2)


def test_no_grid_finds_a_cheaper_drive() -> None:
    """Dynamic programming in plain NumPy over energies, at the same price of a second, comes near from above."""
    road = {"distance_m": [0.0, 300.0, 600.0], "elevation_m": [0.0, 9.0, 3.0], "speed_limit_mps": [20.0, 14.0, 14.0]}
    problem = posed(road=road, max_time_s=45.0, to_speed_mps=11.0)
    ours = polished(problem)
    grid = _on_grid(problem, powertrain_of(problem), ours.price_w)
    priced = ours.fuel_j + ours.price_w * ours.time_s
    assert priced < grid < priced * 1.006


def _on_grid(problem: Route, power: Powertrain, price_w: float) -> float:
    """Return fuel and priced time of the best drive over a grid of stages and kinetic energies."""
    load, step, mass = problem.load, 5.0, problem.load.accelerated_mass_kg
    road, at = problem.road, np.arange(0.0, problem.road.distance_m[-1] + 1.0, 5.0)
    grid = 0.5 * mass * np.linspace(3.0, 20.0, 700) ** 2
    v0, v1 = (np.sqrt(2.0 * one / mass) for one in (grid[:, None], grid[None, :]))
    force = (grid[None, :] - grid[:, None]) / step + load.drag_kgpm * 0.5 * (v0**2 + v1**2)
    value = np.full(grid.shape, np.inf)
    value[np.abs(grid - 0.5 * mass * problem.to_speed_mps**2).argmin()] = 0.0
    high = np.array(road.elevation_m)
    slopes = np.diff(high) / np.diff(road.distance_m)
    for a, _ in reversed(list(pairwise(at.tolist()))):
        k = int(np.searchsorted(road.distance_m, a + 1e-9, side="right")) - 1
        sine = slopes[k]
        pull = force + load.mass_kg * load.gravity_mps2 * (load.crr * np.sqrt(1.0 - sine**2) + sine)
        v = 0.5 * (v0 + v1)
        watts = np.maximum(pull, 0.0) * v
        able = (watts <= 40000.0) & (pull <= 4000.0) & (pull >= -problem.brake_max_n)
        able &= np.maximum(v0, v1) <= road.speed_limit_mps[k] + 1e-9
        fuel = 5000.0 + 2.2 * watts + 1e-5 * watts**2
        value = np.where(able, (fuel + price_w) * step / v + value[None, :], np.inf).min(axis=1)
    return float(value[np.abs(grid - 0.5 * mass * problem.from_speed_mps**2).argmin()])


def test_standstill_at_both_ends() -> None:
    """From rest to rest; the bound closes there, too."""
    drive = polished(posed(from_speed_mps=0.0, to_speed_mps=0.0, min_speed_mps=0.0, max_time_s=280.0))
    assert drive.trajectory.speed_mps[[0, -1]].tolist() == [0.0, 0.0]
    assert (drive.fuel_j - drive.lower_bound_j) / drive.fuel_j < 1e-4
    assert drive.hamiltonian_drift_w <= 1e-6 * drive.trajectory.fuel_power_w.max()


def _upshift(at_m: float) -> Polished:
    road = {"distance_m": [0.0, 400.0], "elevation_m": [0.0, 6.0], "speed_limit_mps": [30.0, 30.0]}
    problem = posed(
        road=road, engine=dict(CONVEX), transmission=GEARS | {"shift_cost_j": 500.0}, from_speed_mps=10.0,
        to_speed_mps=20.0, max_time_s=24.0,
    )  # fmt: skip
    edges = np.unique(np.append(np.linspace(0.0, 400.0, 41), at_m))
    gear = np.where(edges[:-1] < at_m, 3, 5)
    return polished(problem, Plan(edges, np.interp(edges, [0.0, 400.0], [10.0, 20.0]), gear, 5e3))


def test_changes_of_gear_find_their_place() -> None:
    """From either side an upshift goes to where a metre costs the same in both gears, and H is constant across it."""
    early, late = _upshift(60.0), _upshift(160.0)
    places = [
        float(one.trajectory.distance_m[int(np.flatnonzero(np.diff(one.trajectory.gear))[0])]) for one in (early, late)
    ]
    assert places[0] == pytest.approx(places[1], abs=0.05)
    assert early.fuel_j == pytest.approx(late.fuel_j, rel=1e-6)
    assert early.switch_defect_w < 1e-4 * early.trajectory.fuel_power_w.max()


def test_h_stays_where_full_load_bends() -> None:
    line = [[1000.0, 60.0], [2500.0, 98.0], [4500.0, 100.0], [6000.0, 80.0]]
    problem = posed(
        engine=CONVEX | {"full_load": line}, transmission=GEARS | {"shift_cost_j": 2000.0},
        road=hills(1500.0, 31), max_time_s=88.0,
    )  # fmt: skip
    found = polish(problem, solve(problem, silent).plan, silent)
    assert found is not None
    radps = found.trajectory.engine_speed_radps
    assert np.nanmin(radps) < 2500.0 * RADPS_PER_RPM < np.nanmax(radps)
    assert found.hamiltonian_drift_w <= 1e-6 * found.trajectory.fuel_power_w.max()


def test_torque_moves_the_car_as_told() -> None:
    """The acceleration follows from the torque that is shown."""
    drive, load = _upshift(100.0), posed().load
    t = drive.trajectory
    ratio = np.array(SIX_GEARS["ratios"])[t.gear - 1] / load.wheel_radius_m
    sine = 6.0 / 400.0
    against = load.drag_kgpm * t.speed_mps**2
    against += load.mass_kg * load.gravity_mps2 * (load.crr * np.sqrt(1.0 - sine**2) + sine)
    accel = (t.torque_nm * ratio - against) / load.accelerated_mass_kg
    step = np.diff(t.t_s)
    gained = np.sum(0.5 * (accel[1:] + accel[:-1]) * step)
    assert gained == pytest.approx(10.0, abs=1e-2)
    assert ((t.torque_nm >= -1e-9) & (t.torque_nm <= 100.0 + 1e-9)).all()


def test_cvt_burns_what_its_engine_burns() -> None:
    """Fuel along the drive is the engine's own at the speed and torque that are shown."""
    problem = posed(engine=dict(CONVEX), transmission={"type": "cvt"}, max_time_s=240.0)
    drive = smoothly(problem, silent)
    assert drive is not None
    t, c = drive.trajectory, CONVEX["p_in"]
    w, nm = t.engine_speed_radps, t.torque_nm
    engaged = np.isfinite(nm) & (t.brake_n == 0.0)
    burned = c[0] + c[1] * w + c[2] * w**2 + c[3] * w * nm + c[4] * w * nm**2
    assert np.abs(burned / t.fuel_power_w - 1.0)[engaged].max() < 2e-4
    assert certify(problem, drive).independent is not None


@pytest.mark.parametrize("changes", [{"max_time_s": 100.0}, {"engine": WILLANS | {"power_w": [0.0, 3000.0]}}])
def test_impossible_drives_do_not_settle(changes: dict[str, Any]) -> None:
    """Neither a time that is too short nor a hill that is too steep gives a drive."""
    problem = posed(**changes)
    assert polish(problem, rough(problem), silent) is None


@pytest.mark.parametrize(
    "changes",
    [
        {},
        {"engine": dict(CONVEX), "transmission": {"type": "cvt"}},
        {"engine": CONVEX | {"full_load": [[1000, 60], [3000, 95], [6000, 80]]}, "transmission": dict(GEARS)},
    ],
)
def test_derivatives(changes: dict[str, Any]) -> None:
    """First and second derivatives of fuel and of the largest forces, by central differences."""
    power = powertrain_of(posed(**changes))
    v, force = np.array([14.0, 17.0]), np.array([700.0, 500.0])
    ratio = np.full(2, 4.208 / SMART["wheel_radius_m"])
    at = power.burned(v, force, ratio)
    d, n = 1e-3, 1e-1
    ahead, back = (power.burned(v + one, force, ratio) for one in (d, -d))
    more, less = (power.burned(v, force + one, ratio) for one in (n, -n))
    assert at.by_v == pytest.approx((ahead.power_w - back.power_w) / (2 * d), rel=1e-5)
    assert at.by_f == pytest.approx((more.power_w - less.power_w) / (2 * n), rel=1e-6)
    assert at.by_vv == pytest.approx((ahead.by_v - back.by_v) / (2 * d), rel=1e-3, abs=1e-6)
    assert at.by_vf == pytest.approx((ahead.by_f - back.by_f) / (2 * d), rel=1e-3)
    assert at.by_ff == pytest.approx((more.by_f - less.by_f) / (2 * n), rel=1e-3, abs=1e-9)
    for limit, up, down in zip(
        power.highest(v, ratio), power.highest(v + d, ratio), power.highest(v - d, ratio), strict=True
    ):
        assert limit.by_v == pytest.approx((up.force_n - down.force_n) / (2 * d), rel=1e-5, abs=1e-9)
