"""Whether the fuel power of a formula is what optimal control wants: rising with torque, and convex in it.

Where P_in is concave in torque, a steady torque burns more than switching between a higher and a lower one, and
cruising optima chatter (pulse and glide).
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from app.science.engine.fitting.cells import RADPS_PER_RPM
from app.science.engine.fitting.polynomial import Formula
from app.science.engine.fitting.surface import DrivenArea

FLAT = 1e-6


@dataclass(frozen=True, slots=True)
class FuelShape:
    """How P_in runs over torque in the driven area.

    Attributes
    ----------
    falling, concave : float
        Shares of the driven area, 0 to 1, where P_in falls with torque, and where it is concave in it.
    concave_below_nm : float or None
        Torque below which nearly all of the concave area lies; None when there is none.
    """

    falling: float
    concave: float
    concave_below_nm: float | None


def fuel_shape(formula: Formula, area: DrivenArea) -> FuelShape:
    """Return how the formula's fuel power runs over torque."""
    omega, nm = np.meshgrid(area.rpm * RADPS_PER_RPM, area.nm, indexing="ij")
    step = 0.5 * float(area.nm[1] - area.nm[0]) if len(area.nm) > 1 else 1.0
    below, here, above = (formula.fuel_power_w(omega, nm + shift) for shift in (-step, 0.0, step))
    count = max(int(area.near.sum()), 1)
    falling = area.near & (above < below)
    concave = area.near & (above - 2.0 * here + below < -FLAT * np.abs(here))
    top = float(np.quantile(nm[concave], 0.95)) if concave.any() else None
    return FuelShape(float(falling.sum() / count), float(concave.sum() / count), top)
