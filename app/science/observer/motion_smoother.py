"""Compiled fixed-interval smoother of the motion block, back over what the filter left.

It is the modified Bryson–Frazier form (Bierman 1977): it needs no inverse of P. Only checkpoints of the filter are
kept; each stretch between two of them is filtered again on the way back, so memory does not grow with the number of
events.
"""

from typing import NamedTuple

import numpy as np

from app.science.arrays import AnyArray, FloatArray, IntArray
from app.science.jit import inline_kernel, kernel
from app.science.observer.motion_filter import RECOVERED, REJECTED, innovation_of, set_free
from app.science.observer.motion_kernels import (
    BI,
    BJ,
    BK,
    COLS,
    NODE,
    REANCHOR,
    RESET,
    ROW,
    ROWS,
    SIZE,
    D,
    E,
    MotionModel,
    N,
    V,
    X,
    add_process_noise,
    advance,
    correct,
    forget,
    gain_direction,
    measure,
    noise_variance,
    spread,
)


class SmootherState(NamedTuple):
    """Where the smoother stands between two calls: the adjoints λ (13,) and Λ (13, 13), and in ``node`` (1,) how many
    nodes are left.
    """

    lam: FloatArray
    big: FloatArray
    node: IntArray


def smoother_start(nodes: int) -> SmootherState:
    """Return where the smoother stands before the last event."""
    return SmootherState(np.zeros(SIZE), np.zeros((SIZE, SIZE)), np.array([nodes]))


@inline_kernel
def _back_through_correction(
    lam: FloatArray,
    big: FloatArray,
    index: IntArray,
    slope: FloatArray,
    count: int,
    direction: FloatArray,
    e: float,
    total: float,
    u: FloatArray,
) -> None:
    """Carry the adjoint over one measurement: λ ← λ − h (Kᵀλ + e/S), Λ ← (I − h Kᵀ) Λ (I − K hᵀ) + h hᵀ / S."""
    inverse = 1.0 / total
    along = 0.0
    for c in range(SIZE):
        along += direction[c] * lam[c]
    along = (along + e) * inverse
    for r in range(SIZE):
        value = 0.0
        for c in range(SIZE):
            value += big[r, c] * direction[c]
        u[r] = value * inverse
    curve = inverse
    for c in range(SIZE):
        curve += direction[c] * u[c] * inverse
    for k in range(count):
        row, h = index[k], slope[k]
        lam[row] -= h * along
        for c in range(SIZE):
            big[row, c] -= h * u[c]
    for k in range(count):
        col, h = index[k], slope[k]
        for r in range(SIZE):
            big[r, col] -= h * u[r]
    for k in range(count):
        for m in range(count):
            big[index[k], index[m]] += curve * slope[k] * slope[m]


@inline_kernel
def _back_through_time(lam: FloatArray, big: FloatArray, delta: FloatArray, w: FloatArray) -> None:
    """Carry the adjoint over one prediction: λ ← Φᵀ λ, Λ ← Φᵀ Λ Φ; ``w`` (6, 13) is scratch."""
    for k in range(6):
        col = COLS[k]
        for c in range(SIZE):
            w[k, c] = big[col, c]
    for r in range(7):
        row = ROWS[r]
        for k in range(6):
            d = delta[r, k]
            if d != 0.0:
                for c in range(SIZE):
                    w[k, c] += d * big[row, c]
    for k in range(6):
        for m in range(k + 1):
            value = w[k, COLS[m]]
            for r in range(7):
                value += delta[r, m] * w[k, ROWS[r]]
            big[COLS[k], COLS[m]] = value
            big[COLS[m], COLS[k]] = value
        for c in (X, N, E, D, BI, BJ, BK):
            big[COLS[k], c] = w[k, c]
            big[c, COLS[k]] = w[k, c]
    old = lam.copy()
    for k in range(6):
        value = old[COLS[k]]
        for r in range(7):
            value += delta[r, k] * old[ROWS[r]]
        lam[COLS[k]] = value


