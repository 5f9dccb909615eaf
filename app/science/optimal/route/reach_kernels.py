"""Which speeds can be reached along a road: the highest and the lowest, forwards and backwards."""

from __future__ import annotations

import math

import numpy as np

from app.science.arrays import FloatArray
from app.science.jit import kernel
from app.science.optimal.route.stage_kernels import Car, Column, burned_j, column_of, ends

LOOKS = 10
HALVINGS = 40
FASTEST_MPS = 400.0


@kernel
def drives(way: Column, near: float, far: float, length_m: float, grade_n: float, ahead: bool, car: Car) -> bool:
    """Tell whether a stage can be driven from one speed to the other: ``ahead`` from near to far, else back."""
    v0, v1 = (near, far) if ahead else (far, near)
    engine = car.engine
    fuel = burned_j(
        way, engine.fuel_w, engine.full_load_radps, engine.full_load_nm, engine.curve_w, v0, v1, length_m, grade_n
    )
    return fuel < math.inf


@kernel
def farthest(v: float, length_m: float, grade_n: float, up: bool, ahead: bool, car: Car) -> float:
    """Return the highest (``up``) or lowest speed at a stage's other end; NaN where there is none.

    ``ahead`` the speed is known at the stage's begin and looked for at its end, else the other way round.
    """
    best = math.nan
    for c in range(len(car.columns)):
        way = column_of(c, car)
        low, high = ends(way, car.engine.full_load_radps, car.engine.full_load_nm, v, length_m, grade_n, ahead)
        if low > high:
            continue
        high = min(high, FASTEST_MPS)
        first, last = (high, low) if up else (low, high)
        if best == best and (first <= best) == up:
            continue
        outside, found = first, math.nan
        for look in range(LOOKS + 1):
            other = first + (last - first) * look / LOOKS
            if drives(way, v, other, length_m, grade_n, ahead, car):
                found = other
                break
            outside = other
        if found != found:
            continue
        if found != first:
            for _ in range(HALVINGS):
                middle = 0.5 * (outside + found)
                if drives(way, v, middle, length_m, grade_n, ahead, car):
                    found = middle
                else:
                    outside = middle
        if best != best or (found > best) == up:
            best = found
    return best


@kernel
def spread(low: float, high: float, length_m: float, grade_n: float, ahead: bool, car: Car) -> tuple[float, float]:
    """Return the lowest and highest speed at a stage's other end when any between two may be chosen at this one."""
    bottom = farthest(low, length_m, grade_n, False, ahead, car)
    top = farthest(high, length_m, grade_n, True, ahead, car)
    if bottom == bottom and top == top:
        return bottom, top
    for look in range(LOOKS + 1):
        v = low + (high - low) * look / LOOKS
        one = farthest(v, length_m, grade_n, False, ahead, car)
        other = farthest(v, length_m, grade_n, True, ahead, car)
        if one == one and (bottom != bottom or one < bottom):
            bottom = one
        if other == other and (top != top or other > top):
            top = other
    return bottom, top


@kernel
def forwards(
    start: float, length_m: FloatArray, grade_n: FloatArray, cap_mps: FloatArray, floor_mps: FloatArray, car: Car
) -> FloatArray:
    """Return lowest and highest speeds at the edges that the start leads to, shape (n + 1, 2).

    They lie between a floor and a cap for each edge; where none does, the first one is NaN and the second says what
    would be reached, and those after are NaN.
    """
    n = len(length_m)
    found = np.full((n + 1, 2), math.nan)
    found[0] = start
    for k in range(n):
        low, high = spread(found[k, 0], found[k, 1], length_m[k], grade_n[k], True, car)
        if not (low <= cap_mps[k + 1] and high >= floor_mps[k + 1]):
            found[k + 1, 1] = low if low > cap_mps[k + 1] else high
            break
        found[k + 1, 0], found[k + 1, 1] = max(low, floor_mps[k + 1]), min(high, cap_mps[k + 1])
    return found


@kernel
def backwards(end: float, length_m: FloatArray, grade_n: FloatArray, bounds_mps: FloatArray, car: Car) -> FloatArray:
    """Return lowest and highest speeds within bounds from which the end is reached, shape (n + 1, 2); NaN where none.

    ``bounds_mps`` are the speeds that the start leads to.
    """
    n = len(length_m)
    found = np.full((n + 1, 2), math.nan)
    found[n] = end
    for k in range(n - 1, -1, -1):
        low, high = spread(found[k + 1, 0], found[k + 1, 1], length_m[k], grade_n[k], False, car)
        low, high = max(low, bounds_mps[k, 0]), min(high, bounds_mps[k, 1])
        if not low <= high:
            break
        found[k, 0], found[k, 1] = low, high
    return found
