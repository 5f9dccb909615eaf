"""A route solved on grids: coarse over all speeds that can be reached, then finer around the best drive."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from app.science.optimal.problem import Route
from app.science.optimal.route.car import car_of, gear_of
from app.science.optimal.route.corridor import Corridor, between_edges
from app.science.optimal.route.plan import Plan
from app.science.optimal.route.reach_kernels import backwards, forwards
from app.science.optimal.route.refusals import (
    check_standstill,
    check_words,
    no_drive,
    not_connected,
    out_of_reach,
    too_short,
)
from app.science.optimal.route.search import Found, Search, gridded, in_time
from app.science.optimal.route.stage_kernels import Car, Column
from app.science.optimal.route.stages import Stages, coarser, finest_edges, staged
from app.science.progress import Progress, between

FINEST = 640
SHORTEST_M, LONGEST_M = 10.0, 50.0
NEAR_STAGES = 12.0
NODES = 100
REACH = 14
NARROWER = 4.0
AGAIN = 4
FINER = (1.0, 4.0)
"""Stages are cut finer where a time is so short that only they can tell."""
ROOM = 1e-3
AS_FAST = 1e-6
SLOWEST_MPS = 0.3
"""No slower inside a road, unless the car starts or stops: ever slower driving may take ever less."""


@dataclass(frozen=True, slots=True)
class Level:
    """A grid: how many times longer than the finest its stages are, how fine its speeds, and whether steps may end
    between them."""

    longer: float
    finer: float
    between: bool


LEVELS = (Level(4.0, 0.5, True), Level(2.0, 2.0, True), Level(0.0, 8.0, True))


@dataclass(frozen=True, slots=True)
class Solved:
    """A route on its finest grid.

    Attributes
    ----------
    plan : Plan
    found : Found
    stages : Stages
    car : Car
    search : Search
    """

    plan: Plan
    found: Found
    stages: Stages
    car: Car
    search: Search


def solve(problem: Route, progress: Progress) -> Solved:
    """Solve a route.

    Raises
    ------
    Infeasible
        When no drive fulfils it.
    """
    check_words(problem)
    car = car_of(problem)
    check_standstill(problem, Column(*car.columns[0]).least_w)
    for finer in FINER:
        stages, bounds, fastest_s = fastest(problem, car, finer)
        longest_s = problem.max_time_s or np.inf
        if fastest_s <= longest_s * (1.0 - ROOM):
            break
    if longest_s < fastest_s * (1.0 - AS_FAST):
        raise too_short(problem, fastest_s)
    progress(0.1)
    return narrowed(problem, stages, bounds, car, between(progress, 0.1, 1.0))


def fastest(problem: Route, car: Car, finer: float) -> tuple[Stages, Corridor, float]:
    """Return the road in stages, the speeds that can be reached on it, and the least time it takes, s."""
    length = problem.road.distance_m[-1] - problem.road.distance_m[0]
    step_m = float(np.clip(length / FINEST, SHORTEST_M, LONGEST_M)) / finer
    stages = staged(problem, finest_edges(problem, step_m, NEAR_STAGES * step_m))
    bounds = reachable(problem, stages, car)
    return stages, bounds, float((2.0 * stages.length_m / (bounds.high_mps[1:] + bounds.high_mps[:-1])).sum())


def narrowed(problem: Route, stages: Stages, bounds: Corridor, car: Car, progress: Progress) -> Solved:
    """Solve level by level, each around the drives of the one before."""
    step_mps = float(bounds.high_mps.max()) / NODES
    step_m = float(stages.length_m.max())
    corridor, last = bounds, None
    for number, level in enumerate(LEVELS):
        on = staged(problem, coarser(stages.edges_m, problem, level.longer * step_m)) if level.longer else stages
        fine = step_mps / level.finer
        for _ in range(AGAIN):
            here = corridor.at(on.edges_m)
            search = gridded(on, here.nodes(fine), car, problem.transmission.shift_cost_j, between=level.between)
            found = in_time(search, problem.max_time_s, last[0].way.mu_w if last else 0.0)
            if found is None:
                break
            last = found, search, on
            speeds = found.way.speed_mps, found.slower.speed_mps
            ways = tuple(between_edges(stages.edges_m, on.edges_m, one) for one in speeds)
            rim = number > 0 and any(here.touched(bounds.at(on.edges_m), one, fine) for one in speeds)
            corridor = bounds.around(ways, REACH * fine / (1.0 if rim else NARROWER))
            if not rim:
                break
        progress((number + 1.0) / len(LEVELS))
    if last is None or last[2] is not stages:
        search = gridded(stages, bounds.nodes(step_mps), car, problem.transmission.shift_cost_j, between=True)
        whole = in_time(search, problem.max_time_s, 0.0)
        if whole is None:
            raise no_drive(problem)
        last = whole, search, stages
    found, search, _ = last
    gears = np.array([gear_of(int(column), car) for column in found.way.column])
    plan = Plan(stages.edges_m, found.way.speed_mps, gears, found.way.mu_w)
    return Solved(plan, found, stages, car, search)


def reachable(problem: Route, stages: Stages, car: Car) -> Corridor:
    """Return the speeds that lie on some drive from the road's start to its end.

    Raises
    ------
    Infeasible
        Where there is none.
    """
    floor = np.full(len(stages.edges_m), max(problem.min_speed_mps, SLOWEST_MPS))
    floor[-1] = problem.to_speed_mps
    cap = stages.cap_mps.copy()
    cap[-1] = problem.to_speed_mps
    ahead = forwards(problem.from_speed_mps, stages.length_m, stages.grade_n, cap, floor, car)
    if not np.isfinite(ahead[:, 0]).all():
        raise out_of_reach(problem, stages, ahead, floor, car)
    both = backwards(problem.to_speed_mps, stages.length_m, stages.grade_n, ahead, car)
    if not np.isfinite(both).all():
        raise not_connected(stages, int(np.flatnonzero(~np.isfinite(both[:, 0]))[-1]))
    return Corridor(stages.edges_m, both[:, 0], both[:, 1])
