"""The fuel of all steps from one stage's nodes in one way to go.

The inner loops see plain numbers and arrays only: handing the whole car to a function for each of millions of steps
costs ten times what the step does. Fuel power is integrated over a stage by three Gaussian nodes in time.
"""

from __future__ import annotations

import math

from app.science.arrays import FloatArray, IntArray
from app.science.jit import kernel
from app.science.optimal.accelerate.kernels import CVT
from app.science.optimal.route.stage_kernels import Car, inside

GAUSS = 0.7745966692414834
"""Outer node of three; the weights are 5, 8 and 5 eighteenths."""


@kernel
def polynomial_w(table: FloatArray, omega: float, torque: float) -> float:
    """Return a fuel polynomial's value."""
    total = 0.0
    for i in range(table.shape[0] - 1, -1, -1):
        row = 0.0
        for j in range(5, -1, -1):
            row = row * torque + table[i, j]
        total = total * omega + row
    return total


@kernel
def roll(
    k: int, column: int, length_m: FloatArray, grade_n: FloatArray, speed_mps: FloatArray, count: IntArray,
    first: IntArray, start: IntArray, band: FloatArray, car: Car, fuel_j: FloatArray,
) -> None:  # fmt: skip
    """Fill in the fuel of a stage in neutral."""
    drag, idle_w, brake_n = car.drive.drag_kgpm, car.drive.idle_w, car.drive.brake_n
    per_m = 0.5 * car.drive.accelerated_kg / length_m[k]
    for i in range(count[k]):
        v0, j = speed_mps[k, i], first[k, column, i]
        for at in range(start[k, column, i], start[k, column, i + 1]):
            v1 = speed_mps[k + 1, j]
            against = per_m * (v1 * v1 - v0 * v0) + grade_n[k]
            able = inside(against + drag * v0 * v0, -brake_n, 0.0) and inside(against + drag * v1 * v1, -brake_n, 0.0)
            if able and v0 + v1 > 0.0:
                fuel_j[at] = idle_w * 2.0 * length_m[k] / (v0 + v1)
            j += 1


@kernel
def pull_in_gear(
    k: int, column: int, length_m: FloatArray, grade_n: FloatArray, speed_mps: FloatArray, count: IntArray,
    first: IntArray, start: IntArray, band: FloatArray, car: Car, fuel_j: FloatArray,
) -> None:  # fmt: skip
    """Fill in the fuel of a stage in a gear."""
    drag, spd, table = car.drive.drag_kgpm, car.drive.spd_1pm[column], car.drive.engine.fuel_w
    corner_mps = car.drive.engine.full_load_radps / spd
    corner_nm, highest_nm = car.drive.engine.full_load_nm, car.drive.engine.highest_nm
    per_m = 0.5 * car.drive.accelerated_kg / length_m[k]
    for i in range(count[k]):
        v0, j = speed_mps[k, i], first[k, column, i]
        low, high = band[k, column, i, 0], band[k, column, i, 1]
        for at in range(start[k, column, i], start[k, column, i + 1]):
            v1 = speed_mps[k + 1, j]
            against = per_m * (v1 * v1 - v0 * v0) + grade_n[k]
            able = inside(against + drag * v0 * v0, low, high)
            able = able and inside(against + drag * v1 * v1, band[k + 1, column, j, 0], band[k + 1, column, j, 1])
            for c in range(len(corner_mps)):
                v = corner_mps[c]
                if min(v0, v1) < v < max(v0, v1):
                    top = min(corner_nm[c], highest_nm) * spd
                    able = able and inside(against + drag * v * v, -math.inf, top)
            if able:
                total = 0.0
                for node in range(3):
                    v = 0.5 * (v0 + v1) + 0.5 * (node - 1) * GAUSS * (v1 - v0)
                    power = polynomial_w(table, v * spd, (against + drag * v * v) / spd)
                    total += (8.0 if node == 1 else 5.0) * power
                fuel_j[at] = total / 9.0 * length_m[k] / (v0 + v1)
            j += 1


@kernel
def pull_by_power(
    k: int, column: int, length_m: FloatArray, grade_n: FloatArray, speed_mps: FloatArray, count: IntArray,
    first: IntArray, start: IntArray, band: FloatArray, car: Car, fuel_j: FloatArray,
) -> None:  # fmt: skip
    """Fill in the fuel of a stage with a CVT or a Willans drive, whose limits are those of power and force."""
    drag, brake_n, cvt = car.drive.drag_kgpm, car.drive.brake_n, car.drive.kind == CVT
    c0, c1, c2 = car.drive.willans[0], car.drive.willans[1], car.drive.willans[2]
    least_w, most_w, least_n, most_n = (
        car.drive.power_w[0],
        car.drive.power_w[1],
        car.drive.force_n[0],
        car.drive.force_n[1],
    )
    curve, step_w, cheapest_w = car.curve.fuel_w, car.curve.step_w, car.curve.cheapest_w
    if cvt:
        least_w, most_w = car.curve.lowest_w, car.curve.lowest_w + step_w * (len(curve) - 1)
        least_n, most_n = -math.inf, math.inf
    per_m = 0.5 * car.drive.accelerated_kg / length_m[k]
    for i in range(count[k]):
        v0, j = speed_mps[k, i], first[k, column, i]
        low, high = band[k, column, i, 0], band[k, column, i, 1]
        for at in range(start[k, column, i], start[k, column, i + 1]):
            v1 = speed_mps[k + 1, j]
            against = per_m * (v1 * v1 - v0 * v0) + grade_n[k]
            able = v0 + v1 > 0.0 and inside(against + drag * v0 * v0, low, high)
            able = able and inside(against + drag * v1 * v1, band[k + 1, column, j, 0], band[k + 1, column, j, 1])
            total = 0.0
            for node in range(3):
                v = 0.5 * (v0 + v1) + 0.5 * (node - 1) * GAUSS * (v1 - v0)
                force = against + drag * v * v
                able = able and inside(force, max(least_w / v, least_n) - brake_n, min(most_w / v, most_n))
                if not able:
                    break
                if cvt:
                    power = max(force * v, min((force + brake_n) * v, cheapest_w))
                    place = (power - least_w) / step_w
                    cell = min(max(int(place), 0), len(curve) - 2)
                    burned = curve[cell] + (place - cell) * (curve[cell + 1] - curve[cell])
                else:
                    power = max(force * v, least_w, least_n * v, 0.0)
                    burned = c0 + (c1 + c2 * power) * power
                total += (8.0 if node == 1 else 5.0) * burned
            if able:
                fuel_j[at] = total / 9.0 * length_m[k] / (v0 + v1)
            j += 1
