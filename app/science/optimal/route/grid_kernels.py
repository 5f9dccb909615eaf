"""Dynamic programming over distance, energy and gear on nodes that differ from edge to edge.

Fuel of every step between nodes is computed once and kept; a price of a second then costs one pass of additions.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from app.science.arrays import BoolArray, FloatArray, IntArray
from app.science.jit import kernel
from app.science.optimal.route.stage_kernels import Car, Column, burned_j, column_of, ends

HOPE = 0.1
"""How much cheaper a step that ends beside a node may make a stage."""
LOOKS = 4
NARROWINGS = 3


class Grid(NamedTuple):
    """Stages, the speeds at their edges that are looked at, and the fuel of all steps between them.

    ``speed_mps[k, :counts[k]]`` rises. A step from node i of edge k in a column ends at the nodes from
    ``first[k, column, i]`` on; its fuel stands in ``fuel_j`` from ``start[k, column, i]`` up to the next start.
    """

    length_m: FloatArray
    grade_n: FloatArray
    speed_mps: FloatArray
    counts: IntArray
    first: IntArray
    start: IntArray
    fuel_j: FloatArray


class Price(NamedTuple):
    """Running cost weight · P_fuel + μ, and what a change of gear is charged.

    With ``between`` a step may end between nodes, where the cost to go is linear.
    """

    mu_w: float
    weight: float
    charge_j: float
    between: bool


@kernel
def steps(
    length_m: FloatArray, grade_n: FloatArray, speed_mps: FloatArray, counts: IntArray, car: Car
) -> tuple[IntArray, IntArray, FloatArray]:
    """Return ``first``, ``start`` and ``fuel_j`` of a grid."""
    n, width, columns = len(length_m), speed_mps.shape[1], len(car.columns)
    table, at_radps, nm, curve = (
        car.engine.fuel_w, car.engine.full_load_radps, car.engine.full_load_nm, car.engine.curve_w,
    )  # fmt: skip
    first = np.zeros((n, columns, width), np.int64)
    start = np.zeros((n, columns, width + 1), np.int64)
    total = 0
    for k in range(n):
        after = speed_mps[k + 1, : counts[k + 1]]
        for c in range(columns):
            way = column_of(c, car)
            for i in range(counts[k]):
                start[k, c, i] = total
                low, high = ends(way, at_radps, nm, speed_mps[k, i], length_m[k], grade_n[k], True)
                if low <= high:
                    a = int(np.searchsorted(after, low * (1.0 - 1e-9)))
                    b = int(np.searchsorted(after, high * (1.0 + 1e-9) + 1e-12))
                    first[k, c, i] = a
                    total += max(b - a, 0)
            start[k, c, counts[k] :] = total
    fuel = np.empty(total)
    for k in range(n):
        for c in range(columns):
            way = column_of(c, car)
            for i in range(counts[k]):
                v0, j = speed_mps[k, i], first[k, c, i]
                for at in range(start[k, c, i], start[k, c, i + 1]):
                    v1 = speed_mps[k + 1, j]
                    fuel[at] = burned_j(way, table, at_radps, nm, curve, v0, v1, length_m[k], grade_n[k])
                    j += 1
    return first, start, fuel


@kernel
def cost_to_go(grid: Grid, price: Price, car: Car) -> FloatArray:
    """Return the least cost from every node on when its stage is driven in a column, shape (n + 1, columns, nodes)."""
    n, columns, width = grid.first.shape
    cost = np.full((n + 1, columns, width), math.inf)
    cost[n, :, : grid.counts[n]] = 0.0
    after = np.zeros((columns, width))
    best, place = np.empty(columns), np.empty(columns, np.int64)
    speeds, fuels, first, start, counts = grid.speed_mps, grid.fuel_j, grid.first, grid.start, grid.counts
    table, at_radps, nm, curve = (
        car.engine.fuel_w, car.engine.full_load_radps, car.engine.full_load_nm, car.engine.curve_w,
    )  # fmt: skip
    for k in range(n - 1, -1, -1):
        length, grade = grid.length_m[k], grid.grade_n[k]
        hurry = 2.0 * price.mu_w * length
        for i in range(counts[k]):
            v0 = speeds[k, i]
            for c in range(columns):
                best[c], place[c] = math.inf, 0
                begin, j = start[k, c, i], int(first[k, c, i])
                for step in range(start[k, c, i + 1] - begin):
                    whole = price.weight * fuels[begin + step] + hurry / (v0 + speeds[k + 1, j + step])
                    whole += after[c, j + step]
                    if whole < best[c]:
                        best[c], place[c] = whole, step
            if price.between:
                worth = best.min() + price.charge_j
                for c in range(columns):
                    begin, j = start[k, c, i], int(first[k, c, i])
                    if best[c] > worth + HOPE * (best[c] - after[c, j + place[c]]):
                        continue
                    way = column_of(c, car)
                    for v1 in promising(k, c, i, place[c], after[c], grid, price, way, at_radps, nm):
                        cell = int(np.searchsorted(speeds[k + 1, : counts[k + 1]], v1)) - 1
                        if 0 <= cell < counts[k + 1] - 1:
                            a, b = speeds[k + 1, cell], speeds[k + 1, cell + 1]
                            share = (v1 * v1 - a * a) / (b * b - a * a)
                            whole = price.weight * burned_j(way, table, at_radps, nm, curve, v0, v1, length, grade)
                            whole += hurry / (v0 + v1) + (1.0 - share) * after[c, cell] + share * after[c, cell + 1]
                            best[c] = min(best[c], whole)
            cost[k, :, i] = best
        for i in range(counts[k]):
            changed = cost[k, :, i].min() + price.charge_j
            for c in range(columns):
                after[c, i] = min(cost[k, c, i], changed)
    return cost


@kernel
def promising(
    k: int, c: int, i: int, place: int, after: FloatArray, grid: Grid, price: Price, way: Column,
    at_radps: FloatArray, nm: FloatArray,
) -> tuple[float, float, float]:  # fmt: skip
    """Return speeds beside the best node to try: where a parabola is least, or limits that lie between nodes."""
    begin, j = grid.start[k, c, i], int(grid.first[k, c, i]) + place
    many, last = int(grid.start[k, c, i + 1] - begin), grid.counts[k + 1] - 1
    v0, length = grid.speed_mps[k, i], grid.length_m[k]
    at = grid.speed_mps[k + 1, j]
    left = right = middle = math.inf
    if place > 0:
        v1 = grid.speed_mps[k + 1, j - 1]
        left = price.weight * grid.fuel_j[begin + place - 1] + 2.0 * price.mu_w * length / (v0 + v1) + after[j - 1]
    if place < many - 1:
        v1 = grid.speed_mps[k + 1, j + 1]
        right = price.weight * grid.fuel_j[begin + place + 1] + 2.0 * price.mu_w * length / (v0 + v1) + after[j + 1]
    middle = price.weight * grid.fuel_j[begin + place] + 2.0 * price.mu_w * length / (v0 + at) + after[j]
    vertex, lower, upper = math.nan, math.nan, math.nan
    if left < math.inf and right < math.inf:
        a, b = grid.speed_mps[k + 1, j - 1], grid.speed_mps[k + 1, j + 1]
        down, up = (left - middle) / (at - a), (right - middle) / (b - at)
        if down + up > 0.0:
            vertex = at + 0.5 * (down * (b - at) - up * (at - a)) / (down + up)
        return vertex, lower, upper
    low, high = ends(way, at_radps, nm, v0, length, grid.grade_n[k], True)
    if not left < math.inf and j > 0:
        lower = max(low, grid.speed_mps[k + 1, j - 1])
        vertex = 0.5 * (lower + at)
    if not right < math.inf and j < last:
        upper = min(high, grid.speed_mps[k + 1, j + 1])
        vertex = 0.5 * (at + upper)
    return vertex, lower, upper


@kernel
def beside(
    grid: Grid, k: int, c: int, v0: float, j: int, after: FloatArray, price: Price, car: Car
) -> tuple[float, float]:
    """Return the least cost of a step that ends between a node's neighbours, and the speed there."""
    way = column_of(c, car)
    table, at_radps, nm, curve = (
        car.engine.fuel_w, car.engine.full_load_radps, car.engine.full_load_nm, car.engine.curve_w,
    )  # fmt: skip
    length, grade, speeds = grid.length_m[k], grid.grade_n[k], grid.speed_mps[k + 1]
    low, high = ends(way, at_radps, nm, v0, length, grade, True)
    best, at = math.inf, math.nan
    for cell in (j - 1, j):
        if cell < 0 or cell + 1 >= grid.counts[k + 1]:
            continue
        a, b = speeds[cell], speeds[cell + 1]
        if not abs(after[cell] + after[cell + 1]) < math.inf:
            continue
        rise = (after[cell + 1] - after[cell]) / (b * b - a * a)
        left, right = max(a, low), min(b, high)
        for _narrowing in range(NARROWINGS):
            if left > right:
                break
            step = (right - left) / LOOKS
            found = math.nan
            for look in range(LOOKS + 1):
                v1 = left + look * step
                fuel = burned_j(way, table, at_radps, nm, curve, v0, v1, length, grade)
                whole = price.weight * fuel + 2.0 * price.mu_w * length / (v0 + v1)
                whole += after[cell] + rise * (v1 * v1 - a * a)
                if whole < best:
                    best, at, found = whole, v1, v1
            if found != found:
                break
            left, right = max(left, found - step), min(right, found + step)
    return best, at


