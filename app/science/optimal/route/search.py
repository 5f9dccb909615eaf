"""From a coarse grid to fine ones around the best drive, with the price of a second that uses the time there is."""

from __future__ import annotations

from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass, replace

import numpy as np

from app.science.arrays import BoolArray, FloatArray, IntArray
from app.science.optimal.route.grid_kernels import Grid, Price, cost_to_go, followed, steps
from app.science.optimal.route.stage_kernels import Car
from app.science.optimal.route.stages import Stages

CHEAPER = (0.99, 0.95, 0.8, 0.5, 0.0)
DEARER = (1.01, 1.05, 1.25, 2.0, 8.0, 64.0, 1e4)
"""Of a guess: prices of a second that are tried one after the other."""
ROUNDS = 40
SAME = 1e-7
AS_FAST = 1e-9


@dataclass(frozen=True, slots=True)
class Way:
    """A drive through a grid.

    Attributes
    ----------
    speed_mps : array, shape (n + 1,)
    column : int array, shape (n,)
    stage_fuel_j : array, shape (n,)
    time_s, charged_j : float
    mu_w : float
        Price of a second it is best for.
    """

    speed_mps: FloatArray
    column: IntArray
    stage_fuel_j: FloatArray
    time_s: float
    charged_j: float
    mu_w: float

    @property
    def fuel_j(self) -> float:
        """Return the fuel, J."""
        return float(self.stage_fuel_j.sum())

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
    """A grid with its fuel, ready to be asked for any price of a second.

    Attributes
    ----------
    grid : Grid
    car : Car
    charge_j : float
        For a change of gear.
    between : bool
        Whether steps may end between nodes.
    """

    grid: Grid
    car: Car
    charge_j: float
    between: bool

    def at(self, mu_w: float, weight: float = 1.0) -> Way | None:
        """Return the best drive for a price of a second; None where no drive leads through the grid."""
        price = Price(mu_w, weight, self.charge_j, self.between)
        cost = cost_to_go(self.grid, price, self.car)
        speeds, columns, fuel = followed(self.grid, cost, price, self.car)
        if not np.isfinite(fuel).all():
            return None
        seconds = float((2.0 * self.grid.length_m / (speeds[1:] + speeds[:-1])).sum())
        changes = int(np.count_nonzero(np.diff(columns)))
        return Way(speeds, columns, fuel, seconds, changes * self.charge_j, mu_w)


def gridded(stages: Stages, nodes: list[FloatArray], car: Car, charge_j: float, *, between: bool) -> Search:
    """Return a search through nodes of speed at each edge."""
    counts = np.array([len(one) for one in nodes])
    speeds = np.full((len(nodes), counts.max()), np.nan)
    for k, one in enumerate(nodes):
        speeds[k, : len(one)] = one
    first, start, fuel = _all_steps(stages, speeds, counts, car)
    grid = Grid(stages.length_m, stages.grade_n, speeds, counts, first, start, fuel)
    return Search(grid, car, charge_j, between)


def _all_steps(stages: Stages, speeds: FloatArray, counts: IntArray, car: Car) -> tuple[IntArray, IntArray, FloatArray]:
    """Return the steps of all stages, those of the first half worked out beside those of the second."""
    half = len(stages.length_m) // 2
    halves = (slice(0, half), slice(0, half + 1)), (slice(half, None), slice(half, None))
    with ThreadPoolExecutor(len(halves)) as pool:
        one, other = (
            pool.submit(steps, stages.length_m[k], stages.grade_n[k], speeds[edges], counts[edges], car)
            for k, edges in halves
        )
    (first, start, fuel), (first_on, start_on, fuel_on) = one.result(), other.result()
    return (
        np.concatenate((first, first_on)),
        np.concatenate((start, start_on + len(fuel))),
        np.concatenate((fuel, fuel_on)),
    )


def in_time(search: Search, longest_s: float | None, guess_w: float) -> Found | None:
    """Return the best drive that takes no longer than it may; None where the grid has none.

    With the price that weak duality likes best, the drive found there and one that is slower cost the same; no drive
    through the grid takes less than what lies between them at the given time.
    """
    if longest_s is None or guess_w <= 0.0:
        free = search.at(0.0)
        if free is None or longest_s is None or free.time_s <= longest_s:
            return None if free is None else Found(free, free, free.taken_j)
        guess_w = free.fuel_j / free.time_s
    ends = _bracket(search, longest_s, guess_w)
    if ends is None:
        return None
    slow, fast = ends
    if fast.taken_j <= slow.taken_j:
        return Found(fast, fast, fast.taken_j)
    for _ in range(ROUNDS):
        mu = (fast.taken_j - slow.taken_j) / (slow.time_s - fast.time_s)
        middle = search.at(mu)
        if middle is None or middle.taken_j + mu * middle.time_s >= (fast.taken_j + mu * fast.time_s) * (1.0 - SAME):
            break
        slow, fast = (slow, middle) if middle.time_s <= longest_s else (middle, fast)
    mu = (fast.taken_j - slow.taken_j) / (slow.time_s - fast.time_s)
    bound = fast.taken_j + mu * (fast.time_s - longest_s)
    return Found(replace(spliced(search, slow, fast, longest_s), mu_w=mu), replace(slow, mu_w=mu), bound)


def _bracket(search: Search, longest_s: float, guess_w: float) -> tuple[Way, Way] | None:
    """Return a drive that takes too long and one in time, for prices ever farther from a guess.

    The same drive twice where it is in time for nothing; None where none is in time.
    """
    way = search.at(guess_w)
    if way is None:
        return None
    if way.time_s <= longest_s:
        for share in CHEAPER:
            fast, way = way, search.at(share * guess_w) or way
            if way.time_s > longest_s:
                return way, fast
        return way, way
    for share in DEARER:
        slow, way = way, search.at(share * guess_w) or way
        if way.time_s <= longest_s:
            return slow, way
    fastest = search.at(1.0, 0.0)
    return None if fastest is None or fastest.time_s > longest_s * (1.0 + AS_FAST) else (way, fastest)


def spliced(search: Search, slow: Way, fast: Way, longest_s: float) -> Way:
    """Return the cheapest drive in time among the two and what they make where they meet: one first, then the other.

    Both are best for one price, so whatever they make of each other without a further change of gear is, too.
    """
    best = fast
    begin = np.append(-1, fast.column), np.append(-1, slow.column)
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
                np.concatenate((one.stage_fuel_j[:k], other.stage_fuel_j[k:])),
                float(whole[k, 1]), float(whole[k, 2]), fast.mu_w,
            )  # fmt: skip
    return best


def _sums(search: Search, way: Way) -> FloatArray:
    """Return fuel, time and charges up to each edge, shape (n + 1, 3)."""
    length = search.grid.length_m
    rows = np.zeros((len(length) + 1, 3))
    rows[1:, 0] = way.stage_fuel_j
    rows[1:, 1] = 2.0 * length / (way.speed_mps[:-1] + way.speed_mps[1:])
    rows[2:, 2] = search.charge_j * (way.column[1:] != way.column[:-1])
    return np.asarray(rows.cumsum(axis=0))
