"""From a coarse grid to fine ones around the best drive, with the price of a second that uses the time there is."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from app.science.arrays import BoolArray, FloatArray, IntArray
from app.science.optimal.route.grid_kernels import Grid, Pass, cost_to_go, followed, steps
from app.science.optimal.route.stage_kernels import Car
from app.science.optimal.route.stages import Stages

DEAREST_W = 1e12
ROUNDS = 40
SAME = 1e-9
AS_FAST = 1e-9


@dataclass(frozen=True, slots=True)
class Way:
    """A drive through a grid.

    Attributes
    ----------
    speed_mps : array, shape (n + 1,)
    column : int array, shape (n,)
    fuel_j, time_s, charged_j : float
    mu_w : float
        Price of a second it is best for.
    """

    speed_mps: FloatArray
    column: IntArray
    fuel_j: float
    time_s: float
    charged_j: float
    mu_w: float

    @property
    def taken_j(self) -> float:
        """Return fuel and charges."""
        return self.fuel_j + self.charged_j


@dataclass(frozen=True, slots=True)
class Found:
    """What a grid gives.

    Attributes
    ----------
    way : Way
        The cheapest drive found that is in time.
    slower : Way
        The best one for the same price that takes longer; the same one where time does not bind.
    bound_j : float
        No drive through the grid takes less fuel and charges in the time there is.
    """

    way: Way
    slower: Way
    bound_j: float


@dataclass(frozen=True, slots=True)
class Search:
    """A grid with its fuel, ready to be asked for any price of a second."""

    grid: Grid
    charge_j: float

    def passed(self, mu_w: float, weight: float = 1.0) -> Pass:
        """Return costs to go."""
        return cost_to_go(self.grid, mu_w, weight, self.charge_j)

    def at(self, mu_w: float, weight: float = 1.0) -> Way | None:
        """Return the best drive for a price of a second; None where no drive leads through the grid."""
        found = self.passed(mu_w, weight)
        if not np.isfinite(found.cost[0, :, 0]).any():
            return None
        nodes, columns, fuel, seconds, changes = followed(self.grid, found)
        speeds = self.grid.speed_mps[np.arange(len(nodes)), nodes]
        return Way(speeds, columns, fuel, seconds, changes * self.charge_j, mu_w)


def gridded(stages: Stages, nodes: list[FloatArray], car: Car, charge_j: float) -> Search:
    """Return a search through nodes of speed at each edge."""
    count = np.array([len(one) for one in nodes])
    speeds = np.full((len(nodes), count.max()), np.nan)
    for k, one in enumerate(nodes):
        speeds[k, : len(one)] = one
    first, start, fuel = steps(stages.length_m, stages.grade_n, speeds, count, car)
    return Search(Grid(stages.length_m, speeds, count, first, start, fuel), charge_j)


def in_time(search: Search, longest_s: float | None, guess_w: float) -> Found | None:
    """Return the best drive that takes no longer than it may; None where the grid has none.

    With the price that weak duality likes best, the drive found there and one that is slower cost the same; no drive
    through the grid takes less than what lies between them at the given time.
    """
    free = search.at(0.0)
    if free is None:
        return None
    if longest_s is None or free.time_s <= longest_s:
        return Found(free, free, free.taken_j)
    slow, fast = free, _hurried(search, longest_s, guess_w or free.fuel_j / free.time_s)
    if fast is None:
        return None
    for _ in range(ROUNDS):
        mu = (fast.taken_j - slow.taken_j) / (slow.time_s - fast.time_s)
        middle = search.at(mu)
        if middle is None or middle.taken_j + mu * middle.time_s >= (fast.taken_j + mu * fast.time_s) * (1.0 - SAME):
            break
        slow, fast = (slow, middle) if middle.time_s <= longest_s else (middle, fast)
    mu = (fast.taken_j - slow.taken_j) / (slow.time_s - fast.time_s)
    bound = fast.taken_j + mu * (fast.time_s - longest_s)
    return Found(_priced(spliced(search, slow, fast, longest_s), mu), _priced(slow, mu), bound)


def _hurried(search: Search, longest_s: float, guess_w: float) -> Way | None:
    """Return a drive in time, for a price that is raised until there is one; the fastest at last."""
    mu = guess_w
    while mu < DEAREST_W:
        way = search.at(mu)
        if way is not None and way.time_s <= longest_s:
            return way
        mu *= 4.0
    fastest = search.at(1.0, 0.0)
    return fastest if fastest is not None and fastest.time_s <= longest_s * (1.0 + AS_FAST) else None


def _priced(way: Way, mu_w: float) -> Way:
    return Way(way.speed_mps, way.column, way.fuel_j, way.time_s, way.charged_j, mu_w)


def spliced(search: Search, slow: Way, fast: Way, longest_s: float) -> Way:
    """Return the cheapest drive in time among the two and what they make where they meet: one first, then the other.

    Both are best for one price, so whatever they make of each other without a further change of gear is, too.
    """
    best = fast
    begin = (
        np.concatenate((fast.column[:1] * 0 - 1, fast.column)),
        np.concatenate((slow.column[:1] * 0 - 1, slow.column)),
    )
    meet: BoolArray = (fast.speed_mps == slow.speed_mps) & (begin[0] == begin[1])
    sums = {id(way): _sums(search, way) for way in (slow, fast)}
    for one, other in ((slow, fast), (fast, slow)):
        a, b = sums[id(one)], sums[id(other)]
        whole = a + (b[-1] - b)
        usable = meet & (whole[:, 1] <= longest_s)
        if not usable.any():
            continue
        k = int(np.where(usable, whole[:, 0] + whole[:, 2], np.inf).argmin())
        if whole[k, 0] + whole[k, 2] < best.taken_j:
            best = Way(
                np.concatenate((one.speed_mps[:k], other.speed_mps[k:])),
                np.concatenate((one.column[:k], other.column[k:])),
                float(whole[k, 0]), float(whole[k, 1]), float(whole[k, 2]), fast.mu_w,
            )  # fmt: skip
    return best


def _sums(search: Search, way: Way) -> FloatArray:
    """Return fuel, time and charges up to each edge, shape (n + 1, 3)."""
    grid = search.grid
    n = len(grid.length_m)
    node = np.array([np.searchsorted(grid.speed_mps[k, : grid.counts[k]], way.speed_mps[k]) for k in range(n + 1)])
    at = np.arange(n)
    row = grid.start[at, way.column, node[:-1]] + node[1:] - grid.first[at, way.column, node[:-1]]
    rows = np.zeros((n + 1, 3))
    rows[1:, 0] = grid.fuel_j[row]
    rows[1:, 1] = 2.0 * grid.length_m / (way.speed_mps[:-1] + way.speed_mps[1:])
    rows[2:, 2] = search.charge_j * (way.column[1:] != way.column[:-1])
    return np.asarray(rows.cumsum(axis=0))
