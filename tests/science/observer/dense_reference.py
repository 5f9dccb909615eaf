"""A slow, obvious version of the motion block: dense matrices, written from the equations.

Sebesta 2010, (1.16), (3.1)–(3.4), Algorithm 1, with the corrections the kernels' docstrings name.
"""

from __future__ import annotations

import numpy as np

from app.science.observer import motion_kernels as mk


def derivative(x: np.ndarray, model: mk.MotionModel, mass_a: float) -> np.ndarray:
    v, thrust, heading, pitch = x[mk.V], x[mk.F], x[mk.PSI], x[mk.TH]
    out = np.zeros(13, x.dtype)
    resist = model.drag * v**2 + model.crr * model.mass * (model.gravity * np.cos(pitch) + x[mk.SK] * v**2)
    sign = np.tanh(v / mk.SIGN_WIDTH_MPS)
    out[mk.X] = v
    out[mk.V] = (thrust - sign * resist - model.mass * model.gravity * np.sin(pitch)) / mass_a
    out[mk.PSI] = x[mk.SJ] * v
    out[mk.TH] = x[mk.SK] * v
    out[mk.N] = v * np.cos(heading) * np.cos(pitch)
    out[mk.E] = v * np.sin(heading) * np.cos(pitch)
    out[mk.D] = -v * np.sin(pitch)
    return out


def jacobian(x: np.ndarray, model: mk.MotionModel, mass_a: float) -> np.ndarray:
    """Jacobian by complex steps: exact to rounding and independent of the printed formulas."""
    columns = []
    for i in range(13):
        shifted = x.astype(complex)
        shifted[i] += 1e-30j
        columns.append(derivative(shifted, model, mass_a).imag / 1e-30)
    return np.array(columns).T


def predict(x, p, dt, model, mass_a, boosted):
    """One step: midpoint rule for the state, Φ = I + A dt + ½ A² dt² with A at the midpoint."""
    middle = x + 0.5 * dt * derivative(x, model, mass_a)
    a = jacobian(middle, model, mass_a)
    phi = np.eye(13) + a * dt + 0.5 * dt**2 * a @ a
    q = model.q.copy()
    if boosted:
        q[mk.F] *= model.unsteady_boost
    new = x + dt * derivative(middle, model, mass_a)
    q[mk.SK] *= max(new[mk.V], 1.0) ** model.curvature_v_exponent
    return new, phi @ p @ phi.T + dt * np.diag(q), phi


def measurement(kind: int, x: np.ndarray, model: mk.MotionModel, mass_a: float) -> complex | float:
    v, pitch = x[mk.V], x[mk.TH]
    rolling = model.crr * model.mass * (model.gravity * np.cos(pitch) + x[mk.SK] * v**2)
    if kind == mk.ACC_I:
        own = (x[mk.F] - np.tanh(v / mk.SIGN_WIDTH_MPS) * (model.drag * v**2 + rolling)) / mass_a
        return own + model.gravity * np.sin(pitch) * (1 - model.mass / mass_a) + x[mk.BI]
    if kind == mk.ACC_J:
        return x[mk.SJ] * v**2 + x[mk.BJ]
    if kind == mk.ACC_K:
        return -model.gravity * np.cos(pitch) - x[mk.SK] * v**2 + x[mk.BK]
    if kind >= mk.ACC_X:
        body = [measurement(own, x, model, mass_a) for own in (mk.ACC_I, mk.ACC_J, mk.ACC_K)]
        return sum(model.acc_axes[kind - mk.ACC_X][axis] * body[axis] for axis in range(3))
    if kind == mk.YAW_RATE:
        return x[mk.SJ] * v
    plain = {
        mk.DISTANCE: mk.X, mk.SPEED: mk.V, mk.STANDSTILL: mk.V, mk.THRUST: mk.F, mk.HEADING: mk.PSI,
        mk.PITCH: mk.TH, mk.CURVATURE_H: mk.SJ, mk.NORTH: mk.N, mk.EAST: mk.E,
    }  # fmt: skip
    return x[plain[kind]] if kind in plain else -x[mk.D]


def row(kind: int, x: np.ndarray, model: mk.MotionModel, mass_a: float) -> np.ndarray:
    out = np.zeros(13)
    for i in range(13):
        shifted = x.astype(complex)
        shifted[i] += 1e-30j
        out[i] = complex(measurement(kind, shifted, model, mass_a)).imag / 1e-30
    return out


def variance_of(kind: int, r: float, x: np.ndarray, model: mk.MotionModel) -> float:
    """An accelerometer's noise grows with speed; along its own axes it is the sum of independent body noises."""
    body = (model.acc_floor + model.acc_slope * abs(x[mk.V])) ** 2
    if mk.ACC_I <= kind <= mk.ACC_K:
        return r * body[kind - mk.ACC_I]
    return r * model.acc_axes[kind - mk.ACC_X] ** 2 @ body if kind >= mk.ACC_X else r


def run(events, model, x, p):
    """Filter, then smooth by Rauch–Tung–Striebel; no gates, no re-anchoring. Returns node states and variances."""
    now = events.t_s[0]
    history = []
    for i, t in enumerate(events.t_s):
        mass_a = model.accelerated_mass[events.gear[i]]
        phi = np.eye(13)
        if t > now:
            x, p, phi = predict(x, p, t - now, model, mass_a, events.boosted[i])
            now = t
        predicted_x, predicted_p = x.copy(), p.copy()
        kind = events.kind[i]
        if kind != mk.NODE:
            h = row(kind, x, model, mass_a)
            variance = variance_of(kind, events.r[i], x, model)
            s = h @ p @ h + variance
            gain = p @ h / s
            x = x + gain * (events.y[i] - float(np.real(measurement(kind, x, model, mass_a))))
            p = p - np.outer(gain, h @ p)
        history.append((predicted_x, predicted_p, phi, x.copy(), p.copy()))
    smooth_x, smooth_p = x.copy(), p.copy()
    smoothed = [(smooth_x, smooth_p)]
    for i in range(len(history) - 2, -1, -1):
        next_x, next_p, phi, _, _ = history[i + 1]
        _, _, _, own_x, own_p = history[i]
        gain = np.linalg.solve(next_p.T, (own_p @ phi.T).T).T
        smooth_x = own_x + gain @ (smooth_x - next_x)
        smooth_p = own_p + gain @ (smooth_p - next_p) @ gain.T
        smoothed.append((smooth_x, smooth_p))
    smoothed.reverse()
    nodes = np.flatnonzero(events.kind == mk.NODE)
    filtered = [history[i][3:] for i in nodes]
    return filtered, [smoothed[i] for i in nodes]
