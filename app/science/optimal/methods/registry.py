"""All methods by name."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import replace
from typing import cast

from app.science.fields import nearest
from app.science.optimal.accelerate.answering import answer as accelerate
from app.science.optimal.accelerate.kernels import DriveNumbers
from app.science.optimal.accelerate.solve import solve as pontryagin_solution
from app.science.optimal.answer import Answer, Documented
from app.science.optimal.distance.answering import best_drive, car_of
from app.science.optimal.methods.boundary_value import boundary_value
from app.science.optimal.methods.direct_multiple import direct_multiple_shooting
from app.science.optimal.methods.direct_single import direct_single_shooting
from app.science.optimal.methods.distances import corner, shooting
from app.science.optimal.methods.found import Found, MethodFailed
from app.science.optimal.methods.hjb import hjb_upwind
from app.science.optimal.methods.judging import controllable
from app.science.optimal.methods.multiple_shooting import multiple_shooting
from app.science.optimal.methods.regulators import dlqr, lqr
from app.science.optimal.methods.routes import by_grid, polished
from app.science.optimal.methods.running import (
    FindDrive,
    Method,
    Options,
    Result,
    Run,
    accelerating,
    counted,
    free_of_charges,
    moving,
    smooth_and_moving,
)
from app.science.optimal.methods.shooting import single_shooting
from app.science.optimal.methods.speed_grid import dp_speed
from app.science.optimal.methods.speed_time import dp_speed_time
from app.science.optimal.problem import Accelerate, Distance, Infeasible, Problem, Route
from app.science.optimal.solve import solve
from app.science.progress import Progress, silent


def method(name: str) -> Method:
    """Return the method of a name.

    Raises
    ------
    MethodFailed
        For a name that none has.
    """
    if name not in METHODS:
        raise MethodFailed(
            f"{name!r} is the name of no method{nearest(name, tuple(METHODS))[:-1]}: {', '.join(METHODS)}."
        )
    return METHODS[name]


def solve_by(problem: Problem, name: str, options: Options | None = None, progress: Progress = silent) -> Documented:
    """Solve a problem by a method.

    Raises
    ------
    MethodFailed
        When there is no such method, it does not apply to the problem, or it finds no drive.
    Infeasible
        When no drive fulfils the problem.
    """
    chosen, told = method(name), options or Options()
    reason = chosen.reason(problem)
    if reason is not None:
        raise MethodFailed(f"{name} does not apply: {reason}")
    if told.penalty is not None and not chosen.penalised:
        able = ", ".join(one.name for one in METHODS.values() if one.penalised)
        raise MethodFailed(f"{name} takes no penalty; methods that do: {able}.")
    return chosen.run(problem, told, progress).judged()


def _pontryagin(problem: Problem, _options: Options, progress: Progress) -> Result:
    if isinstance(problem, Distance):
        best = best_drive(problem, car_of(problem)).drive
        return Result(float(best.fuel_j), float(best.time_s), lambda: solve(problem, progress))
    if not isinstance(problem, Accelerate):
        return finished(solve(problem, progress))
    found = pontryagin_solution(problem)

    def judged() -> Answer:
        answer = accelerate(problem)
        more = {**answer.certificate.more, "controllable": controllable(problem.load, answer.trajectory.speed_mps)}
        certificate = replace(answer.certificate, more=more)
        return counted(problem, replace(answer, certificate=certificate, more={**answer.more, "method": "pontryagin"}))

    return Result(found.fuel_j, found.time_s, judged)


def finished(answer: Documented) -> Result:
    """Return an answer without fuel as a result."""
    return Result(float("nan"), float(getattr(answer, "time_s", float("nan"))), lambda: answer)


def _not_routes(problem: Problem) -> str | None:
    if isinstance(problem, Route):
        return "on a road with limits the costate jumps where they bind; see polish."
    return None


def _rising(problem: Problem) -> str | None:
    """Return why a method over speed does not apply."""
    if not isinstance(problem, Accelerate) or free_of_charges(problem):
        return free_of_charges(problem)
    try:
        best = pontryagin_solution(problem)
    except Infeasible:  # the method itself says so, as the others do
        return None
    if best.slowing.phases or best.linger is not None:
        return "the drive slows down first or stays at a speed: no function of speed; single_shooting runs in time."
    return None


def _plain(find: Callable[[Accelerate, DriveNumbers, Progress], Found]) -> FindDrive:
    """Return a method that takes no options."""
    return lambda problem, drive, _options, progress: find(problem, drive, progress)


def _free_s(problem: Accelerate) -> float:
    return pontryagin_solution(replace(problem, time_s=None)).time_s


def _timed(find: Callable[[Accelerate, DriveNumbers, float, Progress], Found]) -> FindDrive:
    """Return a method that is told the time of the drive in free time: where there is more, it may slow down first."""
    return lambda problem, drive, _options, progress: find(problem, drive, _free_s(problem), progress)


def _direct_single(problem: Accelerate, drive: DriveNumbers, options: Options, progress: Progress) -> Found:
    return direct_single_shooting(problem, drive, options.penalty, _free_s(problem), progress)


def _only_routes(problem: Problem) -> str | None:
    return None if isinstance(problem, Route) else "it is written for roads."


def _only_distances(problem: Problem) -> str | None:
    return None if isinstance(problem, Distance) else "it is written for distances on the level."


def _on_a_road(find: Callable[[Route, Progress], Result]) -> Run:
    """Return a method for roads; the registry has asked whether it applies."""
    return lambda problem, _options, progress: find(cast(Route, problem), progress)


def _over_a_distance(find: Callable[[Distance, Progress], Result]) -> Run:
    """Return a method for distances; the registry has asked whether it applies."""
    return lambda problem, _options, progress: find(cast(Distance, problem), progress)


_ACCELERATING = accelerating("single_shooting", _plain(single_shooting), free_of_charges)


def _shootable(problem: Problem) -> str | None:
    if isinstance(problem, Route):
        return "over a road every error grows until nothing is hit; polish solves for all of the road at once."
    return None if isinstance(problem, Distance) else _ACCELERATING.reason(problem)


def _shoot(problem: Problem, options: Options, progress: Progress) -> Result:
    if isinstance(problem, Distance):
        return shooting(problem, progress)
    return _ACCELERATING.run(problem, options, progress)


METHODS: Mapping[str, Method] = {
    one.name: one
    for one in (
        Method("pontryagin", _not_routes, _pontryagin),
        Method("single_shooting", _shootable, _shoot),
        accelerating("multiple_shooting", _plain(multiple_shooting), free_of_charges),
        accelerating("boundary_value", _plain(boundary_value), _rising),
        accelerating("direct_single_shooting", _direct_single, smooth_and_moving, penalised=True),
        accelerating("direct_multiple_shooting", _timed(direct_multiple_shooting), smooth_and_moving),
        accelerating("dp_speed", _plain(dp_speed)),
        accelerating("dp_speed_time", _timed(dp_speed_time), moving),
        accelerating("hjb_upwind", _timed(hjb_upwind), smooth_and_moving),
        Method("dp_distance_energy_gear", _only_routes, _on_a_road(by_grid)),
        Method("polish", _only_routes, _on_a_road(polished)),
        Method("corner", _only_distances, _over_a_distance(corner)),
        accelerating("lqr", _plain(lqr), moving),
        accelerating("dlqr", _plain(dlqr), moving),
    )
}
