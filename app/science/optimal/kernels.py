"""The engine as compiled code takes it: fuel power and the torque it can give."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from app.science.arrays import FloatArray
from app.science.jit import kernel
from app.science.optimal.problem import RADPS_PER_RPM, PolynomialEngine

Polynomial = tuple[float, float, float, float, float, float]
"""Coefficients of powers 0 to 5."""


class EngineNumbers(NamedTuple):
    """A polynomial engine; ``fuel_w[i, j]`` belongs to ωⁱ Tʲ, speeds are in rad/s."""

    fuel_w: FloatArray
    lowest_radps: float
    highest_radps: float
    lowest_nm: float
    highest_nm: float
    full_load_radps: FloatArray
    full_load_nm: FloatArray
    idle_w: float


def engine_numbers(engine: PolynomialEngine) -> EngineNumbers:
    """Return the engine as compiled code takes it."""
    line = np.array(engine.full_load, dtype=np.float64).reshape(-1, 2)
    table = np.zeros((max(i for i, _ in engine.terms) + 1, 6))
    for (i, j), c in zip(engine.terms, engine.coefficients, strict=True):
        table[i, j] += c
    return EngineNumbers(
        table,
        engine.speed_rpm[0] * RADPS_PER_RPM,
        engine.speed_rpm[1] * RADPS_PER_RPM,
        float(engine.torque_nm[0]),
        float(engine.torque_nm[1]),
        np.ascontiguousarray(line[:, 0]) * RADPS_PER_RPM,
        np.ascontiguousarray(line[:, 1]),
        float(engine.idle_fuel_power_w),
    )


@kernel
def over_torque(omega: float, engine: EngineNumbers) -> Polynomial:
    """Return fuel power at an engine speed as a polynomial in torque."""
    table = engine.fuel_w
    c0 = c1 = c2 = c3 = c4 = c5 = 0.0
    for i in range(table.shape[0] - 1, -1, -1):
        c0 = c0 * omega + table[i, 0]
        c1 = c1 * omega + table[i, 1]
        c2 = c2 * omega + table[i, 2]
        c3 = c3 * omega + table[i, 3]
        c4 = c4 * omega + table[i, 4]
        c5 = c5 * omega + table[i, 5]
    return c0, c1, c2, c3, c4, c5


@kernel
def value(p: Polynomial, x: float) -> float:
    """Return a polynomial's value."""
    return ((((p[5] * x + p[4]) * x + p[3]) * x + p[2]) * x + p[1]) * x + p[0]


@kernel
def slope(p: Polynomial, x: float) -> float:
    """Return a polynomial's derivative."""
    return (((5.0 * p[5] * x + 4.0 * p[4]) * x + 3.0 * p[3]) * x + 2.0 * p[2]) * x + p[1]


@kernel
def fuel_power_w(omega: float, torque: float, engine: EngineNumbers) -> float:
    """Return fuel power, W."""
    return value(over_torque(omega, engine), torque)


@kernel
def fuel_over_speed(omega: float, torque: float, engine: EngineNumbers) -> float:
    """Return the derivative of fuel power by engine speed, W s/rad."""
    table = engine.fuel_w
    total = 0.0
    for i in range(table.shape[0] - 1, 0, -1):
        row = 0.0
        for j in range(5, -1, -1):
            row = row * torque + table[i, j]
        total = total * omega + i * row
    return total


@kernel
def full_load(omega: float, engine: EngineNumbers) -> tuple[float, float]:
    """Return the largest torque at an engine speed, Nm, and its slope; NaN outside the engine's speeds."""
    slack = 1e-12 * engine.highest_radps
    if omega < engine.lowest_radps - slack or omega > engine.highest_radps + slack:
        return math.nan, 0.0
    at, nm = engine.full_load_radps, engine.full_load_nm
    last = len(at) - 1
    if last < 0:
        return engine.highest_nm, 0.0
    if omega <= at[0]:
        return min(nm[0], engine.highest_nm), 0.0
    if omega >= at[last]:
        return min(nm[last], engine.highest_nm), 0.0
    k = 0
    while at[k + 1] < omega:
        k += 1
    rise = (nm[k + 1] - nm[k]) / (at[k + 1] - at[k])
    torque = nm[k] + rise * (omega - at[k])
    if torque >= engine.highest_nm:
        return engine.highest_nm, 0.0
    return torque, rise
