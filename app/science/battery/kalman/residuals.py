"""What a stretch's residuals say about the noise of the voltage."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from app.science.arrays import FloatArray

MEDIAN_OF_SQUARES = 0.4549
"""Median of the square of a standard normal variable."""
CLIP = 4.0
"""Residuals beyond so many of their standard deviations count as if they stood there."""
PRIOR_ROWS = 20.0
"""For how many rows' worth the level that was assumed counts beside what the residuals say."""
LEAST_BATCHES = 8
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


def level_of(residual_v: FloatArray, variance_v2: FloatArray, assumed: Level) -> Level:
    """Return the noise that a filter's residuals speak for.

    Parameters
    ----------
    residual_v, variance_v2 : ndarray (n,)
        Residuals of rows that were learnt from, and as predicted with ``assumed``.
    assumed : Level

    Returns
    -------
    Level
    """
    if len(residual_v) < LEAST_BATCHES:
        return assumed
    known = variance_v2 - assumed.variance_v2 * assumed.colour
    share = np.median(residual_v**2 / (known + assumed.variance_v2)) / MEDIAN_OF_SQUARES
    spread = share * (known + assumed.variance_v2)
    squares = np.minimum(residual_v**2, CLIP**2 * spread)
    weight = (assumed.variance_v2 / (known + assumed.variance_v2)) ** 2
    # Where prediction itself is uncertain, a residual tells little about the noise.
    excess = np.sum(weight * (squares - known)) + PRIOR_ROWS * assumed.variance_v2
    variance = max(excess / (np.sum(weight) + PRIOR_ROWS), 0.01 * assumed.variance_v2)
    scaled = np.clip(residual_v / np.sqrt(known + variance), -CLIP, CLIP)
    return Level(float(variance), colour_of(scaled))


def colour_of(scaled: FloatArray) -> float:
    """Return the variance of a series' long means over what it were if its entries had nothing to do with each other.

    Means over 4, 16, 64, … entries are looked at; the largest ratio counts, if chance alone would hardly make it.
    """
    colour, size = 1.0, 4
    power = float(np.mean(scaled**2))
    while len(scaled) // size >= LEAST_BATCHES and power > 0.0:
        count = len(scaled) // size
        means = scaled[: count * size].reshape(count, size).mean(axis=1)
        ratio = size * float(np.mean(means**2)) / power
        if ratio > 1.0 + SIGNIFICANT * np.sqrt(2.0 / count):
            colour = max(colour, ratio)
        size *= 4
    return colour
