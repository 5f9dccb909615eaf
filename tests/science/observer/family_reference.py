"""Slow, obvious versions of the filters of Sebesta 2010, App. A, on filterpy where it has the filter.

Each runs over scalar events without gates and returns, per node, filtered and smoothed means and covariances.
"""

from __future__ import annotations

import itertools
from typing import ClassVar

import numpy as np
from filterpy.kalman import KalmanFilter, MerweScaledSigmaPoints, SquareRootKalmanFilter, UnscentedKalmanFilter

from app.science.observer import motion_kernels as mk
from tests.science.observer import dense_reference as dense


def derivative(x, model, mass_a):
    """ẋ with the local polynomial models of the thrust behind the 13 states."""
    out = np.concatenate([dense.derivative(x[:13], model, mass_a), np.zeros(len(x) - 13, x.dtype)])
    chain = [mk.F, *range(13, len(x))]
    for below, above in itertools.pairwise(chain):
        out[below] = x[above]
    return out


def complex_step(function, x):
    """Return the Jacobian of a function by complex steps."""
    columns = []
    for i in range(len(x)):
        shifted = x.astype(complex)
        shifted[i] += 1e-30j
        columns.append(function(shifted).imag / 1e-30)
    return np.array(columns).T


def midpoint(x, dt, model, mass_a):
    return x + dt * derivative(x + 0.5 * dt * derivative(x, model, mass_a), model, mass_a)


def series(a, dt):
    return np.eye(len(a)) + dt * a + 0.5 * dt**2 * a @ a


def noise(x, model, boosted):
    q = model.q.copy()
    if boosted:
        q[[mk.F, *range(13, len(q))]] *= model.unsteady_boost
    q[mk.SK] *= max(x[mk.V], 1.0) ** model.curvature_v_exponent
    return np.diag(q)


def variance_of(event, x, model):
    return dense.variance_of(event["kind"], event["r"], x, model)


def row_of(kind, x, model, mass_a):
    return np.concatenate([dense.row(kind, x[:13], model, mass_a), np.zeros(len(x) - 13)])


class Extended:
    """Extended filters in the form that filterpy calls Kalman filter, one time step chosen by name."""

    def __init__(self, name, x, p, model):
        self.name, self.model = name, model
        self.filter = (SquareRootKalmanFilter if name == "sr-ekf" else KalmanFilter)(len(x), 1)
        self.filter.x, self.filter.P = x.reshape(-1, 1).copy(), p.copy()

    @property
    def x(self):
        return np.asarray(self.filter.x).ravel()

    @property
    def p(self):
        return np.asarray(self.filter.P)

    def predict(self, dt, mass_a, boosted):
        """Return the cross covariance of the state before and after."""
        x, before, f = self.x, self.p.copy(), lambda s: derivative(s, self.model, mass_a)
        if self.name == "rk4-ekf":
            moved, p, phi = self._runge_kutta(x, before, dt, f, noise(x, self.model, boosted))
            self.filter.x, self.filter.P = moved.reshape(-1, 1), p
            return before @ phi.T
        if self.name == "dd-ekf":
            a = complex_step(f, x)
            moved = x + (dt * np.eye(len(x)) + 0.5 * dt**2 * a) @ f(x)
        else:
            a = complex_step(f, x + 0.5 * dt * f(x))
            moved = midpoint(x, dt, self.model, mass_a)
        self.filter.F, self.filter.Q = series(a, dt), dt * noise(moved, self.model, boosted)
        self.filter.predict()
        self.filter.x = moved.reshape(-1, 1)
        return before @ series(a, dt).T

    @staticmethod
    def _runge_kutta(x, p, dt, f, q):
        def slope(state):
            sx, sp, sphi = state
            a = complex_step(f, sx)
            return f(sx), a @ sp + sp @ a.T + q, a @ sphi

        start = (x, p, np.eye(len(x)))
        k1 = slope(start)
        k2 = slope(tuple(s + 0.5 * dt * k for s, k in zip(start, k1, strict=True)))
        k3 = slope(tuple(s + 0.5 * dt * k for s, k in zip(start, k2, strict=True)))
        k4 = slope(tuple(s + dt * k for s, k in zip(start, k3, strict=True)))
        steps = zip(start, k1, k2, k3, k4, strict=True)
        return tuple(s + dt / 6 * (a + 2 * b + 2 * c + d) for s, a, b, c, d in steps)

    def update(self, event, mass_a):
        x = self.x
        h = row_of(event["kind"], x, self.model, mass_a).reshape(1, -1)
        e = event["y"] - float(np.real(dense.measurement(event["kind"], x[:13], self.model, mass_a)))
        r = variance_of(event, x, self.model)
        z = np.array([[e]]) + h @ x.reshape(-1, 1)
        if self.name == "sr-ekf":
            self.filter.H, self.filter.R = h, np.array([[r]])
            self.filter.update(z)
        else:
            self.filter.update(z, R=r, H=h)


