"""Any drive problem to its answer: one line for each kind."""

from __future__ import annotations

from app.science.optimal.accelerate.answering import answer as accelerate
from app.science.optimal.answer import Answer, Documented
from app.science.optimal.ball_and_wheel import solve_ball_and_wheel
from app.science.optimal.costs.recounting import recounted
from app.science.optimal.costs.weighted import WeightedDrive, WeightedEngine
from app.science.optimal.distance.answering import answer as distance
from app.science.optimal.problem import Accelerate, BallAndWheel, Distance, DriveProblem, Problem
from app.science.optimal.route.answering import answer as route
from app.science.progress import Progress, silent


def solve(problem: Problem, progress: Progress = silent) -> Documented:
    """Solve a problem.

    Parameters
    ----------
    problem : Problem
    progress : callable
        Is told how far a long one is; what it raises ends the work.

    Raises
    ------
    Infeasible
        When no drive fulfils it; the message says which number is impossible and by how much.
    """
    if isinstance(problem, BallAndWheel):
        return solve_ball_and_wheel(problem)
    found = _driven(problem, progress)
    return recounted(found, problem.engine) if isinstance(problem.engine, WeightedEngine | WeightedDrive) else found


def _driven(problem: DriveProblem, progress: Progress) -> Answer:
    if isinstance(problem, Accelerate):
        return accelerate(problem)
    if isinstance(problem, Distance):
        return distance(problem)
    return route(problem, progress)
