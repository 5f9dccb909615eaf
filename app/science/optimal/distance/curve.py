"""The least fuel power for a power at the wheels, and the straight lines that touch it from below.

With a CVT the engine's speed is free, so all a drive sees of the engine is F(P) = min P_fuel(ω, P/ω). Where F isn't
convex two controls in turn burn less than any one with their mean power; which two, its convex hull says.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import Protocol

import numpy as np
from scipy.interpolate import CubicSpline

from app.science.arrays import BoolArray, FloatArray, IntArray
from app.science.optimal.distance.hull import lower_hull
from app.science.optimal.fuel_checks import fuel_power_w, full_load_nm
from app.science.optimal.problem import RADPS_PER_RPM, PolynomialEngine

NODES = 3001
SCAN = 241
GOLDEN = 0.6180339887498949
SHRINKS = 45
POLISH = 5


@dataclass(frozen=True, slots=True)
class Mixture:
    """Two controls in turn that give a mean power on the least fuel, each array of shape (n,).

    Attributes
    ----------
    fuel_w : array
        Mean; infinite where no mixture gives the power.
    low_w, high_w : array
        Powers at the wheels of the two; the same where one control does it.
    """

    fuel_w: FloatArray
    low_w: FloatArray
    high_w: FloatArray


class FuelCurve(Protocol):
    """Fuel power over power at the wheels, both in W, from the least fuel power on."""

    def fuel_w(self, power_w: FloatArray) -> FloatArray:
        """Return F(P)."""
        ...

    def cheapest_w(self, speed_mps: float) -> tuple[float, float]:
        """Return the power at the wheels that burns least, and what it burns."""
        ...

    def strongest_w(self, speed_mps: float) -> float:
        """Return the largest power at the wheels."""
        ...

    def touching(self, speed_mps: FloatArray, power_w: FloatArray, level_w: FloatArray, *, above: bool) -> FloatArray:
        """Return the power P above or below ``power_w`` with the least (F(P) − level) / |P − power|; NaN for none."""
        ...

    def mixture(self, speed_mps: FloatArray, power_w: FloatArray) -> Mixture:
        """Return the least mean fuel power for a mean power at the wheels."""
        ...

    def moving_limit(self, speed_mps: FloatArray, power_w: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Return dP/dv of a limit that holds the power and moves with the speed, N, and dF/dP; 0 where none does."""
        ...

    def piece(self, speed_mps: FloatArray, power_w: FloatArray) -> IntArray:
        """Number the pieces of the curve within which a touching power moves smoothly with the speed."""
        ...


