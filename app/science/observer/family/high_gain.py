"""The adaptive high-gain filter's own steps, on the observability normal form (Sebesta 2010, A.4)."""

import numpy as np

from app.science.arrays import AnyArray, FloatArray, IntArray
from app.science.jit import inline_kernel
from app.science.observer.family.dense import congruence, midpoint_step
from app.science.observer.family.methods import Adaptation, Events, Work
from app.science.observer.motion_filter import REJECTED, innovation_of
from app.science.observer.motion_kernels import (
    ACC_I,
    ACC_J,
    ACC_K,
    ALTITUDE,
    DISTANCE,
    EAST,
    HEADING,
    NORTH,
    ROAD_ALTITUDE,
    MotionModel,
    V,
    measure,
    noise_variance,
)
from app.science.observer.normal_form import SLOWEST_MPS, from_normal, high_gain, normal_jacobian, to_normal

OUTPUTS = (DISTANCE, HEADING, NORTH, EAST, ALTITUDE, ROAD_ALTITUDE, ACC_I, ACC_J, ACC_K)
"""Measurements that are the first entry of a block of the normal form."""
OUTPUT_POWERS = (0, 1, 2, 2, 0, 0, 2, 2, 2)
"""Power of G in δ_G for each of them: the widest block has 0, a block of one entry 2."""


@inline_kernel
def output_power(kind: int) -> int:
    """Return the power of G in δ_G of a measurement; those that are no output count with the widest blocks."""
    for k in range(len(OUTPUTS)):
        if OUTPUTS[k] == kind:
            return OUTPUT_POWERS[k]
    return 0


@inline_kernel
def high_gain_variance(kind: int, variance: float, gain: float) -> float:
    """Return the measurement's variance under high gain, R_G = G⁻¹ δ_G R δ_G (A.37)."""
    return float(variance * gain ** (2 * output_power(kind) - 1))


@inline_kernel
def add_high_gain_noise(
    x: FloatArray, p: FloatArray, dt: float, gain: float, model: MotionModel, mass_a: float, work: Work
) -> None:
    """Add what Q_G = G Δ_G Q Δ_G (A.36) has beyond Q, with Q carried into the normal form and back."""
    if gain <= 1.0 or x[V] < SLOWEST_MPS:
        return
    n = len(x)
    normal_jacobian(x, model, mass_a, work.m1)
    high_gain(gain, work.v1)
    for i in range(n):
        for j in range(n):
            total = 0.0
            for k in range(n):
                total += work.m1[i, k] * work.q[k] * work.m1[j, k]
            work.m2[i, j] = dt * total * gain * work.v1[i] * work.v1[j]
    back: FloatArray = np.linalg.inv(work.m1).astype(np.float64)
    congruence(back, work.m2, work.m3)
    for i in range(n):
        for j in range(n):
            p[i, j] += work.m2[i, j]
        p[i, i] -= dt * work.q[i]


@inline_kernel
def correct_in_normal_form(
    x: FloatArray, p: FloatArray, direction: FloatArray, e: float, total: float, model: MotionModel, mass_a: float,
    work: Work,
) -> bool:  # fmt: skip
    """Take a measurement in along straight lines of z instead of x; False where the normal form is singular.

    The covariance is carried to z where the prediction stands and back from where the correction has led.
    """
    n = len(x)
    if x[V] < SLOWEST_MPS:
        return False
    normal_jacobian(x, model, mass_a, work.m1)
    to_normal(x, model, mass_a, work.v1)
    weight = e / total
    for i in range(n):
        moved = 0.0
        for k in range(n):
            moved += work.m1[i, k] * direction[k]
        work.v1[i] += moved * weight
        work.v2[i] = x[i]
    if not from_normal(work.v1, model, mass_a, work.v2) or work.v2[V] < SLOWEST_MPS:
        return False
    for i in range(n):
        scaled = direction[i] / total
        for j in range(n):
            p[i, j] -= scaled * direction[j]
    congruence(work.m1, p, work.m2)
    for i in range(n):
        x[i] = work.v2[i]
    normal_jacobian(x, model, mass_a, work.m1)
    back: FloatArray = np.linalg.inv(work.m1).astype(np.float64)
    congruence(back, p, work.m2)
    return True


@inline_kernel
def innovation_over_window(
    events: Events, outcome: AnyArray, first: int, last: int, began: float, x: FloatArray, model: MotionModel,
    index: IntArray, slope: FloatArray, work: Work,
) -> float:  # fmt: skip
    """Return the innovation (A.38): the outputs' mean squared distance from a replay without corrections.

    Parameters
    ----------
    events : Events
    outcome : array, shape (events,)
    first, last : int
        Events of the window, the last one left out.
    began : float
        Time at which ``x`` stood, s.
    x : array, shape (13,)
        State at the beginning of the window; overwritten.

    Returns
    -------
    float
        Mean over the window of (y − ỹ)² / R, weighted with the time since the measurement before; 0 without any.
    """
    total, weights, now, seen = 0.0, 0.0, began, began
    for i in range(first, last):
        mass_a = model.accelerated_mass[events.gear[i]]
        if events.t[i] > now:
            midpoint_step(x, events.t[i] - now, model, mass_a, work.rate, work.middle)
            now = events.t[i]
        k = events.kind[i]
        if k not in OUTPUTS or outcome[i] == REJECTED:
            continue
        predicted, _ = measure(k, x, model, mass_a, index, slope)
        e = innovation_of(k, events.y[i], predicted)
        total += (now - seen) * e * e / noise_variance(k, events.r[i], x, model)
        weights += now - seen
        seen = now
    return total / weights if weights > 0.0 else 0.0


@inline_kernel
def adapted(gain: float, innovation: float, adaptation: Adaptation) -> float:
    """Return the gain of the next second: one step up, one step down, or the same (A.4.4.2)."""
    if innovation > adaptation.upper and gain < adaptation.gain_max:
        return gain + 1.0
    if innovation < adaptation.lower and gain > 1.0:
        return gain - 1.0
    return gain
