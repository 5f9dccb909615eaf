"""What both filters do at the end of a row."""

from __future__ import annotations

from app.science.arrays import FloatArray, IntArray
from app.science.battery.kalman.layout import PARAMETERS, STATES, Noise, Trace
from app.science.jit import inline_kernel


@inline_kernel
def bound(mean: FloatArray, noise: Noise) -> None:
    """Keep the parameters between their limits."""
    for j in range(PARAMETERS):
        mean[j] = min(max(mean[j], noise.lowest[j]), noise.highest[j])


@inline_kernel
def note(trace: Trace, keep: IntArray, place: int, k: int, mean: FloatArray, covariance: FloatArray) -> int:
    """Write the estimate down as often as row ``k`` is kept; return the next place."""
    while place < len(keep) and keep[place] == k:
        for j in range(STATES):
            trace.means[place, j] = mean[j]
            trace.variances[place, j] = covariance[j, j]
        place += 1
    return place
