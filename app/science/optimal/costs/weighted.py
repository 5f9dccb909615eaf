"""Engines whose fuel is a weighted cost, so that every solver works on it unchanged (Sebesta 2010, 1.3 and 4.1)."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from app.science.arrays import BoolArray, FloatArray
from app.science.optimal.fuel_checks import fuel_power_w
from app.science.optimal.problem import RADPS_PER_RPM, Engine, PolynomialEngine, WillansDrive

FUEL, CO2, TIME = "fuel", "co2", "time"


@dataclass(frozen=True, slots=True)
class Emission:
    """An emission as a table over engine speed and torque, and the formula that stands in for it while solving.

    Attributes
    ----------
    name : str
    rpm, nm : tuple of float
        The table's own grid, growing.
    gps : tuple of tuple of float
        g/s; ``gps[i][k]`` belongs to ``rpm[i]``, ``nm[k]``, and lies on straight lines between (bilinear).
    idle_gps : float
        In neutral.
    terms, coefficients
        The formula: Σ c ωⁱ Tᵏ, g/s with ω in rad/s and T in Nm; nowhere below zero in the engine's field.
    rms_gps, largest_gps : float
        How far the formula is from the table in the engine's field.
    """

    name: str
    rpm: tuple[float, ...]
    nm: tuple[float, ...]
    gps: tuple[tuple[float, ...], ...]
    idle_gps: float
    terms: tuple[tuple[int, int], ...]
    coefficients: tuple[float, ...]
    rms_gps: float
    largest_gps: float

    @property
    def peak_gps(self) -> float:
        """The table's largest value."""
        return max(max(row) for row in self.gps)

    def by_table(self, omega: FloatArray, torque: FloatArray) -> FloatArray:
        """Return the table's value at engine speeds (rad/s) and torques (Nm), g/s."""
        return bilinear(self.rpm, self.nm, np.array(self.gps), omega / RADPS_PER_RPM, torque)

    def by_formula(self, omega: FloatArray, torque: FloatArray) -> FloatArray:
        """Return the formula's value at engine speeds (rad/s) and torques (Nm), g/s."""
        return fuel_power_w(PolynomialEngine(self.terms, self.coefficients, (0.0, 1.0), (0.0, 1.0)), omega, torque)


@dataclass(frozen=True, slots=True)
class Cost:
    """What a drive costs besides fuel.

    Attributes
    ----------
    weights : tuple of (name, weight)
        Of ``fuel`` without a unit, of ``co2`` and each emission in J/g: their sum is an energy.
    co2_g_per_mj : float
        Carbon dioxide for each MJ of fuel.
    emissions : tuple of Emission
    """

    weights: tuple[tuple[str, float], ...]
    co2_g_per_mj: float
    emissions: tuple[Emission, ...] = ()

    def weight(self, name: str) -> float:
        """Return the weight of fuel, co2 or an emission; 0 where none was given."""
        return dict(self.weights).get(name, 0.0)

    @property
    def of_fuel(self) -> float:
        """What a joule of fuel costs with the CO2 that it becomes."""
        return self.weight(FUEL) + self.weight(CO2) * self.co2_g_per_mj * 1e-6


@dataclass(frozen=True, slots=True)
class WeightedEngine(PolynomialEngine):
    """A polynomial engine whose fuel power is the weighted cost, W; the engine as posed stands beside it."""

    fuel: PolynomialEngine = field(kw_only=True)
    cost: Cost = field(kw_only=True)


@dataclass(frozen=True, slots=True)
class WeightedDrive(WillansDrive):
    """A Willans drive whose fuel power is the weighted cost, W; the drive as posed stands beside it."""

    fuel: WillansDrive = field(kw_only=True)
    cost: Cost = field(kw_only=True)


def weighted(engine: Engine, cost: Cost) -> WeightedEngine | WeightedDrive:
    """Return the engine that burns the weighted cost."""
    of_fuel = cost.of_fuel
    if isinstance(engine, WillansDrive):
        c0, c1, c2 = (of_fuel * c for c in engine.willans)
        return WeightedDrive((c0, c1, c2), engine.power_w, engine.force_n, fuel=engine, cost=cost)
    total = dict.fromkeys(engine.terms, 0.0)
    for term, c in zip(engine.terms, engine.coefficients, strict=True):
        total[term] += of_fuel * c
    idle = of_fuel * engine.idle_fuel_power_w
    for emission in cost.emissions:
        weight = cost.weight(emission.name)
        idle += weight * emission.idle_gps
        for term, c in zip(emission.terms, emission.coefficients, strict=True):
            total[term] = total.get(term, 0.0) + weight * c
    used = {term: c for term, c in total.items() if c != 0.0} or {(0, 0): 0.0}
    return WeightedEngine(
        tuple(used),
        tuple(used.values()),
        engine.speed_rpm,
        engine.torque_nm,
        engine.full_load,
        idle,
        fuel=engine,
        cost=cost,
    )


def in_gear(omega: FloatArray, torque: FloatArray) -> BoolArray:
    """Tell where a drive's engine pulls; its speed and torque are not known where it idles."""
    return np.asarray(np.isfinite(omega) & np.isfinite(torque))


def bilinear(
    xs: tuple[float, ...], ys: tuple[float, ...], table: FloatArray, x: FloatArray, y: FloatArray
) -> FloatArray:
    """Return a table's value on straight lines between its nodes; beyond its ends that at the end.

    Parameters
    ----------
    xs, ys : tuple of float, shapes (n,) and (m,)
    table : array, shape (n, m)
    x, y : array
        Of shapes that go together.
    """
    x, y = np.broadcast_arrays(x, y)
    a, b = np.array(xs), np.array(ys)
    i = np.clip(np.searchsorted(a, x, side="right") - 1, 0, len(a) - 2)
    k = np.clip(np.searchsorted(b, y, side="right") - 1, 0, len(b) - 2)
    u = np.clip((x - a[i]) / (a[i + 1] - a[i]), 0.0, 1.0)
    v = np.clip((y - b[k]) / (b[k + 1] - b[k]), 0.0, 1.0)
    low = table[i, k] * (1.0 - u) + table[i + 1, k] * u
    high = table[i, k + 1] * (1.0 - u) + table[i + 1, k + 1] * u
    return np.asarray(low * (1.0 - v) + high * v)
