"""How a method is run: what it finds is timed, what is said about it is not."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

from app.science.optimal.accelerate.kernels import DriveNumbers
from app.science.optimal.accelerate.numbers import drive_numbers
from app.science.optimal.accelerate.solve import solve as pontryagin_solution
from app.science.optimal.answer import Answer, Documented
from app.science.optimal.costs.recounting import recounted
from app.science.optimal.costs.weighted import WeightedDrive, WeightedEngine
from app.science.optimal.methods.answering import answer_of
from app.science.optimal.methods.found import Found
from app.science.optimal.methods.names import NAMES
from app.science.optimal.problem import Accelerate, DriveProblem, Problem, WillansDrive
from app.science.progress import Progress


@dataclass(frozen=True, slots=True)
class Options:
    """What a method may be told.

    Attributes
    ----------
    penalty : float or None
        First weight of a penalty for leaving the limits of the state (Sebesta 2010, B.2.5.3); None keeps them limits.
    """

    penalty: float | None = None


@dataclass(frozen=True, slots=True)
class Result:
    """What a method found, and how to have it judged.

    Attributes
    ----------
    cost_j, time_s : float
        Fuel energy, or the weighted cost that stands in its place; NaN where the problem has none.
    judged : callable
        Returns the answer with its certificate.
    """

    cost_j: float
    time_s: float
    judged: Callable[[], Documented]


SLOWEST_CVT_MPS = 2.0

Reason = Callable[[Problem], str | None]
Run = Callable[[Problem, Options, Progress], Result]


@dataclass(frozen=True, slots=True)
class Method:
    """A method by name.

    Attributes
    ----------
    name : str
    reason : callable
        Returns why the method does not apply to a problem, or None where it does.
    run : callable
        Solves a problem.
    penalised : bool
        Whether limits of the state can be handed over to a penalty.
    """

    name: str
    reason: Reason
    run: Run
    penalised: bool = False

    @property
    def title(self) -> str:
        """What the method does, in words."""
        return NAMES[self.name].title

    @property
    def source(self) -> str:
        """Where the thesis describes it."""
        return NAMES[self.name].source


def free_of_charges(problem: Problem) -> str | None:
    """Return why a smooth method can't count charges for shifts."""
    if isinstance(problem, Accelerate) and problem.transmission.shift_cost_j > 0.0:
        return "charges for shifts make the sequence of gears a choice of its own; pontryagin and dp_speed count them."
    return None


def moving(problem: Problem) -> str | None:
    """Return why a method with steps of time can't start a CVT from standstill."""
    if not isinstance(problem, Accelerate) or isinstance(problem.engine, WillansDrive):
        return None
    if problem.transmission.kind == "cvt" and problem.from_speed_mps < SLOWEST_CVT_MPS:
        return (
            f"below {SLOWEST_CVT_MPS:g} m/s a CVT's force has no bound that steps of time could follow; pontryagin and "
            "dp_speed integrate over speed."
        )
    return None


def smooth_and_moving(problem: Problem) -> str | None:
    """Return why a smooth method with steps of time does not apply."""
    return free_of_charges(problem) or moving(problem)


def counted(problem: DriveProblem, answer: Answer) -> Answer:
    """Return an answer to a weighted problem with its fuel, CO2 and emissions; any other as it is."""
    engine = problem.engine
    return recounted(answer, engine) if isinstance(engine, WeightedEngine | WeightedDrive) else answer


FindDrive = Callable[[Accelerate, DriveNumbers, Options, Progress], Found]


def accelerating(name: str, find: FindDrive, reason: Reason | None = None, *, penalised: bool = False) -> Method:
    """Return a method for accelerations; its drive is judged against Pontryagin's own solution."""

    def why_not(problem: Problem) -> str | None:
        if not isinstance(problem, Accelerate):
            return "it is written for accelerations."
        return reason(problem) if reason else None

    def run(problem: Problem, options: Options, progress: Progress) -> Result:
        assert isinstance(problem, Accelerate)  # noqa: S101 - `why_not` has asked
        drive = drive_numbers(problem)
        found = find(problem, drive, options, progress)

        def judged() -> Answer:
            return counted(problem, answer_of(problem, drive, found, pontryagin_solution(problem), name))

        return Result(found.fuel_j, found.time_s, judged)

    return Method(name, why_not, run, penalised)
