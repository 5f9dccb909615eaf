"""Compiled steps of the 13-state motion block: predict, measure, correct.

The 17 states fall into three blocks that never couple (PAPERS: P is block diagonal 13 + 2 + 2, exactly): motion here,
{fuel energy, fuel power} and {engine angle, engine speed} in `pair_kernels`. Of the transition matrix about thirty
entries off the diagonal differ from zero, all in seven rows and six columns; `ROWS` and `COLS` name them.
"""

from typing import NamedTuple

import numpy as np

from app.science.arrays import FloatArray, IntArray
from app.science.jit import inline_kernel

SIZE = 13
X, V, F, PSI, TH, N, E, D, SJ, SK, BI, BJ, BK = range(SIZE)
ROWS = (X, V, PSI, TH, N, E, D)
COLS = (V, F, PSI, TH, SJ, SK)

NODE, RESET, REANCHOR = 0, 1, 2
DISTANCE, SPEED, ACC_I, ACC_J, ACC_K, HEADING, PITCH, CURVATURE_H, YAW_RATE = 3, 4, 5, 6, 7, 8, 9, 10, 11
NORTH, EAST, ALTITUDE, ROAD_ALTITUDE, THRUST, STANDSTILL = 12, 13, 14, 15, 16, 17
ACC_X, ACC_Y, ACC_Z = 18, 19, 20
KINDS = 21
ROW = 8
"""Most entries that a measurement's row has."""

SIGN_WIDTH_MPS = 0.1


class MotionModel(NamedTuple):
    """Numbers of the car and the tuning that the kernels need, SI units.

    ``accelerated_mass`` is indexed by gear, ``q`` by state of the block; ``acc_floor`` and ``acc_slope`` by axis of the
    body. ``acc_axes`` (3, 3) has a row for each of the sensor's own axes: where it points, forward, right, down.
    """

    drag: float
    crr: float
    mass: float
    gravity: float
    accelerated_mass: FloatArray
    q: FloatArray
    curvature_v_exponent: float
    unsteady_boost: float
    acc_floor: FloatArray
    acc_slope: FloatArray
    acc_axes: FloatArray


@inline_kernel
def advance(x: FloatArray, dt: float, model: MotionModel, mass_a: float, delta: FloatArray) -> None:
    """Move ``x`` on by ``dt`` (midpoint rule) and fill ``delta`` (7, 6) with Φ − I of ``ROWS`` by ``COLS``.

    Sebesta 2010, (1.16) and (3.4), with sign(v) smoothed to tanh; Φ = I + A dt + ½ A² dt² at the midpoint.
    """
    weight = model.mass * model.gravity
    v0 = x[V]
    s = np.tanh(v0 / SIGN_WIDTH_MPS)
    resist = model.drag * v0 * v0 + model.crr * (weight * np.cos(x[TH]) + model.mass * x[SK] * v0 * v0)
    a0 = (x[F] - s * resist - weight * np.sin(x[TH])) / mass_a
    v = v0 + 0.5 * dt * a0
    pitch = x[TH] + 0.5 * dt * x[SK] * v0
    sin_p, cos_p = np.sin(pitch), np.cos(pitch)
    s = np.tanh(v / SIGN_WIDTH_MPS)
    rolling_v = model.crr * model.mass * x[SK]
    resist = model.drag * v * v + model.crr * weight * cos_p + rolling_v * v * v
    a = (x[F] - s * resist - weight * sin_p) / mass_a
    a_v = -((1.0 - s * s) / SIGN_WIDTH_MPS * resist + 2.0 * s * v * (model.drag + rolling_v)) / mass_a
    a_f = 1.0 / mass_a
    a_p = weight * (s * model.crr * sin_p - cos_p) / mass_a
    a_k = -s * model.crr * model.mass * v * v / mass_a
    heading = x[PSI] + 0.5 * dt * x[SJ] * v0
    sin_h, cos_h = np.sin(heading), np.cos(heading)
    sj, sk = x[SJ], x[SK]
    h = 0.5 * dt * dt

    delta[0, 0], delta[0, 1], delta[0, 3], delta[0, 5] = dt + h * a_v, h * a_f, h * a_p, h * a_k
    delta[1, 0] = dt * a_v + h * (a_v * a_v + a_p * sk)
    delta[1, 1] = dt * a_f + h * a_v * a_f
    delta[1, 3] = dt * a_p + h * a_v * a_p
    delta[1, 5] = dt * a_k + h * (a_v * a_k + a_p * v)
    delta[2, 0], delta[2, 1] = dt * sj + h * sj * a_v, h * sj * a_f
    delta[2, 3], delta[2, 4], delta[2, 5] = h * sj * a_p, dt * v, h * sj * a_k
    delta[3, 0], delta[3, 1] = dt * sk + h * sk * a_v, h * sk * a_f
    delta[3, 3], delta[3, 5] = h * sk * a_p, dt * v + h * sk * a_k
    n_v, n_h, n_p = cos_h * cos_p, -v * sin_h * cos_p, -v * cos_h * sin_p
    delta[4, 0], delta[4, 1] = dt * n_v + h * (n_v * a_v + n_h * sj + n_p * sk), h * n_v * a_f
    delta[4, 2], delta[4, 3] = dt * n_h, dt * n_p + h * n_v * a_p
    delta[4, 4], delta[4, 5] = h * n_h * v, h * (n_v * a_k + n_p * v)
    e_v, e_h, e_p = sin_h * cos_p, v * cos_h * cos_p, -v * sin_h * sin_p
    delta[5, 0], delta[5, 1] = dt * e_v + h * (e_v * a_v + e_h * sj + e_p * sk), h * e_v * a_f
    delta[5, 2], delta[5, 3] = dt * e_h, dt * e_p + h * e_v * a_p
    delta[5, 4], delta[5, 5] = h * e_h * v, h * (e_v * a_k + e_p * v)
    delta[6, 0], delta[6, 1] = -dt * sin_p - h * (sin_p * a_v + v * cos_p * sk), -h * sin_p * a_f
    delta[6, 3], delta[6, 5] = -dt * v * cos_p - h * sin_p * a_p, -h * (sin_p * a_k + v * cos_p * v)

    step = dt * v
    x[X] += step
    x[V] = v0 + dt * a
    x[PSI] += step * sj
    x[TH] += step * sk
    x[N] += step * n_v
    x[E] += step * e_v
    x[D] -= step * sin_p


