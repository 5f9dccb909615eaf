"""Compiled filter and smoother of a quantity and its rate: {fuel energy, fuel power} and {engine angle, engine speed}.

Both blocks are ẋ₁ = x₂, ẋ₂ = 0 with white noise on each (Sebesta 2010, 1.16–1.17), so the transition is exact and a
Rauch–Tung–Striebel pass in closed form smooths them.
"""

import numpy as np

from app.science.arrays import AnyArray, FloatArray
from app.science.jit import kernel

PAIR_NODE, PAIR_LEVEL, PAIR_RATE, PAIR_REANCHOR = 0, 1, 2, 3
REANCHOR_VARIANCE = 1e12


@kernel
def filter_pair(
    t: FloatArray,
    kind: AnyArray,
    y: FloatArray,
    r: FloatArray,
    q_level: float,
    q_rate: float,
    level_variance: float,
    rate_variance: float,
    smooth: bool,
    innovation: FloatArray,
    innovation_sd: FloatArray,
    node_x: FloatArray,
    node_variance: FloatArray,
) -> int:
    """Filter, and if asked smooth, one pair over events sorted by time.

    Parameters
    ----------
    t, kind, y, r : array, shape (n,)
        Time, kind (`PAIR_NODE` …), measured value and noise variance. A `PAIR_REANCHOR` lets go of the level: the
        next measurement of it says nothing of the rate in between.
    q_level, q_rate : float
        Spectral densities.
    level_variance, rate_variance : float
        Start variances; the start state is zero.
    smooth : bool
    innovation, innovation_sd : array, shape (n,)
        Filled where a measurement was taken in.
    node_x, node_variance : array, shape (nodes, 2)
        Filled with the state and its variances at each node.

    Returns
    -------
    int
        −1, or the index of the event at which the numbers stopped being finite.
    """
    n = len(t)
    before = np.zeros((n, 5))
    after = np.zeros((n, 5))
    level, rate = 0.0, 0.0
    p00, p01, p11 = level_variance, 0.0, rate_variance
    now = t[0] if n else 0.0
    node = 0
    for i in range(n):
        dt = t[i] - now
        now = t[i]
        level += dt * rate
        p00 += dt * (2.0 * p01 + dt * p11) + dt * q_level + dt * dt * dt * q_rate / 3.0
        p01 += dt * p11 + 0.5 * dt * dt * q_rate
        p11 += dt * q_rate
        k = kind[i]
        if k == PAIR_REANCHOR:
            p00 += REANCHOR_VARIANCE
        before[i, 0], before[i, 1], before[i, 2], before[i, 3], before[i, 4] = level, rate, p00, p01, p11
        if k == PAIR_LEVEL:
            total = p00 + r[i]
            e = y[i] - level
            innovation[i], innovation_sd[i] = e, np.sqrt(total)
            g0, g1 = p00 / total, p01 / total
            level += g0 * e
            rate += g1 * e
            p11 -= g1 * p01
            p01 *= r[i] / total
            p00 = g0 * r[i]
        elif k == PAIR_RATE:
            total = p11 + r[i]
            e = y[i] - rate
            innovation[i], innovation_sd[i] = e, np.sqrt(total)
            g0, g1 = p01 / total, p11 / total
            level += g0 * e
            rate += g1 * e
            p00 -= g0 * p01
            p01 *= r[i] / total
            p11 = g1 * r[i]
        if not (np.isfinite(level) and np.isfinite(rate)):
            return i
        after[i, 0], after[i, 1], after[i, 2], after[i, 3], after[i, 4] = level, rate, p00, p01, p11
        if k == PAIR_NODE:
            node_x[node, 0], node_x[node, 1] = level, rate
            node_variance[node, 0], node_variance[node, 1] = p00, p11
            node += 1
    if smooth and n > 0:
        _smooth_pair(t, kind, before, after, node_x, node_variance)
    return -1


@kernel
def _smooth_pair(
    t: FloatArray,
    kind: AnyArray,
    before: FloatArray,
    after: FloatArray,
    node_x: FloatArray,
    node_variance: FloatArray,
) -> None:
    n = len(t)
    node = node_x.shape[0]
    s0, s1, s00, s01, s11 = after[n - 1]
    for i in range(n - 1, -1, -1):
        if i < n - 1:
            dt = t[i + 1] - t[i]
            a0, a1, a00, a01, a11 = after[i]
            b0, b1, b00, b01, b11 = before[i + 1]
            determinant = b00 * b11 - b01 * b01
            # cross covariance of the state here with the predicted one there: P Φᵀ
            c00, c01 = a00 + dt * a01, a01
            c10, c11 = a01 + dt * a11, a11
            g00 = (c00 * b11 - c01 * b01) / determinant
            g01 = (c01 * b00 - c00 * b01) / determinant
            g10 = (c10 * b11 - c11 * b01) / determinant
            g11 = (c11 * b00 - c10 * b01) / determinant
            d0, d1 = s0 - b0, s1 - b1
            d00, d01, d11 = s00 - b00, s01 - b01, s11 - b11
            s0 = a0 + g00 * d0 + g01 * d1
            s1 = a1 + g10 * d0 + g11 * d1
            s00 = a00 + g00 * g00 * d00 + 2.0 * g00 * g01 * d01 + g01 * g01 * d11
            s01 = a01 + g00 * g10 * d00 + (g00 * g11 + g01 * g10) * d01 + g01 * g11 * d11
            s11 = a11 + g10 * g10 * d00 + 2.0 * g10 * g11 * d01 + g11 * g11 * d11
        if kind[i] == PAIR_NODE:
            node -= 1
            node_x[node, 0], node_x[node, 1] = s0, s1
            node_variance[node, 0], node_variance[node, 1] = max(s00, 0.0), max(s11, 0.0)
