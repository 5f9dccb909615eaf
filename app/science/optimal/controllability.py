"""Can a control reach every state nearby: the rank of the Lie brackets (Sebesta 2010, B.2)."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np

from app.science.arrays import AnyArray, FloatArray

VectorField = Callable[[AnyArray], Any]
"""Takes a state (2,), complex too, and returns its rate."""

STEP = 1e-30


def bracket_rank(f: VectorField, g: VectorField, state: tuple[float, float]) -> int:
    """Return the rank of (g, [f, g]) of x' = f(x) + g(x) u with two states; 2 where it is locally controllable.

    [f, g] = ∂g/∂x f − ∂f/∂x g; on a linear system this is Kalman's (B, −AB). Each column counts by its direction,
    whatever its unit.
    """
    x = np.array(state, dtype=np.float64)
    bracket = _jacobian(g, x) @ _at(f, x) - _jacobian(f, x) @ _at(g, x)
    columns = np.column_stack((_at(g, x), bracket))
    size = np.linalg.norm(columns, axis=0)
    return int(np.linalg.matrix_rank(columns / np.where(size > 0.0, size, 1.0)))


def _at(field: VectorField, x: FloatArray) -> FloatArray:
    return np.asarray(np.real(field(x.astype(np.complex128))))


def _jacobian(field: VectorField, x: FloatArray) -> FloatArray:
    """Return ∂field/∂x by complex steps, exact to rounding."""
    return np.column_stack([np.imag(field(x + 1j * STEP * unit)) / STEP for unit in np.eye(len(x))])
