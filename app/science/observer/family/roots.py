"""Triangular square roots: making them, and adding to or taking from what they are the root of."""

import numpy as np

from app.science.arrays import FloatArray
from app.science.jit import inline_kernel


@inline_kernel
def cholesky(p: FloatArray, root: FloatArray) -> bool:
    """Fill ``root`` with the lower triangle L of p = L Lᵀ; False when ``p`` is not positive definite."""
    n = p.shape[0]
    for j in range(n):
        for i in range(j):
            root[i, j] = 0.0
        total = p[j, j]
        for k in range(j):
            total -= root[j, k] * root[j, k]
        if not total > 0.0:
            return False
        diagonal = np.sqrt(total)
        root[j, j] = diagonal
        for i in range(j + 1, n):
            value = p[i, j]
            for k in range(j):
                value -= root[i, k] * root[j, k]
            root[i, j] = value / diagonal
    return True


@inline_kernel
def triangularise(m: FloatArray, root: FloatArray) -> None:
    """Fill ``root`` with the lower triangle L of m mᵀ = L Lᵀ by Householder reflections; ``m`` (n, k) is destroyed.

    This is the triangular factor that Sebesta 2010 (A.22) means, where its text asks for the orthogonal one.
    """
    n, width = m.shape
    for i in range(n):
        norm = 0.0
        for c in range(i, width):
            norm += m[i, c] * m[i, c]
        norm = np.sqrt(norm)
        alpha = -norm if m[i, i] > 0.0 else norm
        first = m[i, i] - alpha
        length = first * first
        for c in range(i + 1, width):
            length += m[i, c] * m[i, c]
        if length > 0.0:
            m[i, i] = first
            for r in range(i + 1, n):
                along = 0.0
                for c in range(i, width):
                    along += m[r, c] * m[i, c]
                along *= 2.0 / length
                for c in range(i, width):
                    m[r, c] -= along * m[i, c]
        sign = -1.0 if alpha < 0.0 else 1.0
        root[i, i] = abs(alpha)
        for r in range(i + 1, n):
            root[r, i] = sign * m[r, i]
            root[i, r] = 0.0


@inline_kernel
def add_rank_one(root: FloatArray, vector: FloatArray, sign: float) -> bool:
    """Make ``root`` the root of L Lᵀ ± v vᵀ; ``vector`` is destroyed. False when nothing positive is left."""
    n = root.shape[0]
    for j in range(n):
        if vector[j] == 0.0:
            continue
        squared = root[j, j] * root[j, j] + sign * vector[j] * vector[j]
        if not squared > 0.0:
            return False
        diagonal = np.sqrt(squared)
        c, s = diagonal / root[j, j], vector[j] / root[j, j]
        root[j, j] = diagonal
        for i in range(j + 1, n):
            root[i, j] = (root[i, j] + sign * s * vector[i]) / c
            vector[i] = c * vector[i] - s * root[i, j]
    return True


@inline_kernel
def correct_root(root: FloatArray, along: FloatArray, variance: float, gain: FloatArray) -> float:
    """Take in a scalar measurement: (A.24)–(A.26) of Sebesta 2010 by plane rotations.

    Parameters
    ----------
    root : array, shape (n, n)
        S⁻, becomes S.
    along : array, shape (n,)
        Hᵀ seen through the root, S⁻ᵀ Hᵀ.
    variance : float
        R.
    gain : array, shape (n,)
        Filled with K̄, the gain times W.

    Returns
    -------
    float
        W, the innovation's standard deviation.
    """
    n = root.shape[0]
    w = np.sqrt(variance)
    for i in range(n):
        gain[i] = 0.0
    for j in range(n - 1, -1, -1):
        if along[j] == 0.0:
            continue
        both = np.hypot(w, along[j])
        c, s = w / both, along[j] / both
        w = both
        for i in range(j, n):
            left, right = gain[i], root[i, j]
            gain[i] = c * left + s * right
            root[i, j] = c * right - s * left
    return float(w)


@inline_kernel
def solve_upper(root: FloatArray, b: FloatArray) -> None:
    """Replace ``b`` (n,) by L⁻ᵀ b."""
    for i in range(len(b) - 1, -1, -1):
        value = b[i]
        for k in range(i + 1, len(b)):
            value -= root[k, i] * b[k]
        b[i] = value / root[i, i]


@inline_kernel
def multiply_out(root: FloatArray, p: FloatArray) -> None:
    """Fill ``p`` with L Lᵀ."""
    n = root.shape[0]
    for i in range(n):
        for j in range(i + 1):
            total = 0.0
            for k in range(j + 1):
                total += root[i, k] * root[j, k]
            p[i, j] = total
            p[j, i] = total