class Unscented:
    """filterpy's unscented filter with Merwe's points; they are drawn anew for each measurement, as (A.20) does."""

    def __init__(self, x, p, model, alpha, beta, kappa):
        self.model, n = model, len(x)
        points = MerweScaledSigmaPoints(n, alpha, beta, kappa)
        self.filter = UnscentedKalmanFilter(n, 1, 1.0, lambda s: s[:1], lambda s, dt: s, points)
        self.filter.x, self.filter.P = x.copy(), p.copy()

    @property
    def x(self):
        return self.filter.x

    @property
    def p(self):
        return self.filter.P

    def predict(self, dt, mass_a, boosted):
        own, before = self.filter, self.x.copy()
        drawn = own.points_fn.sigma_points(own.x, own.P)
        carried = np.array([midpoint(point, dt, self.model, mass_a) for point in drawn])
        mean = own.Wm @ carried
        own.Q = dt * noise(mean, self.model, boosted)
        own.predict(dt=dt, fx=lambda s, _dt: midpoint(s, dt, self.model, mass_a))
        return (drawn - before).T @ np.diag(own.Wc) @ (carried - mean)

    def update(self, event, mass_a):
        own = self.filter
        own.sigmas_f = own.points_fn.sigma_points(own.x, own.P)

        def seen(s):
            return np.array([np.real(dense.measurement(event["kind"], s[:13], self.model, mass_a))])

        own.update(np.array([event["y"]]), R=variance_of(event, own.x, self.model), hx=seen)


def to_normal(x, model, mass_a):
    """z = Φ(x) of 1.2.3, safe for complex steps."""
    v, sin_p, cos_p = x[mk.V], np.sin(x[mk.TH]), np.cos(x[mk.TH])
    z3 = x[mk.F] - model.mass * model.gravity * sin_p
    z3 = z3 - model.mass * model.crr * (model.gravity * cos_p + x[mk.SK] * v**2)
    dv = (z3 - model.drag * v**2) / mass_a
    readings = [dense.measurement(kind, x, model, mass_a) for kind in (mk.ACC_I, mk.ACC_J, mk.ACC_K)]
    climb = [-x[mk.D], v * sin_p, v**2 * x[mk.SK] * cos_p + sin_p * dv]
    return np.array([x[mk.X], v, z3, x[mk.PSI], x[mk.SJ] * v, x[mk.N], x[mk.E], *climb, *readings])


def from_normal(z, model, mass_a, near):
    """Newton's iteration on Φ(x) = z, so that the printed inverse is not used to check itself."""
    x = near.copy()
    for _ in range(50):
        step = np.linalg.solve(complex_step(lambda s: to_normal(s, model, mass_a), x), z - to_normal(x, model, mass_a))
        x = x + step
        if np.abs(step).max() < 1e-13:
            break
    return x


