"""The motion block's Jacobians at many states at once, for sums along a trip (Sebesta 2010, 3.1–3.4)."""

from __future__ import annotations

import numpy as np

from app.science.arrays import FloatArray
from app.science.observer import motion_kernels as motion
from app.science.observer.motion_kernels import BI, BJ, BK, PSI, SIGN_WIDTH_MPS, SIZE, SJ, SK, TH, D, E, F, N, V, X
from app.science.vehicle.model import Vehicle

_PLAIN = (
    (motion.DISTANCE, X, 1.0),
    (motion.SPEED, V, 1.0),
    (motion.STANDSTILL, V, 1.0),
    (motion.THRUST, F, 1.0),
    (motion.HEADING, PSI, 1.0),
    (motion.PITCH, TH, 1.0),
    (motion.CURVATURE_H, SJ, 1.0),
    (motion.NORTH, N, 1.0),
    (motion.EAST, E, 1.0),
    (motion.ALTITUDE, D, -1.0),
    (motion.ROAD_ALTITUDE, D, -1.0),
)


def own_axes(vehicle: Vehicle) -> FloatArray:
    """Return where each of the accelerometer's own axes points, forward, right, down; shape (3, 3)."""
    return np.asarray(vehicle.mounting.matrix.T / vehicle.mounting.scale)


def dynamics(x: FloatArray, vehicle: Vehicle, mass_a: FloatArray) -> FloatArray:
    """Return ∂ẋ/∂x at each of ``x`` (n, 13), with accelerated masses ``mass_a`` (n,); shape (n, 13, 13)."""
    v, curvature_v, s, ds, resist = _resistance(x, vehicle)
    sin_p, cos_p, sin_h, cos_h = np.sin(x[:, TH]), np.cos(x[:, TH]), np.sin(x[:, PSI]), np.cos(x[:, PSI])
    weight, rolling = vehicle.mass_kg * vehicle.gravity_mps2, vehicle.crr * vehicle.mass_kg
    a = np.zeros((len(x), SIZE, SIZE))
    a[:, X, V] = 1.0
    a[:, V, V] = -(ds * resist + 2.0 * s * v * (vehicle.drag_area_kgpm + rolling * curvature_v)) / mass_a
    a[:, V, F] = 1.0 / mass_a
    a[:, V, TH] = weight * (s * vehicle.crr * sin_p - cos_p) / mass_a
    a[:, V, SK] = -s * rolling * v * v / mass_a
    a[:, PSI, V], a[:, PSI, SJ] = x[:, SJ], v
    a[:, TH, V], a[:, TH, SK] = curvature_v, v
    a[:, N, V], a[:, N, PSI], a[:, N, TH] = cos_h * cos_p, -v * sin_h * cos_p, -v * cos_h * sin_p
    a[:, E, V], a[:, E, PSI], a[:, E, TH] = sin_h * cos_p, v * cos_h * cos_p, -v * sin_h * sin_p
    a[:, D, V], a[:, D, TH] = -sin_p, -v * cos_p
    return a


def measurement_rows(x: FloatArray, vehicle: Vehicle, mass_a: FloatArray) -> FloatArray:
    """Return ∂y/∂x of every kind of measurement at each of ``x`` (n, 13); shape (n, kinds, 13)."""
    v, curvature_v, s, ds, resist = _resistance(x, vehicle)
    sin_p, cos_p = np.sin(x[:, TH]), np.cos(x[:, TH])
    rolling, gravity = vehicle.crr * vehicle.mass_kg, vehicle.gravity_mps2
    h = np.zeros((len(x), motion.KINDS, SIZE))
    for kind, state, slope in _PLAIN:
        h[:, kind, state] = slope
    forwards = h[:, motion.ACC_I]
    forwards[:, V] = -(ds * resist + 2.0 * s * v * (vehicle.drag_area_kgpm + rolling * curvature_v)) / mass_a
    forwards[:, F] = 1.0 / mass_a
    forwards[:, TH] = s * rolling * gravity * sin_p / mass_a + gravity * (1.0 - vehicle.mass_kg / mass_a) * cos_p
    forwards[:, SK] = -s * rolling * v * v / mass_a
    forwards[:, BI] = 1.0
    sideways = h[:, motion.ACC_J]
    sideways[:, V], sideways[:, SJ], sideways[:, BJ] = 2.0 * x[:, SJ] * v, v * v, 1.0
    downwards = h[:, motion.ACC_K]
    downwards[:, V], downwards[:, TH] = -2.0 * curvature_v * v, gravity * sin_p
    downwards[:, SK], downwards[:, BK] = -v * v, 1.0
    axes = own_axes(vehicle)
    h[:, motion.ACC_X : motion.ACC_Z + 1] = axes @ h[:, motion.ACC_I : motion.ACC_K + 1]
    turning = h[:, motion.YAW_RATE]
    turning[:, V], turning[:, SJ] = x[:, SJ], v
    return h


def _resistance(x: FloatArray, vehicle: Vehicle) -> tuple[FloatArray, FloatArray, FloatArray, FloatArray, FloatArray]:
    """Return speed, vertical curvature, smoothed sign(v), its slope, and the resistance."""
    v, curvature_v = x[:, V], x[:, SK]
    s = np.tanh(v / SIGN_WIDTH_MPS)
    rolling = vehicle.crr * vehicle.mass_kg * (vehicle.gravity_mps2 * np.cos(x[:, TH]) + curvature_v * v * v)
    return v, curvature_v, s, (1.0 - s * s) / SIGN_WIDTH_MPS, vehicle.drag_area_kgpm * v * v + rolling
