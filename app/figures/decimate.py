"""Fewer samples for the same picture."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from app.science.arrays import FloatArray, IntArray


def minmax_indices(values: FloatArray, points: int) -> IntArray:
    """Choose the samples that keep a curve's look: smallest and largest of every window, and the first and last.

    A spike of a single sample survives. A gap (NaN) at least as long as a window stays a gap, since the first NaN
    of a window is kept too.

    Parameters
    ----------
    values : array, shape (n,)
        In the order of time; NaN where unknown.
    points : int
        At most so many samples are kept; at least 8.

    Returns
    -------
    integer array
        Rising indices; all of them when ``n <= points``.
    """
    n, points = len(values), max(points, 8)
    if n <= points:
        return np.arange(n)
    known = np.isfinite(values)
    gapless = bool(known.all())
    windows = window_rows(values, (points - 2) // (2 if gapless else 3))
    start = np.arange(len(windows)) * windows.shape[1]
    if gapless:
        windows[-1, np.isnan(windows[-1])] = values[-1]
        kept = [start + windows.argmin(axis=1), start + windows.argmax(axis=1)]
    else:
        gap = ~np.isfinite(windows)
        first_gap = (start + gap.argmax(axis=1))[gap.any(axis=1)]
        inside = ~gap.all(axis=1)
        lowest = start + np.where(gap, np.inf, windows).argmin(axis=1)
        highest = start + np.where(gap, -np.inf, windows).argmax(axis=1)
        kept = [lowest[inside], highest[inside], first_gap]
    chosen = np.unique(np.concatenate([[0, n - 1], *kept]))
    return chosen[chosen < n]


def even_indices(count: int, most: int) -> IntArray:
    """Choose at most ``most`` of ``count`` things evenly, first and last included: a fair sample, blind to values."""
    return np.unique(np.linspace(0, count - 1, min(most, count)).round().astype(np.int64))


@dataclass(frozen=True, slots=True)
class Band:
    """A band around a curve, arrays of shape (k,); NaN where it is interrupted."""

    t_s: FloatArray
    lower: FloatArray
    upper: FloatArray


def band(t_s: FloatArray, lower: FloatArray, upper: FloatArray, windows: int) -> Band:
    """Reduce a band to ``windows`` steps that cover it: lowest lower and highest upper edge of each.

    Parameters
    ----------
    t_s, lower, upper : array, shape (n,)
    windows : int
    """
    if len(t_s) <= windows:
        return Band(t_s, lower, upper)
    known = np.isfinite(lower) & np.isfinite(upper)
    low = window_rows(np.where(known, lower, np.inf), windows, np.inf).min(axis=1)
    high = window_rows(np.where(known, upper, -np.inf), windows, -np.inf).max(axis=1)
    times = window_rows(t_s, windows, t_s[-1])
    middle = 0.5 * (times[:, 0] + times[:, -1])
    middle[0], middle[-1] = t_s[0], t_s[-1]
    return Band(middle, np.where(np.isfinite(low), low, np.nan), np.where(np.isfinite(high), high, np.nan))


def window_rows(values: FloatArray, windows: int, fill: float = np.nan) -> FloatArray:
    """Cut into at most ``windows`` rows of equal width, the last one filled up with ``fill``."""
    width = -(-len(values) // max(windows, 1))
    rows = -(-len(values) // width)
    padded = np.full(rows * width, fill)
    padded[: len(values)] = values
    return padded.reshape(rows, width)
