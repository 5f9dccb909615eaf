"""What a stretch's residuals say about the noise of the voltage."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from app.science.arrays import FloatArray
from app.science.battery.kalman.residual_kernels import FIRST_SIZE, GROWTH, excess_of, mean_powers

MEDIAN_OF_SQUARES = 0.4549
"""Median of the square of a standard normal variable."""
CLIP = 4.0
"""Residuals beyond so many of their standard deviations count as if they stood there."""
PRIOR_ROWS = 20.0
"""For how many rows' worth the level that was assumed counts beside what the residuals say."""
LEAST_GROUPS = 8
"""Fewer residuals, or means of them, tell nothing."""
LEAST_SHARE = 0.01
"""The noise is taken for at least this share of what was assumed, in variance: rounded voltages may repeat exactly."""
LOOK_AT = 2000
"""Rows whose median tells how large residuals usually are."""
SIGNIFICANT = 4.0
"""A colour is believed when it is so many standard deviations above white."""


@dataclass(frozen=True, slots=True)
class Level:
    """Noise of the voltage.

    Attributes
    ----------
    variance_v2 : float
        Of one row, V².
    colour : float
        As how many rows that hang together the noise behaves; 1 for white noise. What the model can't explain comes
        in long waves, and rows that all tell the same wave are worth one.
    """

    variance_v2: float
    colour: float = 1.0


def level_of(residual_v: FloatArray, variance_v2: FloatArray, assumed: Level, least_v2: float = 0.0) -> Level:
    """Return the noise that a filter's residuals speak for.

    Parameters
    ----------
    residual_v, variance_v2 : ndarray (n,)
        Residuals of rows that were learnt from, and as predicted with ``assumed``.
    assumed : Level
    least_v2 : float
        What the noise's variance is at least, V².

    Returns
    -------
    Level
    """
    if len(residual_v) < LEAST_GROUPS:
        return assumed
    known = variance_v2 - assumed.variance_v2 * assumed.colour
    some = slice(None, None, 1 + len(known) // LOOK_AT)
    share = np.median(residual_v[some] ** 2 / (known[some] + assumed.variance_v2)) / MEDIAN_OF_SQUARES
    excess, weight = excess_of(residual_v, known, assumed.variance_v2, CLIP**2 * max(float(share), LEAST_SHARE))
    variance = (excess + PRIOR_ROWS * assumed.variance_v2) / (weight + PRIOR_ROWS)
    variance = max(variance, LEAST_SHARE * assumed.variance_v2, least_v2)
    return Level(variance, colour_of(mean_powers(residual_v, known, variance, CLIP), len(residual_v)))


def colour_of(powers: FloatArray, rows: int) -> float:
    """Return the variance of a series' long means over what it were if its entries had nothing to do with each other.

    Parameters
    ----------
    powers : ndarray (8,)
        As `app.science.battery.kalman.residual_kernels.mean_powers` gives them.
    rows : int
        Length of the series.

    Returns
    -------
    float
        The largest ratio that chance alone would hardly make; 1 where there is none.
    """
    colour, size = 1.0, FIRST_SIZE
    for power in powers[1:]:
        groups = rows // size
        if groups < LEAST_GROUPS or powers[0] <= 0.0:
            break
        ratio = float(power / powers[0])
        if ratio > 1.0 + SIGNIFICANT * np.sqrt(2.0 / groups):
            colour = max(colour, ratio)
        size *= GROWTH
    return colour