@kernel
def worth_a_look(cost: FloatArray, cell: int, spent_j: float, charge_j: float) -> BoolArray:
    """Return the columns that may be the best between two nodes, of costs of shape (columns, nodes)."""
    near = np.minimum(cost[:, cell], cost[:, min(cell + 1, cost.shape[1] - 1)])
    found: BoolArray = near <= near.min() + charge_j + HOPE * spent_j
    return found


@kernel
def followed(grid: Grid, cost: FloatArray, price: Price, car: Car) -> tuple[FloatArray, IntArray, FloatArray]:
    """Return speeds (n + 1,), columns (n,) and fuel (n,) of the best drive; NaN fuel from where none goes on.

    At each edge the best step is looked for anew, so the speed need not be a node. Between two nodes of which one goes
    on in a gear only and the other in neutral only there may be no way on: then the step before ends at a node.
    """
    n, columns, width = grid.first.shape
    table, at_radps, nm, curve = (
        car.engine.fuel_w, car.engine.full_load_radps, car.engine.full_load_nm, car.engine.curve_w,
    )  # fmt: skip
    speeds, gears, fuel = np.full(n + 1, math.nan), np.zeros(n, np.int64), np.full(n, math.nan)
    speeds[0] = grid.speed_mps[0, 0]
    after = np.zeros((columns, width))
    at_node = np.zeros(n, np.bool_)
    k = 0
    while k < n:
        v0, length, grade = speeds[k], grid.length_m[k], grid.grade_n[k]
        ahead = grid.speed_mps[k + 1, : grid.counts[k + 1]]
        for j in range(len(ahead)):
            changed = cost[k + 1, :, j].min() + (price.charge_j if k < n - 1 else 0.0)
            for c in range(columns):
                after[c, j] = min(cost[k + 1, c, j], changed)
        cell = max(int(np.searchsorted(grid.speed_mps[k, : grid.counts[k]], v0)) - 1, 0)
        spent = cost[k, :, cell].min() - after[:, : len(ahead)].min()
        looked = worth_a_look(cost[k, :, : grid.counts[k]], cell, spent, price.charge_j)
        best = math.inf
        for hard in range(2):
            if hard == 1 and best < math.inf:
                break
            for c in range(columns):
                if hard == 0 and not looked[c]:
                    continue
                way = column_of(c, car)
                charge = price.charge_j if k > 0 and c != gears[k - 1] else 0.0
                low, high = ends(way, at_radps, nm, v0, length, grade, True)
                first = int(np.searchsorted(ahead, low * (1.0 - 1e-9)))
                last = int(np.searchsorted(ahead, high * (1.0 + 1e-9) + 1e-12))
                least, place, at = math.inf, min(first, len(ahead) - 1), math.nan
                for j in range(first, last):
                    whole = price.weight * burned_j(way, table, at_radps, nm, curve, v0, ahead[j], length, grade)
                    whole += 2.0 * price.mu_w * length / (v0 + ahead[j]) + after[c, j] + charge
                    if whole < least:
                        least, place, at = whole, j, ahead[j]
                if price.between and not at_node[k]:
                    other, v1 = beside(grid, k, c, v0, place, after[c], price, car)
                    if other + charge < least:
                        least, at = other + charge, v1
                if least < best:
                    best, gears[k], speeds[k + 1] = least, c, at
        if best < math.inf:
            way = column_of(gears[k], car)
            fuel[k] = burned_j(way, table, at_radps, nm, curve, v0, speeds[k + 1], length, grade)
            k += 1
            continue
        fuel[k] = math.nan
        while k > 0 and (at_node[k - 1] or not price.between):
            k -= 1
        if k == 0:
            fuel[0] = math.nan
            break
        k -= 1
        at_node[k] = True
    return speeds, gears, fuel
