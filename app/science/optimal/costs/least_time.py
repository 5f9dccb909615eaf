"""The least time a problem can be driven in."""

from __future__ import annotations

from app.science.optimal.accelerate.numbers import drive_numbers
from app.science.optimal.accelerate.plan import plan
from app.science.optimal.problem import Accelerate, Infeasible, Route
from app.science.optimal.route.car import car_of
from app.science.optimal.route.refusals import check_words
from app.science.optimal.route.solving import FINER, fastest


def least_time_s(problem: Accelerate | Route) -> float:
    """Return it, s.

    Raises
    ------
    Infeasible
        When there is no drive at all.
    """
    if isinstance(problem, Accelerate):
        way = plan(drive_numbers(problem), problem.from_speed_mps, problem.to_speed_mps, 1.0, weight=0.0)
        if way is None:
            raise Infeasible(f"{problem.to_speed_mps:g} m/s can't be reached.", "to_speed_mps")
        return way.time_s
    check_words(problem)
    return fastest(problem, car_of(problem), FINER[0])[2]
