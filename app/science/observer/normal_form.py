"""The motion block in observability normal form: z = Φ(x), its inverse and its Jacobian (Sebesta 2010, 1.2.3).

Every entry of z is an output, or what follows from an output by deriving it. The thesis' form is kept, with two
mends: the accelerometer's row keeps the part of gravity that PAPERS names, and M stands in front of S_k v². Blocks of
z, in this order: distance and its two derivatives; heading and its derivative; north; east; altitude and its two
derivatives; the three accelerometer readings.
"""

import numpy as np

from app.science.arrays import FloatArray
from app.science.jit import inline_kernel
from app.science.observer.motion_kernels import (
    BI,
    BJ,
    BK,
    PSI,
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

BLOCK_WIDTHS = (3, 2, 1, 1, 3, 1, 1, 1)
"""Width of each block of z; their sum is 13."""
SLOWEST_MPS = 2.0
"""Below this speed the normal form is not used: it is singular at standstill."""
STEEPEST = 0.7
"""Largest |sin θ| at which the inverse is used."""


@inline_kernel
def to_normal(x: FloatArray, model: MotionModel, mass_a: float, z: FloatArray) -> None:
    """Fill ``z`` (13,) from ``x`` (13,)."""
    v, sin_p, cos_p = x[V], np.sin(x[TH]), np.cos(x[TH])
    normal_force = model.mass * (model.gravity * cos_p + x[SK] * v * v)
    pull = x[F] - model.mass * model.gravity * sin_p - model.crr * normal_force
    acceleration = (pull - model.drag * v * v) / mass_a
    z[0], z[1], z[2] = x[X], v, pull
    z[3], z[4] = x[PSI], x[SJ] * v
    z[5], z[6] = x[N], x[E]
    z[7], z[8], z[9] = -x[D], v * sin_p, v * v * x[SK] * cos_p + acceleration * sin_p
    z[10] = acceleration + model.gravity * sin_p + x[BI]
    z[11] = x[SJ] * v * v + x[BJ]
    z[12] = -model.gravity * cos_p - x[SK] * v * v + x[BK]


@inline_kernel
def from_normal(z: FloatArray, model: MotionModel, mass_a: float, x: FloatArray) -> bool:
    """Fill ``x`` (13,) from ``z`` (13,); False where the form is singular, ``x`` is then left alone."""
    v = z[1]
    if not (v > 0.5 * SLOWEST_MPS and abs(z[8]) < STEEPEST * v):
        return False
    sin_p = z[8] / v
    cos_p = np.sqrt(1.0 - sin_p * sin_p)
    acceleration = (z[2] - model.drag * v * v) / mass_a
    curvature_v = (z[9] - acceleration * sin_p) / (v * v * cos_p)
    x[X], x[V] = z[0], v
    x[TH], x[SK] = np.arcsin(sin_p), curvature_v
    x[F] = z[2] + model.mass * model.gravity * sin_p
    x[F] += model.crr * model.mass * (model.gravity * cos_p + curvature_v * v * v)
    x[PSI], x[SJ] = z[3], z[4] / v
    x[N], x[E], x[D] = z[5], z[6], -z[7]
    x[BI] = z[10] - acceleration - model.gravity * sin_p
    x[BJ] = z[11] - z[4] * v
    x[BK] = z[12] + model.gravity * cos_p + curvature_v * v * v
    return True


@inline_kernel
def normal_jacobian(x: FloatArray, model: MotionModel, mass_a: float, j: FloatArray) -> None:
    """Fill ``j`` (13, 13) with ∂z/∂x."""
    v, curvature_v, sin_p, cos_p = x[V], x[SK], np.sin(x[TH]), np.cos(x[TH])
    weight, rolling = model.mass * model.gravity, model.crr * model.mass
    pull = x[F] - weight * sin_p - rolling * (model.gravity * cos_p + curvature_v * v * v)
    acceleration = (pull - model.drag * v * v) / mass_a
    pull_v, pull_k = -2.0 * rolling * curvature_v * v, -rolling * v * v
    pull_p = weight * (model.crr * sin_p - cos_p)
    a_v, a_p, a_k, a_f = (pull_v - 2.0 * model.drag * v) / mass_a, pull_p / mass_a, pull_k / mass_a, 1.0 / mass_a
    j[:, :] = 0.0
    j[0, X], j[1, V] = 1.0, 1.0
    j[2, F], j[2, V], j[2, TH], j[2, SK] = 1.0, pull_v, pull_p, pull_k
    j[3, PSI], j[4, V], j[4, SJ] = 1.0, x[SJ], v
    j[5, N], j[6, E], j[7, D] = 1.0, 1.0, -1.0
    j[8, V], j[8, TH] = sin_p, v * cos_p
    j[9, V] = 2.0 * v * curvature_v * cos_p + a_v * sin_p
    j[9, TH] = -v * v * curvature_v * sin_p + acceleration * cos_p + a_p * sin_p
    j[9, SK], j[9, F] = v * v * cos_p + a_k * sin_p, a_f * sin_p
    j[10, V], j[10, F], j[10, TH], j[10, SK], j[10, BI] = a_v, a_f, a_p + model.gravity * cos_p, a_k, 1.0
    j[11, V], j[11, SJ], j[11, BJ] = 2.0 * x[SJ] * v, v * v, 1.0
    j[12, V], j[12, TH], j[12, SK], j[12, BK] = -2.0 * curvature_v * v, model.gravity * sin_p, -v * v, 1.0


@inline_kernel
def high_gain(gain: float, weights: FloatArray) -> None:
    """Fill ``weights`` (13,) with the diagonal of Δ_G (Sebesta 2010, A.4.4)."""
    widest = max(BLOCK_WIDTHS)
    entry = 0
    for width in BLOCK_WIDTHS:
        for k in range(width):
            weights[entry] = gain ** (widest - width + k)
            entry += 1
