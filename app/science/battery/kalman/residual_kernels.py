"""One pass over a stretch's residuals: how large they are, and how much they hang together."""

from __future__ import annotations

import numpy as np

from app.science.arrays import FloatArray
from app.science.jit import kernel

FIRST_SIZE, GROWTH, SIZES = 4, 4, 7
"""Means over 4, 16, … 16 384 rows are looked at."""


@kernel
def excess_of(residual_v: FloatArray, known_v2: FloatArray, assumed_v2: float, clip_v2: float) -> tuple[float, float]:
    """Return the weighted sum of squared residuals less the variance that is known of them, and the sum of weights.

    Squares count up to ``clip_v2`` times what is expected. Rows whose prediction is itself uncertain tell little about
    the noise, and weigh accordingly.
    """
    total, weights = 0.0, 0.0
    for k in range(len(residual_v)):
        whole = known_v2[k] + assumed_v2
        weight = (assumed_v2 / whole) ** 2
        total += weight * (min(residual_v[k] * residual_v[k], clip_v2 * whole) - known_v2[k])
        weights += weight
    return total, weights


@kernel
def mean_powers(residual_v: FloatArray, known_v2: FloatArray, noise_v2: float, clip: float) -> FloatArray:
    """Return mean squares of scaled residuals, (8,): of single ones, then of means over 4, 16, … times their count.

    All are 1 for white residuals as large as expected. Where there are no two whole groups of a size, NaN stands.
    """
    n = len(residual_v)
    sums = np.zeros(SIZES)
    powers = np.zeros(SIZES + 1)
    for k in range(n):
        scaled = residual_v[k] / np.sqrt(known_v2[k] + noise_v2)
        scaled = min(max(scaled, -clip), clip)
        powers[0] += scaled * scaled
        size = FIRST_SIZE
        carried = scaled
        for j in range(SIZES):
            sums[j] += carried
            if (k + 1) % size != 0:
                break
            carried = sums[j]
            powers[j + 1] += carried * carried / size
            sums[j] = 0.0
            size *= GROWTH
    powers[0] /= n
    size = FIRST_SIZE
    for j in range(SIZES):
        powers[j + 1] = powers[j + 1] / (n // size) if n // size > 1 else np.nan
        size *= GROWTH
    return powers