@dataclass(frozen=True)
class EngineCurve:
    """Of an engine behind a CVT, on nodes of power.

    Attributes
    ----------
    power_w, node_fuel_w, omega : array, shape (n,)
        From the least fuel power on; a neutral is a node of its own with NaN engine speed.
    """

    engine: PolynomialEngine
    power_w: FloatArray
    node_fuel_w: FloatArray
    omega: FloatArray

    @classmethod
    def of(cls, engine: PolynomialEngine, neutral: bool) -> EngineCurve:
        """Return the curve of an engine, with neutral where the transmission has one."""
        omega = np.linspace(*engine.speed_rpm, SCAN) * RADPS_PER_RPM
        top = full_load_nm(engine, omega / RADPS_PER_RPM)
        able = top >= engine.torque_nm[0]
        most = int(np.argmax(np.where(able, omega * top, -np.inf)))
        low = float((omega * engine.torque_nm[0])[able].min())
        power = np.linspace(low, float(omega[most] * top[most]), NODES)
        best = cheapest_speeds(engine, power, omega)
        fuel = fuel_power_w(engine, best, power / best)
        start = int(fuel.argmin())
        power, fuel, best = power[start:], fuel[start:], best[start:]
        if neutral and (idle := engine.idle_fuel_power_w) < fuel[0]:
            keep = (power > 0.0) & (fuel > idle)
            power, fuel, best = (
                np.concatenate(([first], kept[keep])) for first, kept in ((0.0, power), (idle, fuel), (np.nan, best))
            )
        return cls(engine, power, fuel, best)

    @cached_property
    def spline(self) -> CubicSpline:
        """F between nodes with the engine engaged."""
        engaged = np.isfinite(self.omega)
        return CubicSpline(self.power_w[engaged], self.node_fuel_w[engaged])

    @cached_property
    def hull(self) -> tuple[FloatArray, FloatArray, BoolArray]:
        """Corners of the convex hull (P, F), and whether F itself runs from each to the next one."""
        corners = lower_hull(self.power_w, self.node_fuel_w)
        step = self.power_w[-1] - self.power_w[-2]
        p, f = self.power_w[corners].copy(), self.node_fuel_w[corners].copy()
        runs = (np.diff(corners) == 1) & (np.diff(p) < 1.5 * step)
        first = 1 if not np.isfinite(self.omega[0]) else 0
        for k in np.flatnonzero(~runs):
            for _ in range(8 * POLISH):
                slope = (f[k + 1] - f[k]) / (p[k + 1] - p[k])
                for j in (k, k + 1):
                    if first <= j < len(p) - 1 and corners[j] > 0:
                        bend = float(self.spline(p[j], 2))
                        moved = p[j] - np.clip((float(self.spline(p[j], 1)) - slope) / max(bend, 1e-30), -step, step)
                        p[j] = np.clip(moved, self.power_w[corners[j] - 1], self.power_w[corners[j] + 1])
                        f[j] = float(self.spline(p[j]))
        return p, f, runs

    def fuel_w(self, power_w: FloatArray) -> FloatArray:
        """Return F(P)."""
        neutral = np.isnan(self.omega[0]) & (power_w == self.power_w[0])
        return np.asarray(np.where(neutral, self.node_fuel_w[0], self.spline(power_w)))

    def engine_speed(self, power_w: FloatArray) -> FloatArray:
        """Return the engine speed that burns least at a power, rad/s; NaN in neutral."""
        engaged = np.isfinite(self.omega)
        found = cheapest_speeds(self.engine, power_w, np.linspace(*self.engine.speed_rpm, SCAN) * RADPS_PER_RPM)
        return np.where((not engaged[0]) & (power_w == self.power_w[0]), np.nan, found)

    def cheapest_w(self, speed_mps: float) -> tuple[float, float]:
        """Return the power at the wheels that burns least, and what it burns."""
        return float(self.power_w[0]), float(self.node_fuel_w[0])

    def strongest_w(self, speed_mps: float) -> float:
        """Return the largest power at the wheels."""
        return float(self.power_w[-1])

    def touching(self, speed_mps: FloatArray, power_w: FloatArray, level_w: FloatArray, *, above: bool) -> FloatArray:
        """Return the power at which a line from (power, level) touches F from below, to the right or to the left."""
        p, f, runs = self.hull
        sign = 1.0 if above else -1.0
        hull_p, hull_f, hull_runs = (p, f, runs) if above else (-p[::-1], f[::-1], runs[::-1])
        start = sign * power_w
        low = np.searchsorted(hull_p, start, side="right")
        none = low >= len(hull_p)
        low = np.minimum(low, len(hull_p) - 1)
        high = np.full(start.shape, len(hull_p) - 1)
        while (low < high).any():
            middle = (low + high) // 2
            after = np.minimum(middle + 1, len(hull_p) - 1)
            falling = (hull_f[after] - level_w) * (hull_p[middle] - start) < (hull_f[middle] - level_w) * (
                hull_p[after] - start
            )
            low, high = np.where(falling & (low < high), middle + 1, low), np.where(falling, high, middle)
        found, least = np.full(start.shape, np.nan), np.full(start.shape, np.inf)
        # on either side of a gap the corners' own order may differ from that of the places to which they slide
        for corner in (low, np.maximum(low - 1, 0), np.minimum(low + 1, len(hull_p) - 1)):
            span = _span(hull_p, hull_runs, corner, start, sign)
            at = self._polished(sign * hull_p[corner], power_w, level_w, *span)
            away = sign * (at - power_w)
            slope = np.where(away > 0.0, (self.fuel_w(at) - level_w) / np.where(away > 0.0, away, 1.0), np.inf)
            found, least = np.where(slope < least, at, found), np.minimum(slope, least)
        return np.where(none, np.nan, found)

    def _polished(
        self, at: FloatArray, power_w: FloatArray, level_w: FloatArray, low: FloatArray, high: FloatArray
    ) -> FloatArray:
        """Slide a corner along F to where the line truly touches."""
        x = at
        for _ in range(POLISH):
            bend = self.spline(x, 2) * (x - power_w)
            miss = self.spline(x, 1) * (x - power_w) - (self.spline(x) - level_w)
            x = np.clip(x - np.where(bend != 0.0, miss / np.where(bend != 0.0, bend, 1.0), 0.0), low, high)
        return np.where(low < high, x, at)

    def mixture(self, speed_mps: FloatArray, power_w: FloatArray) -> Mixture:
        """Return the least mean fuel power for a mean power at the wheels."""
        p, f, runs = self.hull
        k = np.clip(np.searchsorted(p, power_w, side="right") - 1, 0, len(p) - 2)
        inside = (power_w >= p[0]) & (power_w <= p[-1])
        line = f[k] + (f[k + 1] - f[k]) * (power_w - p[k]) / (p[k + 1] - p[k])
        fuel = np.where(runs[k], self.spline(power_w), line)
        low, high = np.where(runs[k], power_w, p[k]), np.where(runs[k], power_w, p[k + 1])
        return Mixture(np.where(inside, fuel, np.inf), low, high)

    def moving_limit(self, speed_mps: FloatArray, power_w: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Return 0: no limit moves with the speed."""
        return np.zeros(np.shape(power_w)), np.zeros(np.shape(power_w))

    def piece(self, speed_mps: FloatArray, power_w: FloatArray) -> IntArray:
        """Number the stretches between gaps of the hull, and its ends."""
        p, _, runs = self.hull
        starts = p[1:][~runs]
        number = np.searchsorted(starts, power_w * (1.0 + 1e-12), side="right")
        return np.asarray(4 * number + 2 * (power_w >= p[-1]) + (power_w <= p[0]))


def cheapest_speeds(engine: PolynomialEngine, power: FloatArray, omega: FloatArray) -> FloatArray:
    """Return for each power the engine speed that burns least: scanned, then narrowed by golden sections."""

    def cost(speed: FloatArray, watts: FloatArray) -> FloatArray:
        torque = watts / speed
        over = np.maximum(torque - full_load_nm(engine, speed / RADPS_PER_RPM), engine.torque_nm[0] - torque)
        size = 1e-12 * max(abs(engine.torque_nm[0]), abs(engine.torque_nm[1]))
        return np.where(over > size, 1e15 * (1.0 + over), fuel_power_w(engine, speed, torque))

    omega = np.maximum(omega, 1e-6)
    at = cost(omega[None, :], power[:, None]).argmin(axis=1)
    best = omega[at]
    a, b = omega[np.maximum(at - 1, 0)], omega[np.minimum(at + 1, len(omega) - 1)]
    for _ in range(SHRINKS):
        left, right = b - GOLDEN * (b - a), a + GOLDEN * (b - a)
        fewer = cost(left, power) < cost(right, power)
        a, b = np.where(fewer, a, left), np.where(fewer, right, b)
    middle = 0.5 * (a + b)
    for other in (a, b, middle):
        best = np.where(cost(other, power) < cost(best, power), other, best)
    return np.asarray(best)


def _span(
    hull_p: FloatArray, runs: BoolArray, corner: IntArray, start: FloatArray, sign: float
) -> tuple[FloatArray, FloatArray]:
    """Return between which powers the touching point may slide from a corner, never past the line's own start."""
    before, after = np.maximum(corner - 1, 0), np.minimum(corner + 1, len(hull_p) - 1)
    slack_before = (corner > 0) & np.concatenate(([False], runs))[corner]
    slack_after = np.concatenate((runs, [False]))[corner]
    near = np.maximum(np.where(slack_before, hull_p[before], hull_p[corner]), np.minimum(start, hull_p[corner]))
    far = np.where(slack_after, hull_p[after], hull_p[corner])
    return (near, far) if sign > 0.0 else (-far, -near)
