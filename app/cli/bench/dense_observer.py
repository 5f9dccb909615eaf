"""The observer as one would write it down first: filterpy's extended Kalman filter, 17 dense states, NumPy.

Each scalar measurement predicts with dense matrices (Φ = I + A dt + ½ A² dt²) and updates through filterpy; a dense
Rauch–Tung–Striebel pass smooths. It exists to be compared with, in speed and in its numbers.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from filterpy.kalman import ExtendedKalmanFilter

from app.science.arrays import FloatArray
from app.science.observer import motion_kernels as motion
from app.science.observer.events import MotionEvents
from app.science.observer.motion_kernels import MotionModel

SIZE = 17
Row = Callable[[FloatArray], FloatArray]


@dataclass(frozen=True, slots=True)
class DenseRun:
    """Smoothed states at the nodes, shape (nodes, 17), and how many scalar events were processed."""

    state: FloatArray
    events: int


def run_dense(
    events: MotionEvents, model: MotionModel, x0: FloatArray, variance0: FloatArray, *, filterpy: bool = True
) -> DenseRun:
    """Filter and smooth the events; states 13 to 16 stand for the engine's and only move along.

    Without ``filterpy`` the corrections are NumPy's, too.
    """
    correct = _filterpy_update if filterpy else _numpy_update
    ekf = ExtendedKalmanFilter(dim_x=SIZE, dim_z=1)
    ekf.x = np.concatenate([x0, np.zeros(4)]).reshape(SIZE, 1)
    ekf.P = np.diag(np.concatenate([variance0, np.ones(4)]))
    q = np.concatenate([model.q, np.full(4, 1e-2)])
    predicted_x, predicted_p, kept_x, kept_p, steps = [], [], [], [], []
    now = float(events.t_s[0])
    for t, kind, y, r, gear in zip(events.t_s, events.kind, events.y, events.r, events.gear, strict=True):
        mass_a = float(model.accelerated_mass[gear])
        dt, now = float(t) - now, float(t)
        a = _jacobian(ekf.x[:, 0], model, mass_a)
        phi = np.eye(SIZE) + a * dt + 0.5 * dt * dt * (a @ a)
        ekf.x = ekf.x + dt * _derivative(ekf.x[:, 0], model, mass_a).reshape(SIZE, 1)
        ekf.P = phi @ ekf.P @ phi.T + dt * np.diag(q)
        steps.append(phi)
        predicted_x.append(ekf.x.copy())
        predicted_p.append(ekf.P.copy())
        if kind > motion.REANCHOR:
            correct(ekf, int(kind), float(y), _variance(int(kind), float(r), ekf.x[:, 0], model), model, mass_a)
        kept_x.append(ekf.x.copy())
        kept_p.append(ekf.P.copy())
    x, p = kept_x[-1], kept_p[-1]
    smoothed = [x]
    for i in range(len(kept_x) - 2, -1, -1):
        gain = kept_p[i] @ steps[i + 1].T @ np.linalg.inv(predicted_p[i + 1])
        x = kept_x[i] + gain @ (x - predicted_x[i + 1])
        p = kept_p[i] + gain @ (p - predicted_p[i + 1]) @ gain.T
        smoothed.append(x)
    smoothed.reverse()
    nodes = np.flatnonzero(events.kind == motion.NODE)
    return DenseRun(np.array([smoothed[i][:, 0] for i in nodes]), len(events.t_s))


def _filterpy_update(
    ekf: ExtendedKalmanFilter, kind: int, y: float, r: float, model: MotionModel, mass_a: float
) -> None:
    ekf.update(
        np.array([[y]]),
        HJacobian=lambda x: _row(kind, x[:, 0], model, mass_a)[1],
        Hx=lambda x: np.array([[_row(kind, x[:, 0], model, mass_a)[0]]]),
        R=r,
    )


def _numpy_update(ekf: ExtendedKalmanFilter, kind: int, y: float, r: float, model: MotionModel, mass_a: float) -> None:
    predicted, row = _row(kind, ekf.x[:, 0], model, mass_a)
    gain = ekf.P @ row.T / (row @ ekf.P @ row.T + r)
    ekf.x = ekf.x + gain * (y - predicted)
    ekf.P = ekf.P - gain @ (row @ ekf.P)


def _resistance(x: FloatArray, model: MotionModel) -> tuple[float, float]:
    v, pitch, curvature = x[motion.V], x[motion.TH], x[motion.SK]
    rolling = model.crr * model.mass * (model.gravity * np.cos(pitch) + curvature * v * v)
    return float(np.tanh(v / motion.SIGN_WIDTH_MPS)), float(model.drag * v * v + rolling)


def _derivative(x: FloatArray, model: MotionModel, mass_a: float) -> FloatArray:
    v, heading, pitch = x[motion.V], x[motion.PSI], x[motion.TH]
    sign, resistance = _resistance(x, model)
    out = np.zeros(SIZE)
    out[motion.X] = v
    out[motion.V] = (x[motion.F] - sign * resistance - model.mass * model.gravity * np.sin(pitch)) / mass_a
    out[motion.PSI], out[motion.TH] = x[motion.SJ] * v, x[motion.SK] * v
    out[motion.N], out[motion.E] = v * np.cos(heading) * np.cos(pitch), v * np.sin(heading) * np.cos(pitch)
    out[motion.D] = -v * np.sin(pitch)
    out[13], out[15] = x[14], x[16]
    return out


def _jacobian(x: FloatArray, model: MotionModel, mass_a: float) -> FloatArray:
    v, heading, pitch = x[motion.V], x[motion.PSI], x[motion.TH]
    sign, resistance = _resistance(x, model)
    a = np.zeros((SIZE, SIZE))
    a[motion.X, motion.V] = a[13, 14] = a[15, 16] = 1.0
    steep = (1.0 - sign * sign) / motion.SIGN_WIDTH_MPS * resistance
    a[motion.V, motion.V] = -(steep + 2.0 * sign * v * (model.drag + model.crr * model.mass * x[motion.SK])) / mass_a
    a[motion.V, motion.F] = 1.0 / mass_a
    weight = model.mass * model.gravity
    a[motion.V, motion.TH] = weight * (sign * model.crr * np.sin(pitch) - np.cos(pitch)) / mass_a
    a[motion.V, motion.SK] = -sign * model.crr * model.mass * v * v / mass_a
    a[motion.PSI, motion.V], a[motion.PSI, motion.SJ] = x[motion.SJ], v
    a[motion.TH, motion.V], a[motion.TH, motion.SK] = x[motion.SK], v
    a[motion.N, motion.V], a[motion.E, motion.V] = np.cos(heading) * np.cos(pitch), np.sin(heading) * np.cos(pitch)
    a[motion.N, motion.PSI], a[motion.E, motion.PSI] = (
        -v * np.sin(heading) * np.cos(pitch),
        v * np.cos(heading) * np.cos(pitch),
    )
    a[motion.N, motion.TH], a[motion.E, motion.TH] = (
        -v * np.cos(heading) * np.sin(pitch),
        -v * np.sin(heading) * np.sin(pitch),
    )
    a[motion.D, motion.V], a[motion.D, motion.TH] = -np.sin(pitch), -v * np.cos(pitch)
    return a


def _row(kind: int, x: FloatArray, model: MotionModel, mass_a: float) -> tuple[float, FloatArray]:
    v, pitch = x[motion.V], x[motion.TH]
    h = np.zeros((1, SIZE))
    if kind == motion.ACC_I:
        a = _jacobian(x, model, mass_a)[motion.V]
        free = model.gravity * (1.0 - model.mass / mass_a)
        h[0] = a
        h[0, motion.TH] += model.mass / mass_a * model.gravity * np.cos(pitch) + free * np.cos(pitch)
        h[0, motion.BI] = 1.0
        sign, resistance = _resistance(x, model)
        return float((x[motion.F] - sign * resistance) / mass_a + free * np.sin(pitch) + x[motion.BI]), h
    if kind == motion.ACC_J:
        h[0, motion.V], h[0, motion.SJ], h[0, motion.BJ] = 2.0 * x[motion.SJ] * v, v * v, 1.0
        return float(x[motion.SJ] * v * v + x[motion.BJ]), h
    if kind == motion.ACC_K:
        h[0, motion.V], h[0, motion.TH] = -2.0 * x[motion.SK] * v, model.gravity * np.sin(pitch)
        h[0, motion.SK], h[0, motion.BK] = -v * v, 1.0
        return float(-model.gravity * np.cos(pitch) - x[motion.SK] * v * v + x[motion.BK]), h
    state = {
        motion.DISTANCE: motion.X,
        motion.SPEED: motion.V,
        motion.STANDSTILL: motion.V,
        motion.HEADING: motion.PSI,
        motion.NORTH: motion.N,
        motion.EAST: motion.E,
    }.get(kind, motion.D)
    h[0, state] = -1.0 if state == motion.D else 1.0
    return float(h[0, state] * x[state]), h


def _variance(kind: int, r: float, x: FloatArray, model: MotionModel) -> float:
    if motion.ACC_I <= kind <= motion.ACC_K:
        axis = kind - motion.ACC_I
        return r * float(model.acc_floor[axis] + model.acc_slope[axis] * abs(x[motion.V])) ** 2
    return r
