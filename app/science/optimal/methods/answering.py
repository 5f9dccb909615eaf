"""A drive that a method found as an answer of the usual shape."""

from __future__ import annotations

from app.science.optimal.accelerate.kernels import GEARS, DriveNumbers
from app.science.optimal.accelerate.solve import Solution
from app.science.optimal.advice import advise
from app.science.optimal.answer import Answer
from app.science.optimal.methods.found import Found
from app.science.optimal.methods.judging import judge
from app.science.optimal.problem import Accelerate


def answer_of(problem: Accelerate, drive: DriveNumbers, found: Found, best: Solution | None, method: str) -> Answer:
    """Return a drive as an answer, judged against Pontryagin's own solution where there is one."""
    judged = judge(problem, drive, found, best)
    geared = drive.kind == GEARS
    return Answer(
        kind="accelerate",
        fuel_energy_j=found.fuel_j,
        time_s=found.time_s,
        distance_m=float(found.trajectory.distance_m[-1]),
        gears=found.gears if geared else (),
        switch_speeds_mps=found.switch_speeds_mps if geared else (),
        multiplier_w=judged.adjoint.mu_w,
        trajectory=found.trajectory,
        costates={"speed": judged.adjoint.costate},
        advice=advise(found.trajectory),
        warnings=(),
        certificate=judged.certificate,
        more={"method": method, **found.more},
    )
