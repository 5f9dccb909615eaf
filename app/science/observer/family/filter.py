"""Compiled driver of the filter family: forward through the events, leaving checkpoints for the smoother."""

import numpy as np

from app.science.arrays import FloatArray, IntArray
from app.science.jit import inline_kernel, kernel
from app.science.observer.family.correct import (
    correct_linear,
    correct_sigma,
    forget_motion,
    needs_sigma_points,
    predict_linear,
    predict_sigma,
    variance_of,
    widen,
)
from app.science.observer.family.high_gain import (
    adapted,
    add_high_gain_noise,
    correct_in_normal_form,
    high_gain_variance,
    innovation_over_window,
)
from app.science.observer.family.methods import (
    DISCRETE,
    EKF,
    HIGH_GAIN,
    RK4,
    SQUARE_ROOT,
    UNSCENTED,
    Adaptation,
    Checkpoints,
    Events,
    FamilyState,
    Gates,
    Results,
    SigmaSpread,
    Work,
)
from app.science.observer.family.predict import (
    predict_discrete,
    predict_ekf,
    predict_rk4,
    predict_square_root,
    predict_unscented,
    predict_unscented_root,
)
from app.science.observer.motion_filter import ACCEPTED, RECOVERED, REJECTED, innovation_of
from app.science.observer.motion_kernels import (
    ACC_I,
    ACC_J,
    ACC_K,
    ACC_X,
    ALTITUDE,
    CURVATURE_H,
    DISTANCE,
    EAST,
    HEADING,
    NODE,
    NORTH,
    PITCH,
    PSI,
    REANCHOR,
    RESET,
    ROAD_ALTITUDE,
    ROW,
    SJ,
    SK,
    SPEED,
    STANDSTILL,
    TH,
    THRUST,
    YAW_RATE,
    D,
    E,
    F,
    MotionModel,
    N,
    V,
    X,
    measure,
    noise_variance,
)

PLAIN_KINDS = (DISTANCE, SPEED, STANDSTILL, THRUST, HEADING, PITCH, CURVATURE_H, NORTH, EAST, ALTITUDE, ROAD_ALTITUDE)
PLAIN_STATES = (X, V, V, F, PSI, TH, SJ, N, E, D, D)


@inline_kernel
def predict(
    method: int, x: FloatArray, s: FloatArray, dt: float, gain: float, model: MotionModel, mass_a: float, boosted: int,
    spread: SigmaSpread, work: Work,
) -> bool:  # fmt: skip
    """Move state and covariance on by ``dt``; False when the covariance can't be carried any more."""
    if method == RK4:
        predict_rk4(x, s, dt, model, mass_a, boosted, work)
    elif method == DISCRETE:
        predict_discrete(x, s, dt, model, mass_a, boosted, work)
    elif method == SQUARE_ROOT:
        predict_square_root(x, s, dt, model, mass_a, boosted, work)
    elif method == UNSCENTED:
        return predict_unscented(x, s, dt, model, mass_a, boosted, spread, work)
    elif method in (EKF, HIGH_GAIN):
        predict_ekf(x, s, dt, model, mass_a, boosted, work)
        if method == HIGH_GAIN:
            add_high_gain_noise(x, s, dt, gain, model, mass_a, work)
    else:
        return predict_unscented_root(x, s, dt, model, mass_a, boosted, spread, work)
    return True


@inline_kernel
def measured_state(kind: int) -> int:
    """Return the state that a measurement of it alone speaks of; the speed's for those of several."""
    for k in range(len(PLAIN_KINDS)):
        if PLAIN_KINDS[k] == kind:
            return PLAIN_STATES[k]
    return V


@inline_kernel
def open_gate(
    method: int, s: FloatArray, kind: int, state: int, recovery_variance: FloatArray, model: MotionModel, work: Work
) -> None:
    """Widen what a measurement outside its gate speaks of, as `motion_filter.set_free` does for the fast filter."""
    if kind >= ACC_X:
        axis = model.acc_axes[kind - ACC_X]
        widen(method, s, F, axis[0] * axis[0] * 1e6, work)
        widen(method, s, SJ, axis[1] * axis[1] * recovery_variance[ACC_J], work)
        widen(method, s, SK, axis[2] * axis[2] * recovery_variance[ACC_K], work)
    elif kind in (ACC_J, YAW_RATE):
        widen(method, s, SJ, recovery_variance[kind], work)
    elif kind == ACC_K:
        widen(method, s, SK, recovery_variance[kind], work)
    elif kind != ACC_I:
        widen(method, s, state, recovery_variance[kind], work)
    if kind in (DISTANCE, SPEED, ACC_I):
        widen(method, s, F, 1e6, work)
    if kind == DISTANCE:
        widen(method, s, V, 1.0, work)


@inline_kernel
def foresee(
    method: int, kind: int, x: FloatArray, s: FloatArray, variance: float, model: MotionModel, mass_a: float,
    spread: SigmaSpread, index: IntArray, slope: FloatArray, along: FloatArray, direction: FloatArray,
    row: FloatArray, work: Work,
) -> tuple[float, float]:  # fmt: skip
    """Return a measurement's prediction and its variance; fills ``direction`` with P Hᵀ and ``row`` with H."""
    if needs_sigma_points(method, kind):
        predicted, total = predict_sigma(method, kind, x, s, model, mass_a, spread, index, slope, direction, row, work)
        return predicted, total + variance
    predicted, count = measure(kind, x, model, mass_a, index, slope)
    for i in range(len(x)):
        row[i] = 0.0
    for k in range(count):
        row[index[k]] += slope[k]
    return predicted, predict_linear(method, s, index, slope, count, along, direction) + variance


