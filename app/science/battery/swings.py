"""What goes to and fro while something else stands still: the mark of a sensor that is stuck."""

from __future__ import annotations

import numpy as np

from app.science.arrays import FloatArray, IntArray

LONG_RUN = 20
"""Rows of one value, from which on slow swings tell, too."""


def swings(values: FloatArray, begins: IntArray, ends: IntArray, wide: float) -> IntArray:
    """Return how often values cross the middle of each run of rows, by ``wide`` in all.

    Noise of less than ``wide`` crosses nothing, and what only rises or falls crosses once.

    Parameters
    ----------
    values : ndarray (n,)
        NaN rows count for nothing.
    begins, ends : ndarray (m,)
        Of runs that cover all rows, in order.
    wide : float
    """
    middle = 0.5 * (np.fmax.reduceat(values, begins) + np.fmin.reduceat(values, begins))  # NaN where nothing is known
    run = np.repeat(np.arange(len(begins)), ends - begins)
    off = values - middle[run]
    rows = np.flatnonzero(np.abs(off) > 0.5 * wide)
    crossed = (np.diff(np.sign(off[rows])) != 0.0) & (np.diff(run[rows]) == 0)
    return np.bincount(run[rows][1:][crossed], minlength=len(begins)).astype(np.int64)


def repeats_by_itself(begins: IntArray, ends: IntArray, share: float = 0.2) -> bool:
    """Tell whether a column often repeats its value outside of long runs: then a long one proves nothing."""
    lengths = (ends - begins)[ends - begins < LONG_RUN]
    return len(lengths) == 0 or 1.0 - len(lengths) / lengths.sum() > share