@kernel
def smooth_motion(
    t: FloatArray,
    kind: AnyArray,
    y: FloatArray,
    r: FloatArray,
    gear: AnyArray,
    boosted: AnyArray,
    model: MotionModel,
    start_variance: FloatArray,
    recovery_variance: FloatArray,
    every: int,
    checkpoint_x: FloatArray,
    checkpoint_p: FloatArray,
    outcome: AnyArray,
    node_x: FloatArray,
    node_variance: FloatArray,
    node_p: FloatArray,
    stride: int,
    state: SmootherState,
    first_stretch: int,
    last_stretch: int,
) -> None:
    """Run the smoother back over what `filter_motion` left; overwrites ``node_x``, ``node_variance`` and
    ``node_p``.

    One call goes through the stretches between checkpoints from ``last_stretch``, excluded, down to ``first_stretch``.
    """
    n = len(t)
    deltas = np.zeros((every, 7, 6))
    moved = np.zeros(every, np.bool_)
    indices = np.zeros((every, ROW), np.int64)
    slopes = np.zeros((every, ROW))
    counts = np.zeros(every, np.int64)
    directions = np.zeros((every, SIZE))
    errors = np.zeros(every)
    totals = np.zeros(every)
    stretch_x = np.zeros((every, SIZE))
    stretch_p = np.zeros((every, SIZE, SIZE))
    scratch = np.zeros((7, SIZE))
    w = np.zeros((6, SIZE))
    u = np.zeros(SIZE)
    half = np.zeros((SIZE, SIZE))
    lam, big = state.lam, state.big
    node = state.node[0]
    for stretch in range(last_stretch - 1, first_stretch - 1, -1):
        first = stretch * every
        last = min(first + every, n)
        x = checkpoint_x[stretch].copy()
        p = checkpoint_p[stretch].copy()
        now = t[first - 1] if first > 0 else t[0]
        for i in range(first, last):
            j = i - first
            mass_a = model.accelerated_mass[gear[i]]
            dt = t[i] - now
            moved[j] = dt > 0.0
            if moved[j]:
                advance(x, dt, model, mass_a, deltas[j])
                spread(p, deltas[j], scratch)
                add_process_noise(x, p, dt, model, boosted[i])
                now = t[i]
            k = kind[i]
            if k == NODE:
                stretch_x[j] = x
                stretch_p[j] = p
            elif k == RESET:
                forget(x, p, start_variance)
            elif k == REANCHOR:
                p[X, X] += r[i]
            elif outcome[i] != REJECTED:
                predicted, counts[j] = measure(k, x, model, mass_a, indices[j], slopes[j])
                if outcome[i] == RECOVERED:
                    set_free(p, k, indices[j, 0], recovery_variance, model)
                errors[j] = innovation_of(k, y[i], predicted)
                totals[j] = gain_direction(
                    p, indices[j], slopes[j], counts[j], directions[j], noise_variance(k, r[i], x, model)
                )
                correct(x, p, directions[j], errors[j], totals[j])
        for i in range(last - 1, first - 1, -1):
            j = i - first
            k = kind[i]
            if k == NODE:
                node -= 1
                for a in range(SIZE):
                    value = stretch_x[j, a]
                    for b in range(SIZE):
                        value -= stretch_p[j, a, b] * lam[b]
                    node_x[node, a] = value
                for a in range(SIZE):
                    for b in range(SIZE):
                        half[a, b] = 0.0
                    for c in range(SIZE):
                        weight = stretch_p[j, a, c]
                        for b in range(SIZE):
                            half[a, b] += weight * big[c, b]
                for a in range(SIZE):
                    value = stretch_p[j, a, a]
                    for b in range(SIZE):
                        value -= half[a, b] * stretch_p[j, b, a]
                    node_variance[node, a] = max(value, 0.0)
                if stride > 0 and node % stride == 0:
                    node_p[node // stride] = stretch_p[j] - half @ stretch_p[j]
            elif k == RESET:
                for a in range(V, BI):
                    lam[a] = 0.0
                    for b in range(SIZE):
                        big[a, b] = 0.0
                        big[b, a] = 0.0
            elif k != REANCHOR and outcome[i] != REJECTED:
                _back_through_correction(
                    lam, big, indices[j], slopes[j], counts[j], directions[j], errors[j], totals[j], u
                )
            if moved[j]:
                _back_through_time(lam, big, deltas[j], w)
    state.node[0] = node