class HighGain:
    """EKF in z with Q_G and R_G of A.4.4 for a gain that the caller sets."""

    weights = (0, 1, 2, 1, 2, 2, 2, 0, 1, 2, 2, 2, 2)
    OUTPUT: ClassVar = {
        mk.DISTANCE: 0, mk.HEADING: 1, mk.NORTH: 2, mk.EAST: 2, mk.ALTITUDE: 0, mk.ROAD_ALTITUDE: 0,
        mk.ACC_I: 2, mk.ACC_J: 2, mk.ACC_K: 2,
    }  # fmt: skip

    def __init__(self, x, p, model, mass_a):
        self.model, self.gain, self.mass_a, self.x = model, 1.0, mass_a, x.copy()
        j = self._jacobian(x)
        self.z, self.pz = to_normal(x, model, self.mass_a), j @ p @ j.T

    def _jacobian(self, x):
        return complex_step(lambda s: to_normal(s, self.model, self.mass_a), x)

    @property
    def p(self):
        back = np.linalg.inv(self._jacobian(self.x))
        return back @ self.pz @ back.T

    def predict(self, dt, mass_a, boosted):
        before, p, f = self.x, self.p, lambda s: derivative(s, self.model, mass_a)
        a = complex_step(f, before + 0.5 * dt * f(before))
        old = self._jacobian(before)
        self.x, self.mass_a = midpoint(before, dt, self.model, mass_a), mass_a
        self.z, j = to_normal(self.x, self.model, mass_a), self._jacobian(self.x)
        transition = j @ series(a, dt) @ np.linalg.inv(old)
        weights = np.diag(self.gain ** np.array(self.weights, float))
        q = self.gain * weights @ j @ noise(self.x, self.model, boosted) @ j.T @ weights
        self.pz = transition @ self.pz @ transition.T + dt * q
        return p @ series(a, dt).T

    def update(self, event, mass_a):
        assert mass_a == self.mass_a
        h = row_of(event["kind"], self.x, self.model, mass_a) @ np.linalg.inv(self._jacobian(self.x))
        delta = self.gain ** self.OUTPUT.get(event["kind"], 0)
        r = variance_of(event, self.x, self.model) * delta**2 / self.gain
        e = event["y"] - float(np.real(dense.measurement(event["kind"], self.x, self.model, mass_a)))
        gain = self.pz @ h / (h @ self.pz @ h + r)
        self.z = self.z + gain * e
        self.pz = self.pz - np.outer(gain, h @ self.pz)
        self.x = from_normal(self.z, self.model, mass_a, self.x)


def run(own, events, model, gains=None):
    """Filter and smooth (Rauch–Tung–Striebel with the cross covariances); per node (x, p) filtered and smoothed."""
    now, history = events.t_s[0], []
    for i, t in enumerate(events.t_s):
        mass_a = float(model.accelerated_mass[events.gear[i]])
        if gains is not None:
            own.gain = float(gains[i])
        cross = own.p.copy()
        if t > now:
            cross = own.predict(t - now, mass_a, events.boosted[i])
            now = t
        predicted = own.x.copy(), own.p.copy()
        if events.kind[i] != mk.NODE:
            own.update({"kind": int(events.kind[i]), "y": events.y[i], "r": events.r[i]}, mass_a)
        history.append((cross, *predicted, own.x.copy(), own.p.copy()))
    x, p = history[-1][3:]
    smoothed = [(x, p)]
    for i in range(len(history) - 2, -1, -1):
        cross, next_x, next_p = history[i + 1][:3]
        gain = np.linalg.solve(next_p.T, cross.T).T
        x = history[i][3] + gain @ (x - next_x)
        p = history[i][4] + gain @ (p - next_p) @ gain.T
        smoothed.append((x, p))
    smoothed.reverse()
    nodes = np.flatnonzero(events.kind == mk.NODE)
    return [history[i][3:] for i in nodes], [smoothed[i] for i in nodes]
