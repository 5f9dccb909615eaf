"""Speeding up or slowing down at a price of distance: pointwise choice of power, then integrals over speed.

With free time H = λ_x v + λ_v v' − F = 0 and λ_x is constant, so at every speed the best control is the one with the
least (F − λ_x v) / |v'|, and λ_v = that (with the sign of v'). No costate is shot for.
"""

from __future__ import annotations

from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from app.science.arrays import FloatArray, IntArray
from app.science.optimal.distance.curve import FuelCurve
from app.science.optimal.problem import RoadLoad

POINTS, WEIGHTS = np.polynomial.legendre.leggauss(12)
_GRADED = 0.5 * 4.0 ** -np.arange(10.0, 1.5, -1.0)
PANELS = np.concatenate(([0.0], _GRADED, np.linspace(0.05, 0.95, 25), 1.0 - _GRADED[::-1], [1.0]))
_Z = (0.5 * (PANELS[1:] + PANELS[:-1])[:, None] + 0.5 * np.diff(PANELS)[:, None] * POINTS).ravel()
_SHARE = (0.5 * np.diff(PANELS)[:, None] * WEIGHTS).ravel()
_LOOKS = np.linspace(0.0, 1.0, 161)
NEAREST = 1e-6
"""To the ends of a leg: where the car turns round, force and resistance are the same to rounding nearer to it."""


@dataclass(frozen=True, slots=True)
class Car:
    """What moves, and what its engine burns for it."""

    load: RoadLoad
    curve: FuelCurve

    def resisted_w(self, speed_mps: FloatArray) -> FloatArray:
        """Return the power that keeps a speed, W."""
        return np.asarray(speed_mps * self.resistance_n(speed_mps))

    def resistance_n(self, speed_mps: FloatArray) -> FloatArray:
        """Return drag and rolling resistance, N."""
        return np.asarray(self.load.drag_kgpm * speed_mps**2 + self.load.rolling_n)


@dataclass(frozen=True, slots=True)
class Run:
    """What happens at shares z of a leg, 0 to 1, each array of shape (n,): speed, power at the wheels, dt/dz."""

    speed_mps: FloatArray
    power_w: FloatArray
    pace_s: FloatArray


@dataclass(frozen=True, slots=True)
class Leg:
    """From one speed to another, always in one direction.

    Attributes
    ----------
    from_mps, to_mps : float
    price_n : float
        λ_x, J for a metre.
    fuel_j, time_s, distance_m : float
        Infinite where the drive can't be.
    """

    from_mps: float
    to_mps: float
    price_n: float
    fuel_j: float
    time_s: float
    distance_m: float


def run(car: Car, from_mps: float, to_mps: float, price_n: float, z: FloatArray) -> Run:
    """Follow a leg; speed goes with z² (3 − 2 z), so that a turn, where v' goes with √|Δv|, is smooth in z."""
    z = np.clip(z, NEAREST, 1.0 - NEAREST)
    v = from_mps + (to_mps - from_mps) * z**2 * (3.0 - 2.0 * z)
    resisted = car.resisted_w(v)
    power = car.curve.touching(v, resisted, price_n * v, above=to_mps > from_mps)
    with np.errstate(divide="ignore"):
        per_mps = car.load.accelerated_mass_kg * v / np.abs(power - resisted)
    return Run(v, power, abs(to_mps - from_mps) * 6.0 * z * (1.0 - z) * per_mps)


def legs(car: Car, from_mps: float, to_mps: float, price_n: float) -> tuple[Leg, ...]:
    """Integrate over speed, from one jump or kink of the control to the next; none where there is nothing to do."""
    if from_mps == to_mps:
        return ()
    stops = (from_mps, *_changes(car, from_mps, to_mps, price_n), to_mps)
    return tuple(_leg(car, a, b, price_n) for a, b in pairwise(stops))


def _changes(car: Car, from_mps: float, to_mps: float, price_n: float) -> list[float]:
    """Return the speeds at which the control gets to another piece of the fuel curve, by bisection."""

    def piece(z: FloatArray) -> IntArray:
        there = run(car, from_mps, to_mps, price_n, z)
        return car.curve.piece(there.speed_mps, there.power_w)

    at = piece(_LOOKS)
    k = np.flatnonzero(np.diff(at))
    low, high = _LOOKS[k], _LOOKS[k + 1]
    for _ in range(48 if k.size else 0):
        middle = 0.5 * (low + high)
        same = piece(middle) == at[k]
        low, high = np.where(same, middle, low), np.where(same, high, middle)
    return [float(v) for v in from_mps + (to_mps - from_mps) * low**2 * (3.0 - 2.0 * low)]


def _leg(car: Car, from_mps: float, to_mps: float, price_n: float) -> Leg:
    """Integrate over a leg; panels get narrower towards both ends, where the car may hardly change its speed."""
    there = run(car, from_mps, to_mps, price_n, _Z)
    dt = there.pace_s * _SHARE
    if not np.isfinite(dt).all():
        return Leg(from_mps, to_mps, price_n, np.inf, np.inf, np.inf)
    fuel = float((car.curve.fuel_w(there.power_w) * dt).sum())
    return Leg(from_mps, to_mps, price_n, fuel, float(dt.sum()), float((there.speed_mps * dt).sum()))
