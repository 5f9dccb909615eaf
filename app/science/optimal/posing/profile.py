"""Heights along a road: filled in, smoothed, and thinned out to the points that matter."""

from __future__ import annotations

import numpy as np

from app.science.arrays import BoolArray, FloatArray, IntArray

REACH = 4.0
"""Standard deviations that the smoothing window extends to either side."""
GRIDS_PER_WIDTH = 4.0
FINEST_M, COARSEST_M = 2.0, 25.0


def smoothed(distance_m: FloatArray, elevation_m: FloatArray, width_m: float) -> tuple[FloatArray, FloatArray]:
    """Return heights averaged with a Gaussian over distance, on an even grid of their own.

    Beyond the ends the profile is continued by turning it about its end point, so heights and slopes there are kept.

    Parameters
    ----------
    distance_m, elevation_m : array, shape (n,)
        Growing distances, linear between them.
    width_m : float
        Standard deviation of the Gaussian; 0 leaves everything as it is.

    Returns
    -------
    distance_m, elevation_m : array, shape (k,)
    """
    length = distance_m[-1] - distance_m[0]
    width = min(width_m, length / REACH)
    if width <= 0.0:
        return distance_m, elevation_m
    count = int(np.ceil(length / np.clip(width / GRIDS_PER_WIDTH, FINEST_M, COARSEST_M))) + 1
    grid = np.linspace(distance_m[0], distance_m[-1], max(count, 2 * int(REACH) + 2))
    heights = np.interp(grid, distance_m, elevation_m)
    step = length / (grid.size - 1)
    reach = min(int(np.ceil(REACH * width / step)), grid.size - 1)
    window = np.exp(-0.5 * (np.arange(-reach, reach + 1) * step / width) ** 2)
    before = 2.0 * heights[0] - heights[reach:0:-1]
    after = 2.0 * heights[-1] - heights[-2 : -reach - 2 : -1]
    return grid, np.convolve(np.concatenate((before, heights, after)), window / window.sum(), mode="valid")


def thinned(distance_m: FloatArray, elevation_m: FloatArray, tolerance_m: float, kept: BoolArray) -> IntArray:
    """Return which points to keep so that straight lines between them miss no height by more than a tolerance.

    Douglas and Peucker's algorithm, with heights instead of distances from the line.

    Parameters
    ----------
    distance_m, elevation_m : array, shape (n,)
    tolerance_m : float
    kept : bool array, shape (n,)
        Points that stay in any case; the ends do, too.
    """
    keep = kept.copy()
    keep[[0, -1]] = True
    marks = np.flatnonzero(keep)
    open_parts = list(zip(marks[:-1].tolist(), marks[1:].tolist(), strict=True))
    while open_parts:
        a, b = open_parts.pop()
        if b - a < 2:
            continue
        s, z = distance_m[a : b + 1], elevation_m[a : b + 1]
        line = z[0] + (z[-1] - z[0]) * (s - s[0]) / (s[-1] - s[0])
        off = np.abs(z - line)
        worst = int(off.argmax())
        if off[worst] > tolerance_m:
            keep[a + worst] = True
            open_parts += [(a, a + worst), (a + worst, b)]
    return np.flatnonzero(keep)


def climbed_m(elevation_m: FloatArray) -> float:
    """Return the sum of all rises, m."""
    return float(np.maximum(np.diff(elevation_m), 0.0).sum())
