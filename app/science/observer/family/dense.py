"""The motion model with dense matrices, and with local polynomial models of the thrust (Sebesta 2010, Note 12).

The state has 13 entries as in `motion_kernels`, then the thrust's slope and curvature where the model has them.
"""

import numpy as np

from app.science.arrays import FloatArray
from app.science.jit import inline_kernel
from app.science.observer.motion_kernels import (
    PSI,
    SIGN_WIDTH_MPS,
    SIZE,
    SJ,
    SK,
    TH,
    D,
    E,
    F,
    MotionModel,
    N,
    V,
    X,
)


@inline_kernel
def derivative(x: FloatArray, model: MotionModel, mass_a: float, out: FloatArray) -> None:
    """Fill ``out`` (n,) with ẋ (Sebesta 2010, 1.16, with the M that (1.3) lacks and sign(v) smoothed)."""
    v, pitch = x[V], x[TH]
    s = np.tanh(v / SIGN_WIDTH_MPS)
    weight = model.mass * model.gravity
    resist = model.drag * v * v + model.crr * (weight * np.cos(pitch) + model.mass * x[SK] * v * v)
    for i in range(len(x)):
        out[i] = 0.0
    out[X] = v
    out[V] = (x[F] - s * resist - weight * np.sin(pitch)) / mass_a
    out[PSI] = x[SJ] * v
    out[TH] = x[SK] * v
    out[N] = v * np.cos(x[PSI]) * np.cos(pitch)
    out[E] = v * np.sin(x[PSI]) * np.cos(pitch)
    out[D] = -v * np.sin(pitch)
    below = F
    for i in range(SIZE, len(x)):
        out[below] = x[i]
        below = i


@inline_kernel
def jacobian(x: FloatArray, model: MotionModel, mass_a: float, a: FloatArray) -> None:
    """Fill ``a`` (n, n) with ∂ẋ/∂x (Sebesta 2010, 3.4)."""
    v, pitch, heading = x[V], x[TH], x[PSI]
    s = np.tanh(v / SIGN_WIDTH_MPS)
    weight = model.mass * model.gravity
    rolling_v = model.crr * model.mass * x[SK]
    sin_p, cos_p, sin_h, cos_h = np.sin(pitch), np.cos(pitch), np.sin(heading), np.cos(heading)
    resist = model.drag * v * v + model.crr * weight * cos_p + rolling_v * v * v
    a[:, :] = 0.0
    a[X, V] = 1.0
    a[V, V] = -((1.0 - s * s) / SIGN_WIDTH_MPS * resist + 2.0 * s * v * (model.drag + rolling_v)) / mass_a
    a[V, F] = 1.0 / mass_a
    a[V, TH] = weight * (s * model.crr * sin_p - cos_p) / mass_a
    a[V, SK] = -s * model.crr * model.mass * v * v / mass_a
    a[PSI, V], a[PSI, SJ] = x[SJ], v
    a[TH, V], a[TH, SK] = x[SK], v
    a[N, V], a[N, PSI], a[N, TH] = cos_h * cos_p, -v * sin_h * cos_p, -v * cos_h * sin_p
    a[E, V], a[E, PSI], a[E, TH] = sin_h * cos_p, v * cos_h * cos_p, -v * sin_h * sin_p
    a[D, V], a[D, TH] = -sin_p, -v * cos_p
    below = F
    for i in range(SIZE, len(x)):
        a[below, i] = 1.0
        below = i


@inline_kernel
def process_noise(x: FloatArray, model: MotionModel, boosted: int, q: FloatArray) -> None:
    """Fill ``q`` (n,) with the diagonal of Q_c at this speed."""
    for i in range(len(q)):
        q[i] = model.q[i]
    if boosted != 0:
        q[F] *= model.unsteady_boost
        for i in range(SIZE, len(q)):
            q[i] *= model.unsteady_boost
    q[SK] *= max(x[V], 1.0) ** model.curvature_v_exponent


@inline_kernel
def product(a: FloatArray, b: FloatArray, out: FloatArray) -> None:
    """Fill ``out`` with a b; zeros of ``a`` are skipped, for there are many."""
    for i in range(a.shape[0]):
        for c in range(b.shape[1]):
            out[i, c] = 0.0
        for k in range(a.shape[1]):
            weight = a[i, k]
            if weight != 0.0:
                for c in range(b.shape[1]):
                    out[i, c] += weight * b[k, c]


@inline_kernel
def congruence(a: FloatArray, p: FloatArray, scratch: FloatArray) -> None:
    """Replace the symmetric ``p`` by a p aᵀ."""
    n = p.shape[0]
    product(a, p, scratch)
    for i in range(n):
        for j in range(i + 1):
            total = 0.0
            for k in range(n):
                total += scratch[i, k] * a[j, k]
            p[i, j] = total
            p[j, i] = total


@inline_kernel
def series_transition(a: FloatArray, dt: float, phi: FloatArray) -> None:
    """Fill ``phi`` with I + a dt + ½ a² dt²."""
    n = a.shape[0]
    product(a, a, phi)
    for i in range(n):
        for j in range(n):
            phi[i, j] = dt * a[i, j] + 0.5 * dt * dt * phi[i, j]
        phi[i, i] += 1.0


@inline_kernel
def midpoint_step(
    x: FloatArray, dt: float, model: MotionModel, mass_a: float, rate: FloatArray, middle: FloatArray
) -> None:
    """Move ``x`` on by ``dt``; leaves the state halfway in ``middle`` and the rate there in ``rate``."""
    derivative(x, model, mass_a, rate)
    for i in range(len(x)):
        middle[i] = x[i] + 0.5 * dt * rate[i]
    derivative(middle, model, mass_a, rate)
    for i in range(len(x)):
        x[i] += dt * rate[i]
