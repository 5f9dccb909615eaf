"""Compiled fixed-interval smoother of the filter family: the modified Bryson–Frazier form with dense matrices.

A filter's step is what its transition matrix, its row of H and its gain say, be they derivatives or, for sigma
points, statistical linearisations. So one smoother serves them all. As in `motion_smoother`, stretches between
checkpoints are filtered again on the way back.
"""

from typing import NamedTuple

import numpy as np

from app.science.arrays import FloatArray, IntArray
from app.science.jit import inline_kernel, kernel
from app.science.observer.family.correct import forget_motion, holds_root, widen
from app.science.observer.family.dense import product
from app.science.observer.family.filter import foresee, measured_state, open_gate, predict, take_in
from app.science.observer.family.high_gain import high_gain_variance
from app.science.observer.family.methods import Checkpoints, Events, Gates, Results, SigmaSpread, Work
from app.science.observer.family.roots import multiply_out
from app.science.observer.motion_filter import RECOVERED, REJECTED, innovation_of
from app.science.observer.motion_kernels import BI, BK, NODE, REANCHOR, RESET, ROW, MotionModel, V, X, noise_variance


@inline_kernel
def back_through_correction(
    lam: FloatArray, big: FloatArray, row: FloatArray, direction: FloatArray, e: float, total: float, u: FloatArray
) -> None:
    """Carry the adjoint over one measurement: λ ← λ − h (Kᵀλ + e/S), Λ ← (I − h Kᵀ) Λ (I − K hᵀ) + h hᵀ / S."""
    n = len(lam)
    along = e
    for c in range(n):
        along += direction[c] * lam[c]
    along /= total
    curve = 1.0 / total
    for i in range(n):
        value = 0.0
        for c in range(n):
            value += big[i, c] * direction[c]
        u[i] = value / total
    for c in range(n):
        curve += direction[c] * u[c] / total
    for i in range(n):
        lam[i] -= row[i] * along
        for j in range(n):
            big[i, j] += curve * row[i] * row[j] - row[i] * u[j] - u[i] * row[j]


@inline_kernel
def back_through_time(lam: FloatArray, big: FloatArray, phi: FloatArray, m: FloatArray, old: FloatArray) -> None:
    """Carry the adjoint over one prediction: λ ← Φᵀ λ, Λ ← Φᵀ Λ Φ."""
    n = len(lam)
    for i in range(n):
        old[i] = lam[i]
    for i in range(n):
        value = 0.0
        for k in range(n):
            value += phi[k, i] * old[k]
        lam[i] = value
    product(phi.T, big, m)
    product(m, phi, big)


class Adjoint(NamedTuple):
    """What the smoother carries back between two calls: λ (n,), Λ (n, n), and the first node that is done."""

    lam: FloatArray
    big: FloatArray
    node: IntArray


def adjoint_start(n: int, nodes: int) -> Adjoint:
    """Return where the smoother stands at the last event."""
    return Adjoint(np.zeros(n), np.zeros((n, n)), np.array([nodes]))


@kernel
def smooth_family(
    method: int,
    events: Events,
    model: MotionModel,
    start_variance: FloatArray,
    gates: Gates,
    spread: SigmaSpread,
    work: Work,
    kept: Checkpoints,
    results: Results,
    adjoint: Adjoint,
    first_stretch: int,
    last_stretch: int,
) -> None:
    """Run the smoother back over what `filter_family` left; overwrites the nodes in ``results``.

    ``first_stretch`` and ``last_stretch`` (excluded) say which stretches between checkpoints this call goes through,
    from the last to the first; ``adjoint`` is where the call before ended.
    """
    every, n = kept.every, kept.x.shape[1]
    index, slope, along = np.zeros(ROW, np.int64), np.zeros(ROW), np.zeros(n)
    phis, moved = np.zeros((every, n, n)), np.zeros(every, np.bool_)
    rows, directions = np.zeros((every, n)), np.zeros((every, n))
    errors, totals = np.zeros(every), np.zeros(every)
    stretch_x, stretch_p = np.zeros((every, n)), np.zeros((every, n, n))
    scratch, u = np.zeros((n, n)), np.zeros(n)
    lam, big, node = adjoint.lam, adjoint.big, adjoint.node[0]
    for stretch in range(last_stretch - 1, first_stretch - 1, -1):
        first = stretch * every
        last = min(first + every, len(events.t))
        x, s = kept.x[stretch].copy(), kept.s[stretch].copy()
        now = events.t[first - 1] if first > 0 else events.t[0]
        for i in range(first, last):
            j, k, gain = i - first, events.kind[i], float(results.gain[i])
            mass_a = model.accelerated_mass[events.gear[i]]
            moved[j] = events.t[i] > now
            if moved[j]:
                predict(method, x, s, events.t[i] - now, gain, model, mass_a, events.boosted[i], spread, work)
                phis[j] = work.phi
                now = events.t[i]
            if k == NODE:
                stretch_x[j] = x
                if holds_root(method):
                    multiply_out(s, stretch_p[j])
                else:
                    stretch_p[j] = s
            elif k == RESET:
                forget_motion(method, x, s, start_variance, work)
            elif k == REANCHOR:
                widen(method, s, X, events.r[i], work)
            elif results.outcome[i] != REJECTED:
                if results.outcome[i] == RECOVERED:
                    open_gate(method, s, k, measured_state(k), gates.recovery_variance, model, work)
                variance = high_gain_variance(k, noise_variance(k, events.r[i], x, model), gain)
                predicted, totals[j] = foresee(
                    method, k, x, s, variance, model, mass_a, spread, index, slope, along, directions[j], rows[j], work
                )
                errors[j] = innovation_of(k, events.y[i], predicted)
                take_in(method, k, x, s, errors[j], variance, totals[j], along, directions[j], model, mass_a, work)
        for i in range(last - 1, first - 1, -1):
            j, k = i - first, events.kind[i]
            if k == NODE:
                node -= 1
                product(stretch_p[j], big, scratch)
                for a in range(n):
                    value, variance = stretch_x[j, a], stretch_p[j, a, a]
                    for b in range(n):
                        value -= stretch_p[j, a, b] * lam[b]
                        variance -= scratch[a, b] * stretch_p[j, b, a]
                    results.node_x[node, a] = value
                    results.node_variance[node, a] = max(variance, 0.0)
            elif k == RESET:
                for a in range(V, n):
                    if BI <= a <= BK:
                        continue
                    lam[a] = 0.0
                    for b in range(n):
                        big[a, b], big[b, a] = 0.0, 0.0
            elif k != REANCHOR and results.outcome[i] != REJECTED:
                back_through_correction(lam, big, rows[j], directions[j], errors[j], totals[j], u)
            if moved[j]:
                back_through_time(lam, big, phis[j], scratch, u)
    adjoint.node[0] = node
