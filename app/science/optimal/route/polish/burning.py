"""What a drive burns at a speed and a force at the wheels, with its derivatives, and what force it has."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Protocol

import numpy as np
from scipy.interpolate import CubicSpline

from app.science.arrays import FloatArray
from app.science.optimal.distance.curve import EngineCurve
from app.science.optimal.problem import RADPS_PER_RPM, PolynomialEngine, Route, WillansDrive

NODES, SPREAD = 6001, 4
GAP_EDGE = 1e-6
"""Of the largest power: nearer to a control of its own a power counts as that."""


@dataclass(frozen=True, slots=True)
class Burned:
    """Fuel power P(v, F) and its derivatives, each array of the same shape, in W, m/s and N."""

    power_w: FloatArray
    by_v: FloatArray
    by_f: FloatArray
    by_vv: FloatArray
    by_vf: FloatArray
    by_ff: FloatArray


@dataclass(frozen=True, slots=True)
class ForceLimit:
    """A limit of the force at the wheels, N, with its derivatives by speed."""

    force_n: FloatArray
    by_v: FloatArray
    by_vv: FloatArray


class Powertrain(Protocol):
    """Fuel and forces of a car; ``ratio`` is by how many rad the engine turns in a metre, 0 in neutral."""

    @property
    def brakes_anywhere(self) -> bool:
        """Whether brakes act beside the engine; else they act in neutral only."""
        ...

    def needs_turns(self, speed_mps: FloatArray, force_n: FloatArray) -> bool:
        """Tell whether some of the forces take two controls in turn."""
        ...

    def retards(self, speed_mps: FloatArray) -> Sequence[ForceLimit]:
        """Return forces, all of which limit by how much the drive holds the car back while it burns what idling does.

        Empty where it doesn't.
        """
        ...

    def burned(self, speed_mps: FloatArray, force_n: FloatArray, ratio: FloatArray) -> Burned:
        """Return fuel power at speeds and forces."""
        ...

    def lowest(self, speed_mps: FloatArray, ratio: FloatArray) -> ForceLimit:
        """Return the least force."""
        ...

    def highest(self, speed_mps: FloatArray, ratio: FloatArray) -> Sequence[ForceLimit]:
        """Return largest forces, all of which hold."""
        ...


@dataclass(frozen=True, slots=True)
class Geared:
    """An engine behind gears, ω = ratio · v and F = ratio · T; in neutral it idles and the force is the brakes'.

    Attributes
    ----------
    engine : PolynomialEngine
    fuel_w : array, shape (powers of ω, powers of T)
    brake_max_n : float
    """

    engine: PolynomialEngine
    fuel_w: FloatArray
    brake_max_n: float

    brakes_anywhere = False

    @classmethod
    def of(cls, engine: PolynomialEngine, brake_max_n: float) -> Geared:
        """Return the powertrain of an engine."""
        table = np.zeros((max(i for i, _ in engine.terms) + 1, max(j for _, j in engine.terms) + 1))
        for (i, j), c in zip(engine.terms, engine.coefficients, strict=True):
            table[i, j] += c
        return cls(engine, table, brake_max_n)

    def burned(self, speed_mps: FloatArray, force_n: FloatArray, ratio: FloatArray) -> Burned:
        """Return fuel power at speeds and forces."""
        pulls = ratio > 0.0
        k = np.where(pulls, ratio, 1.0)
        omega, torque = k * speed_mps, force_n / k

        def power(by_omega: int, by_torque: int) -> FloatArray:
            return np.where(pulls, _derivative(self.fuel_w, omega, torque, by_omega, by_torque), 0.0)

        return Burned(
            np.where(pulls, power(0, 0), self.engine.idle_fuel_power_w),
            k * power(1, 0), power(0, 1) / k, k**2 * power(2, 0), power(1, 1), power(0, 2) / k**2,
        )  # fmt: skip

    def needs_turns(self, speed_mps: FloatArray, force_n: FloatArray) -> bool:
        """Return False: every force is one control's."""
        return False

    def retards(self, speed_mps: FloatArray) -> Sequence[ForceLimit]:
        """Return nothing: in gear the torque is never below the lowest."""
        return ()

    def lowest(self, speed_mps: FloatArray, ratio: FloatArray) -> ForceLimit:
        """Return the force of the least torque; in neutral, that of the brakes."""
        none = np.zeros(np.broadcast_shapes(speed_mps.shape, ratio.shape))
        force = np.where(ratio > 0.0, ratio * self.engine.torque_nm[0], -self.brake_max_n)
        return ForceLimit(force + none, none, none)

    def highest(self, speed_mps: FloatArray, ratio: FloatArray) -> Sequence[ForceLimit]:
        """Return the force of the largest torque and of full load; in neutral, none."""
        none = np.zeros(np.broadcast_shapes(speed_mps.shape, ratio.shape))
        box = ForceLimit(ratio * self.engine.torque_nm[1] + none, none, none)
        if not self.engine.full_load:
            return (box,)
        line = np.array(self.engine.full_load)
        at, nm = line[:, 0] * RADPS_PER_RPM, line[:, 1]
        omega = ratio * speed_mps
        piece = np.clip(np.searchsorted(at, omega, side="right") - 1, 0, max(len(at) - 2, 0))
        rise = np.diff(nm) / np.diff(at) if len(at) > 1 else np.zeros(1)
        beyond = (omega <= at[0]) | (omega >= at[-1])
        full = ratio * np.interp(omega, at, nm)
        return (box, ForceLimit(full, np.where(beyond, 0.0, rise[piece]) * ratio**2, none))


