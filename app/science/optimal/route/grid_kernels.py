"""Dynamic programming over distance, energy and gear on nodes that differ from edge to edge.

Fuel of every step is computed once and kept; a price of a second then costs one pass of additions.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from app.science.arrays import FloatArray, IntArray
from app.science.jit import kernel
from app.science.optimal.accelerate.kernels import GEARS
from app.science.optimal.route.fuel_kernels import pull_by_power, pull_in_gear, roll
from app.science.optimal.route.stage_kernels import Car, band_n, is_neutral


class Grid(NamedTuple):
    """Stages, the speeds at their edges that are looked at, and the fuel of all steps between them.

    ``speed_mps[k, :counts[k]]`` rises. A step from node i of edge k in a column ends at the nodes from
    ``first[k, column, i]`` on; its fuel stands in ``fuel_j`` from ``start[k, column, i]`` up to the next start.
    """

    length_m: FloatArray
    speed_mps: FloatArray
    counts: IntArray
    first: IntArray
    start: IntArray
    fuel_j: FloatArray


class Pass(NamedTuple):
    """Cost to go by stage, column and node, and what to do there: the next node, the next stage's column."""

    cost: FloatArray
    next_node: IntArray
    next_column: IntArray


@kernel
def bands(speed_mps: FloatArray, count: IntArray, car: Car) -> FloatArray:
    """Return the bands of force at all nodes, shape (edges, columns, nodes, 2)."""
    edges, width = speed_mps.shape
    found = np.empty((edges, car.columns, width, 2))
    for k in range(edges):
        for column in range(car.columns):
            for i in range(count[k]):
                low, high = band_n(column, speed_mps[k, i], car)
                found[k, column, i, 0], found[k, column, i, 1] = low, high
    return found


@kernel
def steps(
    length_m: FloatArray, grade_n: FloatArray, speed_mps: FloatArray, count: IntArray, car: Car
) -> tuple[IntArray, IntArray, FloatArray]:
    """Return ``first``, ``start`` and ``fuel_j`` of a grid."""
    drive = car.drive
    n, width = len(length_m), speed_mps.shape[1]
    band = bands(speed_mps, count, car)
    first = np.zeros((n, car.columns, width), np.int64)
    start = np.zeros((n, car.columns, width + 1), np.int64)
    total = 0
    for k in range(n):
        per_n = 2.0 * length_m[k] / drive.accelerated_kg
        ends = speed_mps[k + 1, : count[k + 1]]
        for column in range(car.columns):
            for i in range(count[k]):
                start[k, column, i] = total
                v0 = speed_mps[k, i]
                against = grade_n[k] + drive.drag_kgpm * v0 * v0
                low, high = band[k, column, i, 0], band[k, column, i, 1]
                most = v0 * v0 + per_n * (high - against)
                if low <= high and most >= 0.0:
                    least = math.sqrt(max(v0 * v0 + per_n * (low - against), 0.0))
                    a = int(np.searchsorted(ends, least * (1.0 - 1e-9)))
                    b = int(np.searchsorted(ends, math.sqrt(most) * (1.0 + 1e-9) + 1e-12))
                    first[k, column, i] = a
                    total += max(b - a, 0)
            start[k, column, count[k] :] = total
    fuel = np.full(total, math.inf)
    for k in range(n):
        for column in range(car.columns):
            if is_neutral(column, car):
                roll(k, column, length_m, grade_n, speed_mps, count, first, start, band, car, fuel)
            elif drive.kind == GEARS:
                pull_in_gear(k, column, length_m, grade_n, speed_mps, count, first, start, band, car, fuel)
            else:
                pull_by_power(k, column, length_m, grade_n, speed_mps, count, first, start, band, car, fuel)
    return first, start, fuel


@kernel
def cost_to_go(grid: Grid, mu_w: float, weight: float, charge_j: float) -> Pass:
    """Return the least weight · fuel + μ · time + charges from every node to the road's end."""
    n, columns, width = grid.first.shape
    cost = np.full((n, columns, width), math.inf)
    next_node = np.zeros((n, columns, width), np.int64)
    next_column = np.zeros((n, columns, width), np.int64)
    after = np.zeros((columns, width))
    for k in range(n - 1, -1, -1):
        for column in range(columns):
            for i in range(grid.counts[k]):
                v0 = grid.speed_mps[k, i]
                hurry = 2.0 * mu_w * grid.length_m[k]
                begin, j = grid.start[k, column, i], int(grid.first[k, column, i])
                best, best_j = math.inf, 0
                for step in range(grid.start[k, column, i + 1] - begin):
                    whole = (
                        weight * grid.fuel_j[begin + step]
                        + hurry / (v0 + grid.speed_mps[k + 1, j + step])
                        + after[column, j + step]
                    )
                    if whole < best:
                        best, best_j = whole, j + step
                cost[k, column, i], next_node[k, column, i] = best, best_j
        for i in range(grid.counts[k]):
            least = 0
            for column in range(1, columns):
                if cost[k, column, i] < cost[k, least, i]:
                    least = column
            changed = cost[k, least, i] + charge_j
            for column in range(columns):
                stays = cost[k, column, i] <= changed
                after[column, i] = cost[k, column, i] if stays else changed
                if k > 0:
                    next_column[k - 1, column, i] = column if stays else least
    return Pass(cost, next_node, next_column)


@kernel
def followed(grid: Grid, found: Pass) -> tuple[IntArray, IntArray, float, float, int]:
    """Return nodes (n + 1,) and columns (n,) of the best drive, its fuel, its time and how often gears change."""
    n = len(grid.length_m)
    nodes, columns = np.zeros(n + 1, np.int64), np.zeros(n, np.int64)
    column = int(np.argmin(found.cost[0, :, 0]))
    fuel = seconds = 0.0
    changes = 0
    for k in range(n):
        i = nodes[k]
        columns[k] = column
        j = int(found.next_node[k, column, i])
        nodes[k + 1] = j
        fuel += grid.fuel_j[grid.start[k, column, i] + j - grid.first[k, column, i]]
        seconds += 2.0 * grid.length_m[k] / (grid.speed_mps[k, i] + grid.speed_mps[k + 1, j])
        if k < n - 1:
            after = int(found.next_column[k, column, j])
            changes += after != column
            column = after
    return nodes, columns, fuel, seconds, changes