@inline_kernel
def spread(p: FloatArray, delta: FloatArray, m: FloatArray) -> None:
    """Replace the covariance ``p`` (13, 13) by Φ p Φᵀ; ``m`` (7, 13) is scratch."""
    for r in range(7):
        row = ROWS[r]
        for c in range(SIZE):
            m[r, c] = p[row, c]
        for k in range(6):
            d = delta[r, k]
            if d != 0.0:
                col = COLS[k]
                for c in range(SIZE):
                    m[r, c] += d * p[col, c]
    for r in range(7):
        row = ROWS[r]
        for c in (F, SJ, SK, BI, BJ, BK):
            p[row, c] = m[r, c]
            p[c, row] = m[r, c]
        for q in range(r, 7):
            value = m[r, ROWS[q]]
            for k in range(6):
                value += delta[q, k] * m[r, COLS[k]]
            p[row, ROWS[q]] = value
            p[ROWS[q], row] = value


@inline_kernel
def add_process_noise(x: FloatArray, p: FloatArray, dt: float, model: MotionModel, boosted: int) -> None:
    """Add Q_c dt to the diagonal of ``p``."""
    for i in range(SIZE):
        p[i, i] += dt * model.q[i]
    if boosted != 0:
        p[F, F] += dt * model.q[F] * (model.unsteady_boost - 1.0)
    speed = max(x[V], 1.0)
    p[SK, SK] += dt * model.q[SK] * (speed**model.curvature_v_exponent - 1.0)


@inline_kernel
def _along_own_axis(
    axis: FloatArray, x: FloatArray, model: MotionModel, mass_a: float, index: IntArray, slope: FloatArray
) -> float:
    """Return what an accelerometer's axis reads that points anywhere, (3,) forward, right, down; fills its row.

    It is the projection of what `measure` predicts for the three body axes.
    """
    v, sin_p, cos_p = x[V], np.sin(x[TH]), np.cos(x[TH])
    s = np.tanh(v / SIGN_WIDTH_MPS)
    rolling = model.crr * model.mass
    resist = model.drag * v * v + rolling * (model.gravity * cos_p + x[SK] * v * v)
    free = model.gravity * (1.0 - model.mass / mass_a)
    resist_v = (1.0 - s * s) / SIGN_WIDTH_MPS * resist + 2.0 * s * v * (model.drag + rolling * x[SK])
    index[0], index[1], index[2], index[3], index[4], index[5], index[6], index[7] = V, F, TH, SJ, SK, BI, BJ, BK
    slope[0] = -axis[0] * resist_v / mass_a + 2.0 * v * (axis[1] * x[SJ] - axis[2] * x[SK])
    slope[1] = axis[0] / mass_a
    slope[2] = axis[0] * (s * rolling * model.gravity * sin_p / mass_a + free * cos_p) + axis[2] * model.gravity * sin_p
    slope[3] = axis[1] * v * v
    slope[4] = -(axis[0] * s * rolling / mass_a + axis[2]) * v * v
    slope[5], slope[6], slope[7] = axis[0], axis[1], axis[2]
    forward = (x[F] - s * resist) / mass_a + free * sin_p + x[BI]
    sideways = x[SJ] * v * v + x[BJ]
    down = -model.gravity * cos_p - x[SK] * v * v + x[BK]
    return float(axis[0] * forward + axis[1] * sideways + axis[2] * down)