def _derivative(table: FloatArray, x: FloatArray, y: FloatArray, by_x: int, by_y: int) -> FloatArray:
    """Return a derivative of Σ table[i, j] xⁱ yʲ."""
    poly = np.polynomial.polynomial
    rows = poly.polyder(table, by_x, axis=0) if by_x else table
    rows = poly.polyder(rows, by_y, axis=1) if by_y else rows
    over_y = poly.polyval(x, rows) if rows.size else np.zeros((1, *x.shape))
    total = np.zeros(np.broadcast_shapes(x.shape, y.shape))
    for one in over_y[::-1]:
        total = total * y + one
    return total


@dataclass(frozen=True)
class AtWheels:
    """A drive known by its fuel power over power at the wheels, F(P), with brakes beside it.

    Attributes
    ----------
    curve : callable
        P to F, F′ and F″.
    power_w : (lowest, highest)
    force_n : (lowest, highest)
        Of the drive while it pulls.
    back_w, back_n : float
        Largest power and force with which the drive holds the car back.
    gaps_w : tuple of (low, high)
        Between these powers F is that of both in turn; no single control burns so little.
    """

    curve: _PowerCurve
    power_w: tuple[float, float]
    force_n: tuple[float, float]
    back_w: float = 0.0
    back_n: float = 0.0
    gaps_w: tuple[tuple[float, float], ...] = ()

    brakes_anywhere = True

    def burned(self, speed_mps: FloatArray, force_n: FloatArray, ratio: FloatArray) -> Burned:
        """Return fuel power at speeds and forces."""
        f, slope, bend = self.curve(force_n * speed_mps)
        v, n = speed_mps, force_n
        return Burned(f, slope * n, slope * v, bend * n**2, slope + bend * n * v, bend * v**2)

    def needs_turns(self, speed_mps: FloatArray, force_n: FloatArray) -> bool:
        """Tell whether some power lies in a gap."""
        power = speed_mps * force_n
        room = GAP_EDGE * (self.power_w[1] - self.power_w[0])
        return any(bool(((power > low + room) & (power < high - room)).any()) for low, high in self.gaps_w)

    def retards(self, speed_mps: FloatArray) -> Sequence[ForceLimit]:
        """Return the force and that of the power with which it holds the car back."""
        if not (self.back_w > 0.0 and self.back_n > 0.0):
            return ()
        none = np.zeros(speed_mps.shape)
        return (_of_power(self.back_w, speed_mps), ForceLimit(self.back_n + none, none, none))

    def lowest(self, speed_mps: FloatArray, ratio: FloatArray) -> ForceLimit:
        """Return the larger of the least force and that of the least power."""
        by_power = _of_power(self.power_w[0], speed_mps)
        holds = by_power.force_n >= self.force_n[0]
        return ForceLimit(
            np.where(holds, by_power.force_n, self.force_n[0]),
            np.where(holds, by_power.by_v, 0.0),
            np.where(holds, by_power.by_vv, 0.0),
        )

    def highest(self, speed_mps: FloatArray, ratio: FloatArray) -> Sequence[ForceLimit]:
        """Return the largest force and that of the largest power."""
        by_power = _of_power(self.power_w[1], speed_mps)
        if not np.isfinite(self.force_n[1]):
            return (by_power,)
        none = np.zeros(speed_mps.shape)
        return (by_power, ForceLimit(self.force_n[1] + none, none, none))


