"""What one record leaves to the next between its JSON form and `Carry`."""

from __future__ import annotations

from typing import Any

import numpy as np

from app.science.battery.run import Carry
from app.science.fields import Fields, ProblemError

STATES = 7
LARGEST = 1e12
MOST_S = 1e12


def carry_document(carry: Carry) -> dict[str, Any]:
    """Return it as JSON holds it; `read_carry` gives an equal one back."""
    return {"mean": carry.mean.tolist(), "covariance": carry.covariance.tolist(), "t_s": carry.t_s}


def read_carry(document: object) -> Carry:
    """Read what a record left.

    Raises
    ------
    ProblemError
        When it is none: seven numbers, and a covariance of them.
    """
    given = Fields(document, what="carry")
    mean = given.numbers("mean", -LARGEST, LARGEST, STATES)
    rows = given.get("covariance")
    if not isinstance(rows, list | tuple) or len(rows) != STATES:
        raise ProblemError("covariance", f"is no matrix of {STATES} rows.")
    inner = Fields({str(k): row for k, row in enumerate(rows)}, "covariance", "carry")
    covariance = np.array([inner.numbers(str(k), -LARGEST, LARGEST, STATES) for k in range(STATES)])
    if np.any(np.diag(covariance) < 0.0) or not np.allclose(covariance, covariance.T, rtol=1e-6, atol=1e-12):
        raise ProblemError("covariance", "is not the covariance of anything: it must be symmetric, variances above 0.")
    return Carry(np.array(mean), covariance, given.number("t_s", -MOST_S, MOST_S))
