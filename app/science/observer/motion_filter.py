"""Compiled filter over the motion block: forward through the events, leaving checkpoints for the smoother."""

import numpy as np

from app.science.arrays import AnyArray, FloatArray, IntArray
from app.science.jit import inline_kernel, kernel
from app.science.observer.motion_kernels import (
    ACC_I,
    ACC_J,
    ACC_K,
    DISTANCE,
    HEADING,
    NODE,
    REANCHOR,
    RESET,
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


@inline_kernel
def innovation_of(kind: int, y: float, predicted: float) -> float:
    """Return measured minus predicted; a heading's is wrapped into (−π, π]."""
    e = y - predicted
    if kind == HEADING:
        e -= 2.0 * np.pi * np.round(e / (2.0 * np.pi))
    return e


@inline_kernel
def set_free(p: FloatArray, kind: int, state: int, recovery_variance: FloatArray) -> None:
    """Widen what a measurement outside its gate speaks of, so that it can be believed.

    Wheels and the forward accelerometer free the thrust, which is what can change that fast.
    """
    if kind in (ACC_J, YAW_RATE):
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
    x: FloatArray,
    p: FloatArray,
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
) -> int:
    """Run the continuous-discrete EKF over scalar events sorted by time (Sebesta 2010, Algorithm 1).

    Parameters
    ----------
    t, kind, y, r, gear, boosted : array, shape (n,)
        Time, kind, measured value, noise variance (a factor on the speed-dependent one for accelerometers), gear, and
        whether a gear change is near. ``y`` of distances is rewritten with the offset the filter gave them.
    x, p : array, shapes (13,) and (13, 13)
        Start state and covariance, overwritten.
    gate, patience, recovery_variance : array, shape (KINDS,)
        Squared gate in innovation variances, rejections in a row after which the measurement is believed again, and
        the variance then added to its state.
    every : int
        Events between checkpoints.
    checkpoint_x, checkpoint_p : array, shapes (n // every + 1, 13) and (…, 13, 13)
    innovation, innovation_sd, outcome : array, shape (n,)
    node_x, node_variance : array, shape (nodes, 13)

    Returns
    -------
    int
        −1, or the index of the event at which the numbers stopped being finite.
    """
    start_variance = np.diag(p).copy()
    delta = np.zeros((7, 6))
    scratch = np.zeros((7, SIZE))
    index = np.zeros(5, np.int64)
    slope = np.zeros(5)
    direction = np.zeros(SIZE)
    refused = np.zeros(gate.shape[0], np.int64)
    offset = 0.0
    reanchor = False
    node = 0
    now = t[0] if len(t) else 0.0
    for i in range(len(t)):
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
                set_free(p, k, index[0], recovery_variance)
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
            return len(t) - 1
    return -1
