"""Small compiled pieces that the virtual car's loops share: interpolation and the engine's fuel."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from app.science.arrays import FloatArray
from app.science.jit import kernel


class FuelNumbers(NamedTuple):
    """The engine's fuel power as plain arrays: φ's coefficients, or a table where its axes are not empty."""

    phi: FloatArray
    table_radps: FloatArray
    table_nm: FloatArray
    table_w: FloatArray
    idle_w: float


@kernel
def sampled(x: float, step: float, values: FloatArray) -> float:
    """Value at ``x`` of an array sampled at 0, ``step``, 2 ``step``, …: linear, held at the ends."""
    position = x / step
    if position <= 0.0:
        return float(values[0])
    i = int(position)
    if i >= len(values) - 1:
        return float(values[-1])
    return float(values[i] + (position - i) * (values[i + 1] - values[i]))


@kernel
def curve(x: float, xs: FloatArray, ys: FloatArray) -> float:
    """Value at ``x`` of a short curve: linear between its points, held at the ends."""
    if x <= xs[0]:
        return float(ys[0])
    for i in range(1, len(xs)):
        if x <= xs[i]:
            return float(ys[i - 1] + (ys[i] - ys[i - 1]) * (x - xs[i - 1]) / (xs[i] - xs[i - 1]))
    return float(ys[-1])


@kernel
def fuel_power(omega: float, torque: float, fuel: FuelNumbers) -> float:
    """Fuel power at an engine speed (rad/s) and torque (Nm), W, never below idle.

    ω T φ(ω, T), or the table: bilinear, extended linearly below its lowest torque, held at its other edges.
    """
    if torque <= 0.0:
        return float(fuel.idle_w)
    if len(fuel.table_radps) == 0:
        c = fuel.phi
        phi = c[0] + c[1] * omega + c[2] * torque + c[3] * omega * torque + c[4] * omega**2 + c[5] * torque**2
        return float(max(fuel.idle_w, omega * torque * phi))
    i = 0
    while i < len(fuel.table_radps) - 2 and omega > fuel.table_radps[i + 1]:
        i += 1
    j = 0
    while j < len(fuel.table_nm) - 2 and torque > fuel.table_nm[j + 1]:
        j += 1
    a = (omega - fuel.table_radps[i]) / (fuel.table_radps[i + 1] - fuel.table_radps[i])
    a = min(max(a, 0.0), 1.0)
    b = min((torque - fuel.table_nm[j]) / (fuel.table_nm[j + 1] - fuel.table_nm[j]), 1.0)
    low = fuel.table_w[i, j] + a * (fuel.table_w[i + 1, j] - fuel.table_w[i, j])
    high = fuel.table_w[i, j + 1] + a * (fuel.table_w[i + 1, j + 1] - fuel.table_w[i, j + 1])
    return float(max(fuel.idle_w, low + b * (high - low)))


@kernel
def fuel_powers(omega: FloatArray, torque: FloatArray, fuel: FuelNumbers) -> FloatArray:
    """`fuel_power` of many operating points, arrays of shape (n,)."""
    power = np.empty(len(omega))
    for i in range(len(omega)):
        power[i] = fuel_power(omega[i], torque[i], fuel)
    return power
