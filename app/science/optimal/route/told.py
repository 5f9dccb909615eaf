"""What a reader of a route's answer should know about the problem and the kind of its solution."""

from __future__ import annotations

import numpy as np

from app.science.optimal.answer import Trajectory
from app.science.optimal.fuel_checks import concavity
from app.science.optimal.problem import PolynomialEngine, Route
from app.science.optimal.route.solving import SLOWEST_MPS

WORTH_SAYING = 0.01


def warnings(problem: Route, trajectory: Trajectory) -> tuple[str, ...]:
    """Return what should be said."""
    said = []
    concave = concavity(problem.engine)
    if concave is not None and concave.share > WORTH_SAYING:
        what = "torque" if isinstance(problem.engine, PolynomialEngine) else "power at the wheels"
        charged = (
            "Shifts are charged, so pulses stay finite."
            if problem.transmission.shift_cost_j > 0.0
            else "No classical optimum may exist: the answer pulses at most once in a stage, and more pulses would "
            "take a little less."
        )
        said.append(
            f"Fuel power is concave in {what} in {100.0 * concave.share:.0f} % of what the engine can do: there "
            f"pulling and rolling in turn take less than a steady pull. {charged}"
        )
    inner = trajectory.speed_mps[1:-1]
    if problem.min_speed_mps < SLOWEST_MPS and len(inner) and float(np.min(inner)) <= SLOWEST_MPS * 1.01:
        said.append(
            f"min_speed_mps lets the car get ever slower; speeds below {SLOWEST_MPS:g} m/s were left out but "
            "at the ends."
        )
    return tuple(said)
