"""One stage of a road: whether the car can drive it with a steady acceleration between two speeds, and what it burns.

Over a stage of steady slope the force at the wheels is M_a v̇ + M g (sin θ + C_rr cos θ) + ½ρC_dA v², so with a steady v̇
motion and time are exact, and fuel is an integral over time, taken by two Gaussian nodes.
"""

from __future__ import annotations

import math
from typing import NamedTuple

from app.science.arrays import FloatArray
from app.science.jit import kernel

GEAR, CVT, WILLANS, NEUTRAL = 0, 1, 2, 3
GAUSS = 0.5773502691896258
"""Nodes of two, each of half the weight."""
SLACK = 1e-9


class Column(NamedTuple):
    """One way to go: a gear, a CVT, a Willans drive, or neutral; and the car's mass and drag.

    ``least_w`` to ``most_n`` limit a CVT or a Willans drive; ``cheapest_w`` is the power at which a CVT burns least.
    """

    mode: float
    spd_1pm: float
    lowest_radps: float
    highest_radps: float
    lowest_nm: float
    highest_nm: float
    least_w: float
    most_w: float
    least_n: float
    most_n: float
    c0: float
    c1: float
    c2: float
    step_w: float
    cheapest_w: float
    idle_w: float
    brake_n: float
    accelerated_kg: float
    drag_kgpm: float


class Engine(NamedTuple):
    """``fuel_w[i, j]`` belongs to ωⁱ Tʲ; full load over rad/s; a CVT's least fuel power on even nodes of power."""

    fuel_w: FloatArray
    full_load_radps: FloatArray
    full_load_nm: FloatArray
    curve_w: FloatArray


class Car(NamedTuple):
    """A car for a road; each row of ``columns`` is a `Column`: the gears, and neutral last where there is one."""

    columns: FloatArray
    engine: Engine


@kernel
def column_of(c: int, car: Car) -> Column:
    """Return a column."""
    r = car.columns[c]
    return Column(
        r[0], r[1], r[2], r[3], r[4], r[5], r[6], r[7], r[8], r[9],
        r[10], r[11], r[12], r[13], r[14], r[15], r[16], r[17], r[18],
    )  # fmt: skip


@kernel
def polynomial_w(table: FloatArray, omega: float, torque: float) -> float:
    """Return a fuel polynomial's value."""
    total = 0.0
    for i in range(table.shape[0] - 1, -1, -1):
        row = 0.0
        for j in range(table.shape[1] - 1, -1, -1):
            row = row * torque + table[i, j]
        total = total * omega + row
    return total


@kernel
def full_load_nm(at_radps: FloatArray, nm: FloatArray, omega: float, highest_nm: float) -> float:
    """Return the largest torque at an engine speed, Nm."""
    last = len(at_radps) - 1
    if last < 0:
        return highest_nm
    if omega <= at_radps[0]:
        return min(float(nm[0]), highest_nm)
    if omega >= at_radps[last]:
        return min(float(nm[last]), highest_nm)
    k = 0
    while at_radps[k + 1] < omega:
        k += 1
    rise = (nm[k + 1] - nm[k]) / (at_radps[k + 1] - at_radps[k])
    return min(float(nm[k] + rise * (omega - at_radps[k])), highest_nm)


@kernel
def band_n(way: Column, at_radps: FloatArray, nm: FloatArray, v: float) -> tuple[float, float]:
    """Return the least and the largest force at the wheels at a speed, brakes included; the least above where none."""
    if way.mode == NEUTRAL:
        return -way.brake_n, 0.0
    if way.mode == GEAR:
        omega = v * way.spd_1pm
        if omega < way.lowest_radps * (1.0 - SLACK) or omega > way.highest_radps * (1.0 + SLACK):
            return math.inf, -math.inf
        top = full_load_nm(at_radps, nm, omega, way.highest_nm)
        return way.lowest_nm * way.spd_1pm, top * way.spd_1pm
    if v <= 0.0:
        return (math.inf if way.least_w > 0.0 else way.least_n - way.brake_n), way.most_n
    return max(way.least_w / v, way.least_n) - way.brake_n, min(way.most_w / v, way.most_n)


