"""Methods for a road: dynamic programming by itself, and with the polish that follows it."""

from __future__ import annotations

from dataclasses import replace

from app.science.optimal.answer import Answer, Certificate, Independent
from app.science.optimal.methods.judging import controllable
from app.science.optimal.methods.running import Result, counted
from app.science.optimal.problem import Route
from app.science.optimal.route.answering import GRID, Drive, answer, changes, told
from app.science.optimal.route.car import is_geared
from app.science.optimal.route.driving import driven
from app.science.optimal.route.solving import solve
from app.science.progress import Progress

UNKNOWN = float("nan")
NO_COSTATES = "By the grid alone: a steady acceleration in each stage, and no costates to judge it by."


def by_grid(problem: Route, progress: Progress) -> Result:
    """Return the drive by stages of dynamic programming over distance, energy and gear.

    Raises
    ------
    Infeasible
        When no drive fulfils the problem.
    """
    solved = solve(problem, progress)
    way = driven(problem, solved.stages, solved.car, solved.plan.speed_mps, solved.found.way.column)
    gears, switches = changes(way.trajectory) if is_geared(solved.car) else ((), ())
    charges = problem.transmission.shift_cost_j * max(len(gears) - 1, 0)

    def judged() -> Answer:
        taken = way.fuel_j + charges
        gap = (taken - solved.found.bound_j) / max(taken, 1.0)
        more = {
            "shift_charges_j": charges,
            "bound_on_grid_j": solved.found.bound_j,
            "controllable": controllable(problem.load, way.trajectory.speed_mps),
        }
        certificate = Certificate(UNKNOWN, UNKNOWN, UNKNOWN, Independent(GRID, gap), "best found", (NO_COSTATES,), more)
        drive = Drive(way.trajectory, {}, way.fuel_j, way.time_s, solved.plan.price_w)
        further = {"method": "dp_distance_energy_gear", "stages": len(solved.plan.gear)}
        return counted(problem, told(problem, drive, gears, switches, certificate, further))

    return Result(way.fuel_j, way.time_s, judged)


def polished(problem: Route, progress: Progress) -> Result:
    """Return the usual answer to a road: smooth ones at once, others by the grid and then by the polish.

    Raises
    ------
    Infeasible
        When no drive fulfils the problem.
    """
    found = answer(problem, progress)

    def judged() -> Answer:
        more = {**found.certificate.more, "controllable": controllable(problem.load, found.trajectory.speed_mps)}
        whole = replace(
            found, certificate=replace(found.certificate, more=more), more={**found.more, "method": "polish"}
        )
        return counted(problem, whole)

    return Result(found.fuel_energy_j, found.time_s, judged)
