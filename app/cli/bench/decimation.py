"""Decimation of a long trace for a plot, against the same windows in plain Python."""

from __future__ import annotations

import numpy as np

from app.cli.bench.figure import Figure, best_seconds, timed
from app.figures.decimate import minmax_indices

SAMPLES = 1_000_000
POINTS = 4000


def measure() -> list[Figure]:
    """Return the time to choose 4,000 of a million samples."""
    values = np.random.default_rng(1).normal(size=SAMPLES).cumsum()
    ours = best_seconds(lambda: minmax_indices(values, POINTS))
    plain = timed(lambda: plain_minmax(values.tolist(), POINTS))
    return [Figure("decimating a million samples to 4,000", 1e3 * ours, "ms", 1e3 * plain, "plain Python")]


def plain_minmax(values: list[float], points: int) -> list[int]:
    """Choose the smallest and the largest of every window."""
    width = -(-len(values) // ((points - 2) // 2))
    chosen = {0, len(values) - 1}
    for begin in range(0, len(values), width):
        window = range(begin, min(begin + width, len(values)))
        chosen |= {min(window, key=values.__getitem__), max(window, key=values.__getitem__)}
    return sorted(chosen)
