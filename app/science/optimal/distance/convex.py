"""The same problem as a convex programme over distance: another method, and none of ours can be far below it.

With w = v² the resistance is linear in w, so the road's equation is linear: w' = 2 (f − r₀ − r₂ w)/M_a. Fuel for a
metre is F(f v)/v, convex in force f and slowness 1/v once F is replaced by its convex hull, which is what two controls
in turn reach; and slowness is convex in w. Every local optimum is the global one. It is solved as linear programmes
with ever more tangents, on cells that are short at both ends of the road.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.optimize import linprog
from scipy.sparse import coo_array

from app.science.arrays import FloatArray
from app.science.optimal.problem import RoadLoad

GROWTH, FIRST_M, CELLS = 1.25, 0.05, 70
ROUNDS = 6
SLOWEST_W = 1e-3


@dataclass(frozen=True, slots=True)
class Lines:
    """Fuel power from below: F ≥ slope · P + level for each of n lines, for powers in between two.

    Attributes
    ----------
    slope, level_w : array, shape (n,)
    power_w, force_n : (lowest, highest)
    """

    slope: FloatArray
    level_w: FloatArray
    power_w: tuple[float, float]
    force_n: tuple[float, float]


def least_fuel_j(load: RoadLoad, lines: Lines, from_mps: float, distance_m: float) -> float | None:
    """Return the optimum of the convex programme, J; None where its solver gives up."""
    h = _cells(distance_m)
    n = len(h)
    # unknowns: w at n ends of cells, then force, slowness and fuel for a metre in each cell
    slow_tangents = [np.full(n + 1, u) for u in np.geomspace(0.5, 60.0, 24) ** 2]
    equal, right = _road(load, h, from_mps)
    top = 2.0 * max(from_mps, 60.0) ** 2
    bounds = [(SLOWEST_W, top)] * n + [lines.force_n] * n + [(0.0, 2.0 / SLOWEST_W**0.5)] * n + [(0.0, None)] * n
    price = np.concatenate((np.zeros(3 * n), h))
    found = None
    for _ in range(ROUNDS):
        matrix, limit = _inequalities(lines, n, slow_tangents, from_mps)
        found = linprog(price, matrix, limit, equal, right, bounds, method="highs")
        if found.status != 0:
            return None
        slow_tangents.append(np.maximum(np.concatenate(([from_mps**2], found.x[:n])), SLOWEST_W))
    return None if found is None else float(found.fun)


def _cells(distance_m: float) -> FloatArray:
    """Return the lengths of cells: short at both ends, no longer than a share of the road in between."""
    longest = distance_m / CELLS
    ramp = [min(FIRST_M, longest)]
    while ramp[-1] * GROWTH < longest and sum(ramp) < 0.25 * distance_m:
        ramp.append(ramp[-1] * GROWTH)
    rest = distance_m - 2.0 * sum(ramp)
    count = max(int(np.ceil(rest / longest)), 1)
    return np.concatenate((ramp, np.full(count, rest / count), ramp[::-1]))


def _road(load: RoadLoad, h: FloatArray, from_mps: float) -> tuple[coo_array, FloatArray]:
    """Return w_{k+1} − w_k = 2 h/M_a (f − r₀ − r₂ (w_k + w_{k+1})/2) as equations."""
    n, k = len(h), np.arange(len(h))
    gain = 2.0 * h / load.accelerated_mass_kg
    drag = 0.5 * gain * load.drag_kgpm
    rows = np.concatenate((k, k[1:], k))
    columns = np.concatenate((k, k[:-1], n + k))
    values = np.concatenate((1.0 + drag, -1.0 + drag[1:], -gain))
    right = -gain * load.rolling_n
    right[0] += from_mps**2 * (1.0 - drag[0])
    return coo_array((values, (rows, columns)), shape=(n, 4 * n)), right


def _inequalities(lines: Lines, n: int, tangents: list[FloatArray], from_mps: float) -> tuple[coo_array, FloatArray]:
    """Return fuel above every line, power inside its limits, and slowness above its tangents."""
    k = np.arange(n)
    rows, columns, values, limit = [], [], [], []
    count = 0

    def add(parts: list[tuple[FloatArray | float, int]], right: FloatArray, shift: FloatArray | None = None) -> None:
        nonlocal count
        for value, block in parts:
            rows.append(count + k)
            columns.append(block * n + k)
            values.append(np.broadcast_to(value, (n,)))
        if shift is not None:
            rows.append(count + k[1:])
            columns.append(k[:-1])
            values.append(shift[1:])
        limit.append(right)
        count += n

    for slope, level in zip(lines.slope, lines.level_w, strict=True):
        add([(slope, 1), (level, 2), (-1.0, 3)], np.zeros(n))
    add([(1.0, 1), (-lines.power_w[1], 2)], np.zeros(n))
    add([(-1.0, 1), (lines.power_w[0], 2)], np.zeros(n))
    for w in tangents:
        a, b = np.sqrt(w[:-1]), np.sqrt(w[1:])
        slowness = 2.0 / (a + b)
        by_a, by_b = -(slowness**2) / (4.0 * a), -(slowness**2) / (4.0 * b)
        right = by_a * w[:-1] + by_b * w[1:] - slowness
        right[0] -= by_a[0] * from_mps**2
        add([(by_b, 0), (-1.0, 2)], right, by_a)
    shape = (count, 4 * n)
    every = coo_array((np.concatenate(values), (np.concatenate(rows), np.concatenate(columns))), shape=shape)
    return every, np.concatenate(limit)
