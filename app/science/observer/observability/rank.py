"""The rank test on Lie derivatives (Sebesta 2010, A.1.2.1), and which states it says are told."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from app.science.arrays import BoolArray, FloatArray
from app.science.observer.observability.jets import Field, Output, flow

STEP = 1e-40
TOLERANCE = 1e-10
"""Singular values below this share of the largest count as zero."""
LEANING = 1e-5
"""A state that leans less than this on the unobservable directions is told."""


@dataclass(frozen=True, slots=True)
class Ranked:
    """Which directions of the state a matrix of output derivatives tells.

    Attributes
    ----------
    rank : int
    told : boolean array, shape (states,)
        Whether a state is orthogonal to everything that leaves the outputs as they are.
    singular_values : array, shape (states,)
        Falling, the largest is 1.
    gap : float
        Smallest singular value that counts over the largest that doesn't (at least rounding): how clear the answer is.
    """

    rank: int
    told: BoolArray
    singular_values: FloatArray
    gap: float


def lie_derivatives(
    field: Field, outputs: Mapping[str, Output], x0: FloatArray, scale: FloatArray, horizon_s: float
) -> dict[str, FloatArray]:
    """Return ∂/∂x₀ of each output's first n Lie derivatives (A.3–A.4), exact to rounding.

    The flow is developed in time; complex steps of the start give the derivatives. Derivative k comes times
    ``horizon_s``ᵏ / k!, which is its part of the output after that time, and each column times ``scale``, so that
    numbers of the same size are compared. Neither changes a rank.

    Parameters
    ----------
    field : callable
        ẋ = f(x).
    outputs : mapping of str to callable
        y = h(x).
    x0, scale : array, shape (n,)
    horizon_s : float

    Returns
    -------
    dict of str to array, shape (n, n)
        Derivatives along the rows, states along the columns.
    """
    n = len(x0)
    start = x0[:, None] + STEP * 1j * np.diag(scale)
    series = flow(field, start, n)
    powers = horizon_s ** np.arange(n)[:, None]
    return {name: powers * output(series).c.imag / STEP for name, output in outputs.items()}


def ranked(rows: FloatArray, tolerance: float = TOLERANCE) -> Ranked:
    """Return the rank of a matrix of output derivatives and the states it tells.

    Parameters
    ----------
    rows : array, shape (m, n)
        Columns scaled to the states' usual sizes.
    tolerance : float
        Share of the largest singular value below which one counts as zero.
    """
    n = rows.shape[1]
    padded = np.concatenate([rows, np.zeros((max(n - len(rows), 0), n))])
    _, values, directions = np.linalg.svd(padded, full_matrices=False)
    if values[0] == 0.0:
        return Ranked(0, np.zeros(n, np.bool_), values, np.inf)
    values = values / values[0]
    rank = int(np.count_nonzero(values > tolerance))
    told = np.linalg.norm(directions[rank:], axis=0) < LEANING
    dropped = max(float(values[rank]), np.finfo(np.float64).eps) if rank < n else np.finfo(np.float64).eps
    return Ranked(rank, told, values, float(values[rank - 1]) / dropped)


def balanced(blocks: Sequence[FloatArray]) -> FloatArray:
    """Put blocks of derivatives below each other, each brought to the same size; those that are all zero stay so."""
    return np.concatenate([block / (np.abs(block).max() or 1.0) for block in blocks])
