"""A route as an answer: solved on grids, polished, certified and put in a driver's words."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from app.science.arrays import FloatArray
from app.science.optimal.answer import Answer, Certificate, Independent, Trajectory
from app.science.optimal.problem import Route
from app.science.optimal.route.car import is_geared
from app.science.optimal.route.driving import driven
from app.science.optimal.route.polish.certifying import certify as certified
from app.science.optimal.route.polish.polishing import Polished, polish
from app.science.optimal.route.polish.smooth import smoothly
from app.science.optimal.route.refusals import check_words
from app.science.optimal.route.solving import Solved, solve
from app.science.optimal.route.telling import told as advised
from app.science.optimal.route.told import warnings
from app.science.progress import Progress, between, silent

SMOOTH = 1e-6
IN_TIME = 1e-9
GRID = "dynamic programming over distance, energy and gear on the same stages, as a bound by weak duality"


@dataclass(frozen=True, slots=True)
class Drive:
    """The drive that is handed out."""

    trajectory: Trajectory
    costates: dict[str, FloatArray]
    fuel_j: float
    time_s: float
    price_w: float


def answer(problem: Route, progress: Progress = silent) -> Answer:
    """Solve a problem and say how one knows.

    Raises
    ------
    Infeasible
        When no drive fulfils it.
    """
    check_words(problem)
    easy = smoothly(problem, between(progress, 0.0, 0.3))
    if easy is not None:
        best = Drive(easy.trajectory, easy.costates, easy.fuel_j, easy.time_s, easy.price_w)
        return told(problem, best, (), (), certified(problem, easy), {})
    solved = solve(problem, between(progress, 0.3, 0.5))
    by_stages = driven(problem, solved.stages, solved.car, solved.plan.speed_mps, solved.found.way.column)
    polished = polish(problem, solved.plan, between(progress, 0.5, 0.98))
    best = Drive(by_stages.trajectory, {}, by_stages.fuel_j, by_stages.time_s, solved.plan.price_w)
    if polished is not None and better(problem, polished, by_stages.fuel_j):
        best = Drive(
            polished.trajectory, polished.costates, polished.fuel_j, polished.time_s, max(polished.price_w, 0.0)
        )
    else:
        polished = None
    gears, switches = changes(best.trajectory) if is_geared(solved.car) else ((), ())
    charges = problem.transmission.shift_cost_j * max(len(gears) - 1, 0)
    certificate = certify(problem, solved, best, polished, charges)
    return told(problem, best, gears, switches, certificate, {"stages": len(solved.plan.gear)})


def told(
    problem: Route,
    best: Drive,
    gears: tuple[int, ...],
    switches: tuple[float, ...],
    certificate: Certificate,
    more: dict[str, Any],
) -> Answer:
    """Put a drive and its certificate in an answer."""
    return Answer(
        kind="route",
        fuel_energy_j=best.fuel_j,
        time_s=best.time_s,
        distance_m=float(best.trajectory.distance_m[-1] - best.trajectory.distance_m[0]),
        gears=gears,
        switch_speeds_mps=switches,
        multiplier_w=best.price_w,
        trajectory=best.trajectory,
        costates=best.costates,
        advice=advised(problem, best.trajectory),
        warnings=warnings(problem, best.trajectory),
        certificate=certificate,
        more=more,
    )


def better(problem: Route, polished: Polished, fuel_j: float) -> bool:
    """Tell whether a polished drive is in time and takes no more than the one it came from."""
    in_time = problem.max_time_s is None or polished.time_s <= problem.max_time_s * (1.0 + IN_TIME)
    return in_time and polished.fuel_j <= fuel_j * (1.0 + SMOOTH)


def changes(t: Trajectory) -> tuple[tuple[int, ...], tuple[float, ...]]:
    """Return the gear of each phase and the speeds at which they change."""
    at = np.flatnonzero(np.diff(t.gear)) + 1
    gears = t.gear[np.concatenate(([0], at))]
    return tuple(int(gear) for gear in gears), tuple(float(v) for v in t.speed_mps[at])


def certify(problem: Route, solved: Solved, best: Drive, polished: Polished | None, charges_j: float) -> Certificate:
    """Return what is known about a drive."""
    taken = best.fuel_j + charges_j
    size = max(taken, 1.0)
    grid = {"shift_charges_j": charges_j, "bound_on_grid_j": solved.found.bound_j}
    if polished is None:
        gap = (taken - solved.found.bound_j) / size
        note = "The polish did not settle, so the drive has a steady acceleration in each stage and no costates."
        return Certificate(
            float("nan"), float("nan"), float("nan"), Independent(GRID, gap), "best found", (note,), grid
        )
    return certified(problem, polished, solved.found.bound_j, grid)
