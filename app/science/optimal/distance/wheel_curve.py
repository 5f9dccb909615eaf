"""The fuel curve of a Willans drive, whose force is limited as well as its power."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from app.science.arrays import FloatArray, IntArray
from app.science.optimal.distance.curve import Mixture
from app.science.optimal.problem import WillansDrive


@dataclass(frozen=True)
class WheelCurve:
    """Of a Willans drive: F = c0 + c1 P + c2 P², and c0 below no power and in neutral."""

    drive: WillansDrive
    neutral: bool

    def fuel_w(self, power_w: FloatArray) -> FloatArray:
        """Return F(P)."""
        c0, c1, c2 = self.drive.willans
        power = np.maximum(power_w, 0.0)
        return np.asarray(c0 + c1 * power + c2 * power**2)

    def _ends(self, speed_mps: FloatArray) -> tuple[FloatArray, FloatArray]:
        (p0, p1), (f0, f1) = self.drive.power_w, self.drive.force_n
        low = np.maximum(np.maximum(p0, f0 * speed_mps), 0.0)
        return (0.0 * low if self.neutral else low), np.minimum(p1, f1 * speed_mps)

    def cheapest_w(self, speed_mps: float) -> tuple[float, float]:
        """Return the power at the wheels that burns least, and what it burns."""
        low = self._ends(np.array([speed_mps]))[0]
        return float(low[0]), float(self.fuel_w(low)[0])

    def strongest_w(self, speed_mps: float) -> float:
        """Return the largest power at the wheels."""
        return float(self._ends(np.array([speed_mps]))[1][0])

    def touching(self, speed_mps: FloatArray, power_w: FloatArray, level_w: FloatArray, *, above: bool) -> FloatArray:
        """Return the power at which a line from (power, level) touches F from below, to the right or to the left."""
        c0, c1, c2 = self.drive.willans
        low, high = self._ends(speed_mps)
        sign = 1.0 if above else -1.0
        places = [low, high]
        if c2 > 0.0:
            root = np.sqrt(np.maximum(power_w**2 + (c0 + c1 * power_w - level_w) / c2, 0.0))
            places.append(np.clip(power_w + sign * root, low, high))
        options = np.array(places)
        away = sign * (options - power_w)
        slope = np.where(away > 0.0, (self.fuel_w(options) - level_w) / np.where(away > 0.0, away, 1.0), np.inf)
        best = slope.argmin(axis=0)
        found = np.take_along_axis(options, best[None], axis=0)[0]
        return np.where(np.isfinite(slope.min(axis=0)), found, np.nan)

    def mixture(self, speed_mps: FloatArray, power_w: FloatArray) -> Mixture:
        """Return the least mean fuel power for a mean power at the wheels."""
        low, high = self._ends(speed_mps)
        inside = (power_w >= low) & (power_w <= high)
        if self.drive.willans[2] >= 0.0:
            return Mixture(np.where(inside, self.fuel_w(power_w), np.inf), power_w, power_w)
        width = np.where(high > low, high - low, 1.0)
        fuel = self.fuel_w(low) + (self.fuel_w(high) - self.fuel_w(low)) * (power_w - low) / width
        return Mixture(np.where(inside, fuel, np.inf), low, high)

    def moving_limit(self, speed_mps: FloatArray, power_w: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Return the force limit where it holds the power, N, and dF/dP there."""
        _, c1, c2 = self.drive.willans
        limits = self.drive.force_n
        slopes = [
            np.where((power_w > 0.0) & (np.abs(power_w - n * speed_mps) <= 1e-9 * power_w), n, 0.0) for n in limits
        ]
        slope = np.asarray(slopes[0] + slopes[1])
        return slope, np.where(slope != 0.0, c1 + 2.0 * c2 * power_w, 0.0)

    def piece(self, speed_mps: FloatArray, power_w: FloatArray) -> IntArray:
        """Number the limits, and what lies between them."""
        moving, _ = self.moving_limit(speed_mps, power_w)
        at_end = 2 * (power_w >= self.drive.power_w[1]) + (power_w <= self._ends(speed_mps)[0])
        return np.asarray(4 * (moving != 0.0) + at_end, dtype=np.int64)
