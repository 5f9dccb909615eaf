"""Staying on a planned drive: the linear quadratic regulator about it (Sebesta 2010, B.2.2).

(B.7) lacks a minus before Q, and (B.8-B.9) stand for the usual K = (BᵀSB + R)⁻¹ BᵀSA; SciPy solves both equations.
"""

from __future__ import annotations

import numpy as np
from scipy.linalg import solve_continuous_are, solve_discrete_are

from app.science.arrays import FloatArray


def continuous_gain(a: FloatArray, b: FloatArray, q: FloatArray, r: FloatArray) -> FloatArray:
    """Return K of u = −K x, shape (controls, n), for x' = A x + B u and ½ ∫ xᵀQx + uᵀRu dt (Sebesta 2010, B.4-B.7)."""
    return np.asarray(np.linalg.solve(r, b.T @ solve_continuous_are(a, b, q, r)))


def discrete_gain(a: FloatArray, b: FloatArray, q: FloatArray, r: FloatArray) -> FloatArray:
    """Return K of u = −K x, shape (controls, n), for x⁺ = A x + B u and Σ xᵀQx + uᵀRu (Sebesta 2010, B.8-B.9)."""
    s = solve_discrete_are(a, b, q, r)
    return np.asarray(np.linalg.solve(b.T @ s @ b + r, b.T @ s @ a))