@inline_kernel
def take_in(
    method: int, kind: int, x: FloatArray, s: FloatArray, e: float, variance: float, total: float,
    along: FloatArray, direction: FloatArray, model: MotionModel, mass_a: float, work: Work,
) -> bool:  # fmt: skip
    """Correct state and covariance by one measurement; False when the covariance breaks."""
    if needs_sigma_points(method, kind):
        return correct_sigma(method, x, s, direction, e, total, work)
    if method == HIGH_GAIN and correct_in_normal_form(x, s, direction, e, total, model, mass_a, work):
        return True
    correct_linear(method, x, s, along, direction, e, variance, total, work.v2)
    return True


@kernel
def filter_family(
    method: int,
    events: Events,
    model: MotionModel,
    start_variance: FloatArray,
    gates: Gates,
    spread: SigmaSpread,
    adaptation: Adaptation,
    work: Work,
    kept: Checkpoints,
    results: Results,
    state: FamilyState,
    first: int,
    last: int,
) -> int:
    """Run one of the filters over scalar events sorted by time (Sebesta 2010, Algorithm 1 and App. A.3–A.4).

    Parameters
    ----------
    method : int
        One of `methods.FILTERS`.
    events, model, gates, spread, adaptation, work
        What is measured, the car, and how the filter treats both; distances in ``events.y`` are rewritten with the
        offset the filter gave them.
    start_variance : array, shape (n,)
    kept, results : Checkpoints, Results
        Filled.
    state : FamilyState
        Where an earlier call ended, overwritten.
    first, last : int
        Which events this call goes through; ``last`` is excluded.

    Returns
    -------
    int
        −1, or the index of the event at which the numbers stopped being finite or positive definite.
    """
    x, s, refused, window_x = state.x, state.s, state.refused, state.window_x
    now, offset, gain, window_began = state.now_s[0], state.offset_m[0], state.gain[0], state.window_began_s[0]
    reanchor, node, window_first = state.reanchor[0], state.node[0], state.window_first[0]
    n = len(x)
    index, slope = np.zeros(ROW, np.int64), np.zeros(ROW)
    along, direction, row = np.zeros(n), np.zeros(n), np.zeros(n)
    for i in range(first, last):
        t = events.t[i]
        if i % kept.every == 0:
            kept.x[i // kept.every] = x
            kept.s[i // kept.every] = s
        if method == HIGH_GAIN and t - window_began >= adaptation.window_s:
            strayed = innovation_over_window(
                events, results.outcome, window_first, i, window_began, window_x, model, index, slope, work
            )
            gain = adapted(gain, strayed, adaptation)
            window_x[:], window_first, window_began = x, i, now
        results.gain[i] = gain
        mass_a = model.accelerated_mass[events.gear[i]]
        if t > now:
            if not predict(method, x, s, t - now, gain, model, mass_a, events.boosted[i], spread, work):
                return i
            now = t
        k = events.kind[i]
        if k == NODE:
            for j in range(n):
                results.node_x[node, j] = x[j]
                results.node_variance[node, j] = variance_of(method, s, j)
            node += 1
            continue
        if k == RESET:
            forget_motion(method, x, s, start_variance, work)
            window_x[:], window_first, window_began, gain = x, i + 1, now, 1.0
            continue
        if k == REANCHOR:
            widen(method, s, X, events.r[i], work)
            reanchor = True
            continue
        variance = high_gain_variance(k, noise_variance(k, events.r[i], x, model), gain)
        predicted, total = foresee(
            method, k, x, s, variance, model, mass_a, spread, index, slope, along, direction, row, work
        )
        if k == DISTANCE:
            events.y[i] += offset
            if reanchor:
                offset += predicted - events.y[i]
                events.y[i] = predicted
                reanchor = False
                window_x[:], window_first, window_began = x, i, now
        e = innovation_of(k, events.y[i], predicted)
        if not (total > 0.0 and np.isfinite(e)):
            return i
        result = ACCEPTED
        if e * e > gates.squared[k] * total:
            refused[k] += 1
            result = REJECTED
            if refused[k] > gates.patience[k]:
                result = RECOVERED
                open_gate(method, s, k, measured_state(k), gates.recovery_variance, model, work)
                predicted, total = foresee(
                    method, k, x, s, variance, model, mass_a, spread, index, slope, along, direction, row, work
                )
                refused[k] = 0
        else:
            refused[k] = 0
        results.innovation[i], results.sd[i], results.outcome[i] = e, np.sqrt(total), result
        if result == REJECTED:
            continue
        if not take_in(method, k, x, s, e, variance, total, along, direction, model, mass_a, work):
            return i
    state.now_s[0], state.offset_m[0], state.gain[0], state.window_began_s[0] = now, offset, gain, window_began
    state.reanchor[0], state.node[0], state.window_first[0] = reanchor, node, window_first
    for j in range(n):
        if not np.isfinite(x[j]):
            return last - 1
    return -1
