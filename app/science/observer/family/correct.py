"""What the filters do with one scalar measurement, and with the covariance when a gate has to be opened."""

import numpy as np

from app.science.arrays import FloatArray, IntArray
from app.science.jit import inline_kernel
from app.science.observer.family.methods import SQUARE_ROOT, UNSCENTED, UNSCENTED_ROOT, SigmaSpread, Work
from app.science.observer.family.roots import (
    add_rank_one,
    cholesky,
    correct_root,
    multiply_out,
    solve_upper,
)
from app.science.observer.motion_kernels import (
    ACC_I,
    ACC_J,
    ACC_K,
    ACC_X,
    BI,
    BK,
    SJ,
    SK,
    YAW_RATE,
    F,
    MotionModel,
    V,
    measure,
)


@inline_kernel
def holds_root(method: int) -> bool:
    """Whether a filter carries a square root instead of the covariance."""
    return method in (SQUARE_ROOT, UNSCENTED_ROOT)


@inline_kernel
def needs_sigma_points(method: int, kind: int) -> bool:
    """Whether the unscented transform of a measurement differs from the linear one."""
    curved = kind >= ACC_X or kind in (ACC_I, ACC_J, ACC_K, YAW_RATE)
    return curved and method in (UNSCENTED, UNSCENTED_ROOT)


@inline_kernel
def predict_linear(
    method: int, s: FloatArray, index: IntArray, slope: FloatArray, count: int, along: FloatArray, direction: FloatArray
) -> float:
    """Fill ``direction`` (n,) with P Hᵀ, for a root also ``along`` with Sᵀ Hᵀ; return H P Hᵀ."""
    n = s.shape[0]
    if holds_root(method):
        for c in range(n):
            along[c] = 0.0
            for k in range(count):
                along[c] += slope[k] * s[index[k], c]
        for i in range(n):
            value = 0.0
            for c in range(i + 1):
                value += s[i, c] * along[c]
            direction[i] = value
    else:
        for c in range(n):
            value = 0.0
            for k in range(count):
                value += slope[k] * s[index[k], c]
            direction[c] = value
    total = 0.0
    for k in range(count):
        total += slope[k] * direction[index[k]]
    return float(total)


@inline_kernel
def predict_sigma(
    method: int,
    kind: int,
    x: FloatArray,
    s: FloatArray,
    model: MotionModel,
    mass_a: float,
    spread: SigmaSpread,
    index: IntArray,
    slope: FloatArray,
    direction: FloatArray,
    row: FloatArray,
    work: Work,
) -> tuple[float, float]:
    """Predict a measurement through sigma points; returns its mean and variance, NaN when there is no root.

    ``direction`` (n,) receives the cross covariance and ``row`` (n,) the statistically linearised row of H.
    """
    n = len(x)
    root = s
    if not holds_root(method):
        root = work.m1
        if not cholesky(s, root):
            return np.nan, np.nan
    point, seen = work.v1, work.middle
    centre, _ = measure(kind, x, model, mass_a, index, slope)
    mean = spread.mean_0 * centre
    variance = 0.0
    for c in range(n):
        for i in range(n):
            point[i] = x[i] + spread.distance * root[i, c]
        up, _ = measure(kind, point, model, mass_a, index, slope)
        for i in range(n):
            point[i] = x[i] - spread.distance * root[i, c]
        down, _ = measure(kind, point, model, mass_a, index, slope)
        mean += spread.other * (up + down)
        work.sigma[1 + c, 0], work.sigma[1 + n + c, 0] = up, down
        seen[c] = spread.other * spread.distance * (up - down)
    variance = spread.covariance_0 * (centre - mean) ** 2
    for k in range(1, 2 * n + 1):
        variance += spread.other * (work.sigma[k, 0] - mean) ** 2
    for i in range(n):
        value = 0.0
        for c in range(i + 1):
            value += root[i, c] * seen[c]
        direction[i] = value
        row[i] = seen[i]
    solve_upper(root, row)
    return mean, variance


@inline_kernel
def correct_linear(
    method: int, x: FloatArray, s: FloatArray, along: FloatArray, direction: FloatArray, e: float, r: float,
    total: float, gain: FloatArray,
) -> None:  # fmt: skip
    """Take in a measurement whose row is linear: x += P Hᵀ e / S, and the covariance or its root with it."""
    n = len(x)
    weight = e / total
    for i in range(n):
        x[i] += direction[i] * weight
    if holds_root(method):
        correct_root(s, along, r, gain)
    else:
        take_away(s, direction, total)


@inline_kernel
def take_away(p: FloatArray, direction: FloatArray, total: float) -> None:
    """Subtract d dᵀ / S from the covariance."""
    n = p.shape[0]
    for i in range(n):
        scaled = direction[i] / total
        for j in range(i + 1):
            p[i, j] -= scaled * direction[j]
            p[j, i] = p[i, j]


@inline_kernel
def correct_sigma(
    method: int, x: FloatArray, s: FloatArray, direction: FloatArray, e: float, total: float, work: Work
) -> bool:
    """Take in a measurement predicted through sigma points; False when the root can't be found any more."""
    weight = e / total
    for i in range(len(x)):
        x[i] += direction[i] * weight
    if not holds_root(method):
        take_away(s, direction, total)
        return True
    scale = 1.0 / np.sqrt(total)
    for i in range(len(x)):
        work.v1[i] = scale * direction[i]
    return add_rank_one(s, work.v1, -1.0)


@inline_kernel
def widen(method: int, s: FloatArray, state: int, variance: float, work: Work) -> None:
    """Add to the variance of one state."""
    if not holds_root(method):
        s[state, state] += variance
        return
    for i in range(s.shape[0]):
        work.v1[i] = 0.0
    work.v1[state] = np.sqrt(variance)
    add_rank_one(s, work.v1, 1.0)


@inline_kernel
def forget_motion(method: int, x: FloatArray, s: FloatArray, start_variance: FloatArray, work: Work) -> None:
    """Begin anew after a gap: all but the accelerometer's biases and the distance becomes unknown again."""
    n = len(x)
    p = s
    if holds_root(method):
        p = work.m1
        multiply_out(s, p)
    for i in range(V, n):
        if BI <= i <= BK:
            continue
        for j in range(n):
            p[i, j], p[j, i] = 0.0, 0.0
        p[i, i] = start_variance[i]
        if i in (V, F, SJ, SK) or i > BK:
            x[i] = 0.0
    if holds_root(method):
        cholesky(p, s)


@inline_kernel
def variance_of(method: int, s: FloatArray, state: int) -> float:
    """Return the variance of one state."""
    if not holds_root(method):
        return float(s[state, state])
    total = 0.0
    for k in range(state + 1):
        total += s[state, k] * s[state, k]
    return total
