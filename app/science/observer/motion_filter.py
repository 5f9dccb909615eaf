"""Compiled filter over the motion block: forward through the events, leaving checkpoints for the smoother."""

from typing import NamedTuple

import numpy as np

from app.science.arrays import AnyArray, BoolArray, FloatArray, IntArray
from app.science.jit import inline_kernel, kernel
from app.science.observer.motion_kernels import (
    ACC_I,
    ACC_J,
    ACC_K,
    ACC_X,
    DISTANCE,
    HEADING,
    KINDS,
    NODE,
    REANCHOR,
    RESET,
    ROW,
    SIZE,
    SJ,
    SK,
    SPEED,
    YAW_RATE,
    F,
    MotionModel,
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

REJECTED, ACCEPTED, RECOVERED = 0, 1, 2


class FilterState(NamedTuple):
    """Where the filter stands between two calls.

    ``x`` (13,) and ``p`` (13, 13) are state and covariance, ``refused`` (KINDS,) the refusals in a row of each kind.
    The others hold one number each: the time, what is added to distances, whether the next distance sets that anew,
    and how many nodes are done.
    """

    x: FloatArray
    p: FloatArray
    refused: IntArray
    now_s: FloatArray
    offset_m: FloatArray
    reanchor: BoolArray
    node: IntArray


def filter_start(x0: FloatArray, variance0: FloatArray, t0_s: float) -> FilterState:
    """Return where the filter stands before the first event."""
    return FilterState(
        x=x0.copy(),
        p=np.diag(variance0),
        refused=np.zeros(KINDS, np.int64),
        now_s=np.array([t0_s]),
        offset_m=np.zeros(1),
        reanchor=np.zeros(1, np.bool_),
        node=np.zeros(1, np.int64),
    )


@inline_kernel
def innovation_of(kind: int, y: float, predicted: float) -> float:
    """Return measured minus predicted; a heading's is wrapped into (−π, π]."""
    e = y - predicted
    if kind == HEADING:
        e -= 2.0 * np.pi * np.round(e / (2.0 * np.pi))
    return e


@inline_kernel
def set_free(p: FloatArray, kind: int, state: int, recovery_variance: FloatArray, model: MotionModel) -> None:
    """Widen what a measurement outside its gate speaks of, so that it can be believed.

    Wheels and the forward accelerometer free the thrust, which is what can change that fast. An accelerometer's own
    axis frees what each body axis would, in so far as it points there.
    """
    if kind >= ACC_X:
        axis = model.acc_axes[kind - ACC_X]
        p[F, F] += axis[0] * axis[0] * 1e6
        p[SJ, SJ] += axis[1] * axis[1] * recovery_variance[ACC_J]
        p[SK, SK] += axis[2] * axis[2] * recovery_variance[ACC_K]
    elif kind in (ACC_J, YAW_RATE):
        p[SJ, SJ] += recovery_variance[kind]
    elif kind == ACC_K:
        p[SK, SK] += recovery_variance[kind]
    elif kind != ACC_I:
        p[state, state] += recovery_variance[kind]
    if kind in (DISTANCE, SPEED, ACC_I):
        p[F, F] += 1e6
    if kind == DISTANCE:
        p[V, V] += 1.0


@kernel
def filter_motion(
    t: FloatArray,
    kind: AnyArray,
    y: FloatArray,
    r: FloatArray,
    gear: AnyArray,
    boosted: AnyArray,
    model: MotionModel,
    start_variance: FloatArray,
    gate: FloatArray,
    patience: IntArray,
    recovery_variance: FloatArray,
    every: int,
    checkpoint_x: FloatArray,
    checkpoint_p: FloatArray,
    innovation: AnyArray,
    innovation_sd: AnyArray,
    outcome: AnyArray,
    node_x: FloatArray,
    node_variance: FloatArray,
    node_p: FloatArray,
    stride: int,
    state: FilterState,
    first: int,
    last: int,
) -> int:
    """Run the continuous-discrete EKF over scalar events sorted by time (Sebesta 2010, Algorithm 1).

    Parameters
    ----------
    t, kind, y, r, gear, boosted : array, shape (n,)
        Time, kind, measured value, noise variance (a factor on the speed-dependent one for accelerometers), gear, and
        whether a gear change is near. ``y`` of distances is rewritten with the offset the filter gave them.
    start_variance : array, shape (13,)
    gate, patience, recovery_variance : array, shape (KINDS,)
        Squared gate in innovation variances, rejections in a row after which the measurement is believed again, and
        the variance then added to its state.
    every : int
        Events between checkpoints.
    checkpoint_x, checkpoint_p : array, shapes (n // every + 1, 13) and (…, 13, 13)
    innovation, innovation_sd, outcome : array, shape (n,)
    node_x, node_variance : array, shape (nodes, 13)
    node_p : array, shape (m, 13, 13)
    stride : int
        Every so many nodes the whole covariance is kept in ``node_p``; 0 for never.
    state : FilterState
        Where an earlier call ended, overwritten; `filter_start` for the first one.
    first, last : int
        Which events this call goes through; ``last`` is excluded.

    Returns
    -------
    int
        −1, or the index of the event at which the numbers stopped being finite.
    """
    x, p, refused = state.x, state.p, state.refused
    delta = np.zeros((7, 6))
    scratch = np.zeros((7, SIZE))
    index = np.zeros(ROW, np.int64)
    slope = np.zeros(ROW)
    direction = np.zeros(SIZE)
    offset = state.offset_m[0]
    reanchor = state.reanchor[0]
    node = state.node[0]
    now = state.now_s[0]
    for i in range(first, last):
        if i % every == 0:
            checkpoint_x[i // every] = x
            checkpoint_p[i // every] = p
        mass_a = model.accelerated_mass[gear[i]]
        dt = t[i] - now
        if dt > 0.0:
            advance(x, dt, model, mass_a, delta)
            spread(p, delta, scratch)
            add_process_noise(x, p, dt, model, boosted[i])
            now = t[i]
        k = kind[i]
        if k == NODE:
            for s in range(SIZE):
                node_x[node, s] = x[s]
                node_variance[node, s] = p[s, s]
            if stride > 0 and node % stride == 0:
                node_p[node // stride] = p
            node += 1
            continue
        if k == RESET:
            forget(x, p, start_variance)
            continue
        if k == REANCHOR:
            p[X, X] += r[i]
            reanchor = True
            continue
        predicted, count = measure(k, x, model, mass_a, index, slope)
        if k == DISTANCE:
            y[i] += offset
            if reanchor:
                offset += predicted - y[i]
                y[i] = predicted
                reanchor = False
        e = innovation_of(k, y[i], predicted)
        total = gain_direction(p, index, slope, count, direction, noise_variance(k, r[i], x, model))
        if not (total > 0.0 and np.isfinite(e)):
            return i
        result = ACCEPTED
        if e * e > gate[k] * total:
            refused[k] += 1
            result = REJECTED
            if refused[k] > patience[k]:
                result = RECOVERED
                set_free(p, k, index[0], recovery_variance, model)
                total = gain_direction(p, index, slope, count, direction, noise_variance(k, r[i], x, model))
                refused[k] = 0
        else:
            refused[k] = 0
        innovation[i] = e
        innovation_sd[i] = np.sqrt(total)
        outcome[i] = result
        if result != REJECTED:
            correct(x, p, direction, e, total)
    for s in range(SIZE):
        if not np.isfinite(x[s]):
            return last - 1
    state.now_s[0], state.offset_m[0], state.reanchor[0], state.node[0] = now, offset, reanchor, node
    return -1