@inline_kernel
def measure(
    kind: int, x: FloatArray, model: MotionModel, mass_a: float, index: IntArray, slope: FloatArray
) -> tuple[float, int]:
    """Return the predicted measurement and how many entries of its Jacobian row differ from zero.

    ``index`` and ``slope``, (`ROW`,), receive these entries. Rows as Sebesta 2010, (3.1) and 3.1.2.3, with
    a_i = (F − drag)/M_a + g sinθ (1 − M/M_a) + b_i: the paper drops the middle term.
    """
    count = 1
    slope[0] = 1.0
    if kind == ACC_I:
        v = x[V]
        s = np.tanh(v / SIGN_WIDTH_MPS)
        rolling = model.crr * model.mass
        resist = model.drag * v * v + rolling * (model.gravity * np.cos(x[TH]) + x[SK] * v * v)
        free = model.gravity * (1.0 - model.mass / mass_a)
        predicted = (x[F] - s * resist) / mass_a + free * np.sin(x[TH]) + x[BI]
        index[0], index[1], index[2], index[3], index[4] = V, F, TH, SK, BI
        slope[0] = -((1.0 - s * s) / SIGN_WIDTH_MPS * resist + 2.0 * s * v * (model.drag + rolling * x[SK])) / mass_a
        slope[1] = 1.0 / mass_a
        slope[2] = s * rolling * model.gravity * np.sin(x[TH]) / mass_a + free * np.cos(x[TH])
        slope[3] = -s * rolling * v * v / mass_a
        slope[4] = 1.0
        return predicted, 5
    if kind == ACC_J:
        index[0], index[1], index[2] = V, SJ, BJ
        slope[0], slope[1], slope[2] = 2.0 * x[SJ] * x[V], x[V] * x[V], 1.0
        return x[SJ] * x[V] * x[V] + x[BJ], 3
    if kind == ACC_K:
        index[0], index[1], index[2], index[3] = V, TH, SK, BK
        slope[0], slope[1] = -2.0 * x[SK] * x[V], model.gravity * np.sin(x[TH])
        slope[2], slope[3] = -x[V] * x[V], 1.0
        return -model.gravity * np.cos(x[TH]) - x[SK] * x[V] * x[V] + x[BK], 4
    if kind >= ACC_X:
        return _along_own_axis(model.acc_axes[kind - ACC_X], x, model, mass_a, index, slope), ROW
    if kind == YAW_RATE:
        index[0], index[1] = V, SJ
        slope[0], slope[1] = x[SJ], x[V]
        return x[SJ] * x[V], 2
    if kind == DISTANCE:
        index[0] = X
    elif kind in (SPEED, STANDSTILL):
        index[0] = V
    elif kind == THRUST:
        index[0] = F
    elif kind == HEADING:
        index[0] = PSI
    elif kind == PITCH:
        index[0] = TH
    elif kind == CURVATURE_H:
        index[0] = SJ
    elif kind == NORTH:
        index[0] = N
    elif kind == EAST:
        index[0] = E
    else:
        index[0] = D
        slope[0] = -1.0
        return -x[D], 1
    return float(x[index[0]]), count


@inline_kernel
def noise_variance(kind: int, r: float, x: FloatArray, model: MotionModel) -> float:
    """Return the variance of a measurement; an accelerometer's grows with speed."""
    if ACC_I <= kind <= ACC_K:
        sd = model.acc_floor[kind - ACC_I] + model.acc_slope[kind - ACC_I] * abs(x[V])
        return r * float(sd * sd)
    if kind >= ACC_X:
        total = 0.0
        for axis in range(3):
            sd = model.acc_floor[axis] + model.acc_slope[axis] * abs(x[V])
            total += (model.acc_axes[kind - ACC_X, axis] * sd) ** 2
        return r * float(total)
    return r


@inline_kernel
def gain_direction(
    p: FloatArray, index: IntArray, slope: FloatArray, count: int, direction: FloatArray, variance: float
) -> float:
    """Fill ``direction`` (13,) with P Hᵀ and return the innovation's variance H P Hᵀ + R."""
    for c in range(SIZE):
        direction[c] = slope[0] * p[index[0], c]
    for k in range(1, count):
        row, h = index[k], slope[k]
        for c in range(SIZE):
            direction[c] += h * p[row, c]
    total = variance
    for k in range(count):
        total += slope[k] * direction[index[k]]
    return total


@inline_kernel
def correct(x: FloatArray, p: FloatArray, direction: FloatArray, innovation: float, total: float) -> None:
    """Take the measurement in: x += K e and P −= (P Hᵀ)(P Hᵀ)ᵀ / S, K = P Hᵀ / S."""
    inverse = 1.0 / total
    weight = innovation * inverse
    for i in range(SIZE):
        x[i] += direction[i] * weight
    for i in range(SIZE):
        scaled = direction[i] * inverse
        for j in range(SIZE):
            p[i, j] -= scaled * direction[j]


@inline_kernel
def forget(x: FloatArray, p: FloatArray, start_variance: FloatArray) -> None:
    """Begin anew after a gap: everything but the accelerometer's biases and the distance becomes unknown again."""
    for i in range(V, BI):
        for j in range(SIZE):
            p[i, j] = 0.0
            p[j, i] = 0.0
        p[i, i] = start_variance[i]
    x[V] = 0.0
    x[F] = 0.0
    x[SJ] = 0.0
    x[SK] = 0.0
