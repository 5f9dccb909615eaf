"""One stage of a road: whether the car can drive it with a steady acceleration between two speeds.

Over a stage of steady slope the force at the wheels is M_a v̇ + M g (sin θ + C_rr cos θ) + ½ρC_dA v², so with a steady v̇
it depends on speed alone.
"""

from __future__ import annotations

import math
from typing import NamedTuple

from app.science.arrays import FloatArray
from app.science.jit import kernel
from app.science.optimal.accelerate.kernels import CVT, GEARS, DriveNumbers
from app.science.optimal.kernels import full_load

SLACK = 1e-9
LOOKS = 4


class Curve(NamedTuple):
    """Least fuel power of an engine behind a CVT on even nodes of power; the cheapest of them is where brakes help."""

    lowest_w: float
    step_w: float
    fuel_w: FloatArray
    cheapest_w: float


class Car(NamedTuple):
    """A car for a road; its ways to go are columns: the gears, and neutral last where there is one."""

    drive: DriveNumbers
    curve: Curve
    columns: int


@kernel
def is_neutral(column: int, car: Car) -> bool:
    """Tell whether a column is neutral."""
    return column >= len(car.drive.spd_1pm)


@kernel
def band_n(column: int, v: float, car: Car) -> tuple[float, float]:
    """Return the least and the largest force at the wheels at a speed, brakes included; the least above where none."""
    drive = car.drive
    if is_neutral(column, car):
        return -drive.brake_n, 0.0
    if drive.kind == GEARS:
        spd = drive.spd_1pm[column]
        top, _ = full_load(v * spd, drive.engine)
        if not top >= drive.engine.lowest_nm:
            return math.inf, -math.inf
        return drive.engine.lowest_nm * spd, top * spd
    if drive.kind == CVT:
        lowest, highest = car.curve.lowest_w, car.curve.lowest_w + car.curve.step_w * (len(car.curve.fuel_w) - 1)
        if v <= 0.0:
            return math.inf if lowest > 0.0 else -math.inf, math.inf
        return lowest / v - drive.brake_n, highest / v
    if v <= 0.0:
        return math.inf if drive.power_w[0] > 0.0 else drive.force_n[0] - drive.brake_n, drive.force_n[1]
    return max(drive.power_w[0] / v, drive.force_n[0]) - drive.brake_n, min(drive.power_w[1] / v, drive.force_n[1])


@kernel
def inside(force_n: float, low_n: float, high_n: float) -> bool:
    """Tell whether a force lies in a band, but for rounding."""
    size = SLACK * (1.0 + abs(force_n))
    return low_n - size <= force_n <= high_n + size


@kernel
def holds_between(column: int, v0: float, v1: float, against_n: float, car: Car) -> bool:
    """Tell whether bounds that hold at two speeds hold between them, too, for a force that grows with drag only.

    In a gear the torque is convex over engine speed and full load straight between its corners, so only at a corner it
    can be too high.
    """
    drive = car.drive
    slow, fast = min(v0, v1), max(v0, v1)
    if drive.kind != GEARS:
        for look in range(1, LOOKS):
            v = slow + (fast - slow) * look / LOOKS
            low, high = band_n(column, v, car)
            if not inside(against_n + drive.drag_kgpm * v * v, low, high):
                return False
        return True
    spd = drive.spd_1pm[column]
    for k in range(len(drive.engine.full_load_radps)):
        v = drive.engine.full_load_radps[k] / spd
        if slow < v < fast:
            force = against_n + drive.drag_kgpm * v * v
            if not inside(force, -math.inf, min(drive.engine.full_load_nm[k], drive.engine.highest_nm) * spd):
                return False
    return True


@kernel
def can_drive(column: int, v0: float, v1: float, length_m: float, grade_n: float, car: Car) -> bool:
    """Tell whether a stage can be driven with a steady acceleration in a column."""
    if v0 + v1 <= 0.0:
        return False
    drive = car.drive
    against = 0.5 * drive.accelerated_kg * (v1 * v1 - v0 * v0) / length_m + grade_n
    low, high = band_n(column, v0, car)
    if not inside(against + drive.drag_kgpm * v0 * v0, low, high):
        return False
    low, high = band_n(column, v1, car)
    if not inside(against + drive.drag_kgpm * v1 * v1, low, high):
        return False
    return is_neutral(column, car) or holds_between(column, v0, v1, against, car)