def _of_power(power_w: float, v: FloatArray) -> ForceLimit:
    return ForceLimit(power_w / v, -power_w / v**2, 2.0 * power_w / v**3)


class _PowerCurve(Protocol):
    def __call__(self, power_w: FloatArray) -> tuple[FloatArray, FloatArray, FloatArray]: ...


def willans_curve(drive: WillansDrive) -> _PowerCurve:
    """Return c0 + c1 P + c2 P²; straight on below no power, where only iterations go."""
    c0, c1, c2 = drive.willans

    def curve(power_w: FloatArray) -> tuple[FloatArray, FloatArray, FloatArray]:
        bent = np.where(power_w > 0.0, c2, 0.0)
        return c0 + (c1 + bent * power_w) * power_w, c1 + 2.0 * bent * power_w, 2.0 * bent

    return curve


def engine_curve(curve: EngineCurve) -> _PowerCurve:
    """Return the convex hull of an engine's least fuel power; straight on beyond both ends.

    Where the best engine speed meets a limit the slope may jump. It is spread over a few nodes, so that Newton's method
    sees a curvature there; the fuel changes by less than a hundred thousandth.
    """
    p, f, runs = curve.hull
    spline = curve.spline
    nodes = np.linspace(p[0], p[-1], NODES)
    k = np.clip(np.searchsorted(p, nodes, side="right") - 1, 0, len(p) - 2)
    slopes = np.where(runs[k], spline(nodes, 1), (np.diff(f) / np.diff(p))[k])
    window = np.hanning(2 * SPREAD + 3)[1:-1]
    padded = np.concatenate(
        (2.0 * slopes[0] - slopes[SPREAD:0:-1], slopes, 2.0 * slopes[-1] - slopes[-2 : -SPREAD - 2 : -1])
    )
    slope = CubicSpline(nodes, np.convolve(padded, window / window.sum(), mode="valid"))
    cubic, quartic = slope.c, slope.antiderivative().c
    step = nodes[1] - nodes[0]
    ends = slope(nodes[[0, -1]])

    def over(power_w: FloatArray) -> tuple[FloatArray, FloatArray, FloatArray]:
        inside = np.clip(power_w, p[0], p[-1])
        off = power_w - inside
        k = np.minimum(((inside - p[0]) / step).astype(np.int64), NODES - 2)
        x = inside - nodes[k]
        c, q = cubic[:, k], quartic[:, k]
        value = f[0] + (((q[0] * x + q[1]) * x + q[2]) * x + q[3]) * x + q[4]
        value += np.where(off < 0.0, ends[0], ends[1]) * off
        bend = np.maximum((3.0 * c[0] * x + 2.0 * c[1]) * x + c[2], 0.0)
        return value, ((c[0] * x + c[1]) * x + c[2]) * x + c[3], np.where(off == 0.0, bend, 0.0)

    return over


def on_spline(problem: Route) -> bool:
    """Tell whether a problem's fuel is known as a spline over power, so that its curvature is less exact."""
    return problem.transmission.kind == "cvt" and isinstance(problem.engine, PolynomialEngine)


def powertrain_of(problem: Route) -> Powertrain:
    """Return what drives a problem's car."""
    engine = problem.engine
    if isinstance(engine, WillansDrive):
        pulls = 0.0 if problem.transmission.neutral else 1.0
        low, least = (pulls * max(one[0], 0.0) for one in (engine.power_w, engine.force_n))
        return AtWheels(
            willans_curve(engine), (low, engine.power_w[1]), (least, engine.force_n[1]),
            max(-engine.power_w[0], 0.0), max(-engine.force_n[0], 0.0),
        )  # fmt: skip
    if problem.transmission.kind == "gears":
        return Geared.of(engine, problem.brake_max_n)
    curve = EngineCurve.of(engine, problem.transmission.neutral)
    p, _, runs = curve.hull
    gaps = tuple((float(p[k]), float(p[k + 1])) for k in np.flatnonzero(~runs))
    ends = (float(curve.power_w[0]), float(curve.power_w[-1]))
    return AtWheels(engine_curve(curve), ends, (-np.inf, np.inf), gaps_w=gaps)
