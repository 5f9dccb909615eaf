"""What samples at given times tell, where every output has times of its own (Sebesta 2010, Note 18)."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from typing import Any

import numpy as np

from app.science.arrays import AnyArray, FloatArray

STEP = 1e-40


def sampled_derivatives(
    solution: Callable[[AnyArray, float], AnyArray],
    outputs: Sequence[Callable[[AnyArray], Any]],
    x0: FloatArray,
    samples: Iterable[tuple[float, int]],
) -> FloatArray:
    """Return ∂y/∂x₀ of samples: the states that they tell are `rank.ranked` of it.

    A system that tells its state to continuous outputs, or to samples of all outputs together, need not do so when
    the outputs are sampled in turn.

    Parameters
    ----------
    solution : callable
        State after some time from a start, both complex arrays of shape (n,); analytic, for complex steps are taken.
    outputs : sequence of callable
        y = h(x).
    x0 : array, shape (n,)
    samples : iterable of (time, index of the output)

    Returns
    -------
    array, shape (samples, n)
    """
    starts = x0 + STEP * 1j * np.eye(len(x0))
    rows = [[np.imag(outputs[which](solution(start, t))) / STEP for start in starts] for t, which in samples]
    return np.array(rows, np.float64)
