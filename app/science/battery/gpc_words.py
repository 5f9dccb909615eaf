"""What the gradient estimator says about itself."""

from __future__ import annotations

import numpy as np

from app.science.battery.gpc_kernels import GATHERED, GpcHistory, GpcModel
from app.science.battery.gpc_step_kernels import ALPHA, BETA, XI, R

AT_BOUND = 0.2
"""Share of the kept rows with σ at a bound from which on it is told even where it has left it."""

LEAST_DRIFT = 0.01
"""Share of the capacity by which the counted charge has to drift within what is remembered to be told."""

SETTLED_S = 43_200.0
"""Before so long the start of the charge moves because it is still being found."""

_NAMES = {ALPHA: "capacity", R: "resistance", BETA: "relaxation's capacitance C_r"}


def bound_warnings(model: GpcModel, out: GpcHistory, remedy: str) -> tuple[str, ...]:
    """Return which parameters stand at a bound, in words."""
    told: list[str] = []
    learnt = out.scalars[:, GATHERED] > 0.0
    rates = out.theta[learnt, XI]
    at_bound = np.abs(rates) >= 1.0
    if at_bound.any() and (at_bound[-1] or at_bound.mean() > AT_BOUND):
        slowest = rates[at_bound][-1] < 0.0
        rate = model.rate_middle - model.rate_half if slowest else model.rate_middle + model.rate_half
        told.append(
            f"The relaxation's rate σ stood at the {'lowest' if slowest else 'highest'} that is looked for, {rate:.3g} "
            f"1/s: the true one may lie beyond. {remedy}; until then take C_r and R_r as unknown."
        )
    for at, name in _NAMES.items():
        last = out.theta[-1, at]
        if last <= model.lowest[at] or last >= model.highest[at]:
            told.append(
                f"The {name} ran to the end of where it is looked for, and its value means nothing. Begin nearer to "
                "the truth, or use the estimator ekf_bias."
            )
    return tuple(told)


def drift_warnings(model: GpcModel, out: GpcHistory, drift_a: float) -> tuple[str, ...]:
    """Return in words by how much the counted charge runs away from the voltage."""
    gathered, alpha = float(out.scalars[-1, GATHERED]), float(out.theta[-1, ALPHA])
    if gathered < SETTLED_S or abs(drift_a) * alpha * gathered < LEAST_DRIFT:
        return ()
    milliamperes = f"{1e3 * drift_a:.1f}".replace("-", "−")
    return (
        f"The charge counted from one cell's current runs away from its voltage by about {milliamperes} mA, as it "
        "does when the current's sensor is off by that. This estimator knows no such error: it takes it for capacity "
        "and charge. Use the estimator ekf_bias.",
    )