@kernel
def inside(force_n: float, low_n: float, high_n: float) -> bool:
    """Tell whether a force lies in a band, but for rounding."""
    size = SLACK * (1.0 + abs(force_n))
    return low_n - size <= force_n <= high_n + size


@kernel
def burned_w(way: Column, table: FloatArray, curve_w: FloatArray, v: float, force_n: float) -> float:
    """Return the fuel power at a speed and a force within the band, W."""
    if way.mode == GEAR:
        return polynomial_w(table, v * way.spd_1pm, force_n / way.spd_1pm)
    if way.mode == CVT:
        power = max(force_n * v, min((force_n + way.brake_n) * v, way.cheapest_w))
        place = (power - way.least_w) / way.step_w
        cell = min(max(int(place), 0), len(curve_w) - 2)
        return float(curve_w[cell] + (place - cell) * (curve_w[cell + 1] - curve_w[cell]))
    power = max(force_n * v, way.least_w, way.least_n * v, 0.0)
    return way.c0 + (way.c1 + way.c2 * power) * power


@kernel
def burned_j(
    way: Column, table: FloatArray, at_radps: FloatArray, nm: FloatArray, curve_w: FloatArray,
    v0: float, v1: float, length_m: float, grade_n: float,
) -> float:  # fmt: skip
    """Return the fuel of a stage from one speed to another, J; infinite where it can't be driven so.

    In a gear the torque is convex over engine speed and full load straight between its corners, so it can be too high
    at an end or at a corner only.
    """
    if v0 + v1 <= 0.0:
        return math.inf
    against = 0.5 * way.accelerated_kg * (v1 * v1 - v0 * v0) / length_m + grade_n
    for v in (v0, v1):
        low, high = band_n(way, at_radps, nm, v)
        if not inside(against + way.drag_kgpm * v * v, low, high):
            return math.inf
    if way.mode == NEUTRAL:
        return way.idle_w * 2.0 * length_m / (v0 + v1)
    if way.mode == GEAR:
        slow, fast = min(v0, v1) * way.spd_1pm, max(v0, v1) * way.spd_1pm
        for k in range(len(at_radps)):
            if slow < at_radps[k] < fast:
                v = at_radps[k] / way.spd_1pm
                top = min(float(nm[k]), way.highest_nm) * way.spd_1pm
                if not inside(against + way.drag_kgpm * v * v, -math.inf, top):
                    return math.inf
    total = 0.0
    for side in (-GAUSS, GAUSS):
        v = 0.5 * (v0 + v1) + 0.5 * side * (v1 - v0)
        force = against + way.drag_kgpm * v * v
        if way.mode != GEAR:
            low, high = band_n(way, at_radps, nm, v)
            if not inside(force, low, high):
                return math.inf
        total += burned_w(way, table, curve_w, v, force)
    return total * length_m / (v0 + v1)


@kernel
def ends(
    way: Column, at_radps: FloatArray, nm: FloatArray, v: float, length_m: float, grade_n: float, ahead: bool
) -> tuple[float, float]:
    """Return the lowest and highest speed at a stage's other end that forces at this one allow; the first above: none.

    ``ahead`` this end is the begin, else the other way round.
    """
    low_n, high_n = band_n(way, at_radps, nm, v)
    if low_n > high_n:
        return math.inf, -math.inf
    per_n = 2.0 * length_m / way.accelerated_kg
    against = grade_n + way.drag_kgpm * v * v
    least, most = (low_n - against) * per_n, (high_n - against) * per_n
    if not ahead:
        least, most = -most, -least
    if v * v + most < 0.0:
        return math.inf, -math.inf
    return math.sqrt(max(v * v + least, 0.0)), math.sqrt(v * v + most)
