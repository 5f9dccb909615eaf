"""Compiled filter and smoother of a quantity whose rate follows a local polynomial (Sebesta 2010, Note 12).

The chain is ẋ₁ = x₂, …, ẋₙ = 0 with white noise on each, so its transition is exact; `pair_kernels` is the case of two.
"""

import numpy as np

from app.science.arrays import AnyArray, FloatArray
from app.science.jit import inline_kernel, kernel
from app.science.observer.family.dense import congruence, product
from app.science.observer.pair_kernels import PAIR_LEVEL, PAIR_NODE, PAIR_RATE, PAIR_REANCHOR, REANCHOR_VARIANCE


@inline_kernel
def _transition(dt: float, phi: FloatArray) -> None:
    n = phi.shape[0]
    for i in range(n):
        term = 1.0
        for j in range(n):
            phi[i, j] = 0.0
        for j in range(i, n):
            phi[i, j] = term
            term *= dt / (j - i + 1)


@inline_kernel
def _add_noise(p: FloatArray, q: FloatArray, dt: float) -> None:
    """Add ∫ Φ(s) Q Φ(s)ᵀ ds over the step."""
    n = p.shape[0]
    for source in range(n):
        for i in range(source + 1):
            for j in range(source + 1):
                a, b = source - i, source - j
                scale = 1.0
                for k in range(1, a + 1):
                    scale /= k
                for k in range(1, b + 1):
                    scale /= k
                p[i, j] += q[source] * scale * dt ** (a + b + 1) / (a + b + 1)


@kernel
def filter_chain(
    t: FloatArray,
    kind: AnyArray,
    y: FloatArray,
    r: FloatArray,
    q: FloatArray,
    start_variance: FloatArray,
    smooth: bool,
    innovation: FloatArray,
    innovation_sd: FloatArray,
    node_x: FloatArray,
    node_variance: FloatArray,
) -> int:
    """Filter, and if asked smooth (Rauch–Tung–Striebel), one chain of n states over events sorted by time.

    Parameters
    ----------
    t, kind, y, r, smooth, innovation, innovation_sd
        As for `pair_kernels.filter_pair`.
    q, start_variance : array, shape (n,)
        Spectral densities, and variances of the start state, which is zero.
    node_x, node_variance : array, shape (nodes, n)

    Returns
    -------
    int
        −1, or the index of the event at which the numbers stopped being finite.
    """
    count, n = len(t), len(q)
    before_x, before_p = np.zeros((count, n)), np.zeros((count, n, n))
    after_x, after_p = np.zeros((count, n)), np.zeros((count, n, n))
    x, p, phi, scratch = np.zeros(n), np.diag(start_variance), np.zeros((n, n)), np.zeros((n, n))
    moved = np.zeros(n)
    now = t[0] if count else 0.0
    node = 0
    for i in range(count):
        _transition(t[i] - now, phi)
        for a in range(n):
            moved[a] = 0.0
            for b in range(a, n):
                moved[a] += phi[a, b] * x[b]
        x[:] = moved
        congruence(phi, p, scratch)
        _add_noise(p, q, t[i] - now)
        now = t[i]
        k = kind[i]
        if k == PAIR_REANCHOR:
            p[0, 0] += REANCHOR_VARIANCE
        before_x[i], before_p[i] = x, p
        if k in (PAIR_LEVEL, PAIR_RATE):
            row = 0 if k == PAIR_LEVEL else 1
            total = p[row, row] + r[i]
            e = y[i] - x[row]
            innovation[i], innovation_sd[i] = e, np.sqrt(total)
            direction = p[row].copy()
            for a in range(n):
                x[a] += direction[a] * e / total
                for b in range(n):
                    p[a, b] -= direction[a] * direction[b] / total
        if not (np.isfinite(x[0]) and np.isfinite(x[1])):
            return i
        after_x[i], after_p[i] = x, p
        if k == PAIR_NODE:
            node_x[node] = x
            node_variance[node] = np.diag(p)
            node += 1
    if smooth and count > 0:
        _smooth_chain(t, kind, before_x, before_p, after_x, after_p, node_x, node_variance)
    return -1


@kernel
def _smooth_chain(
    t: FloatArray,
    kind: AnyArray,
    before_x: FloatArray,
    before_p: FloatArray,
    after_x: FloatArray,
    after_p: FloatArray,
    node_x: FloatArray,
    node_variance: FloatArray,
) -> None:
    count, n = after_x.shape
    node = node_x.shape[0]
    x, p = after_x[count - 1].copy(), after_p[count - 1].copy()
    phi, cross, difference, scratch = np.zeros((n, n)), np.zeros((n, n)), np.zeros((n, n)), np.zeros((n, n))
    for i in range(count - 1, -1, -1):
        if i < count - 1:
            _transition(t[i + 1] - t[i], phi)
            product(after_p[i], phi.T, cross)
            gain = np.linalg.solve(before_p[i + 1], cross.T).T
            own = after_x[i].copy()
            for a in range(n):
                for b in range(n):
                    own[a] += gain[a, b] * (x[b] - before_x[i + 1, b])
                    difference[a, b] = p[a, b] - before_p[i + 1, a, b]
            congruence(gain, difference, scratch)
            x, p = own, after_p[i] + difference
        if kind[i] == PAIR_NODE:
            node -= 1
            for a in range(n):
                node_x[node, a] = x[a]
                node_variance[node, a] = max(p[a, a], 0.0)
