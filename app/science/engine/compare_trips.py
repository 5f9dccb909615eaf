"""Two sets of trips cell by cell: how much trips differ among themselves says what is more than chance."""

from __future__ import annotations

import itertools
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from app.science.arrays import BoolArray, FloatArray, IntArray
from app.science.engine.cells import cell_efficiency, coarsen, merge, trusted_cells
from app.science.engine.compare import POINTS_PER_LOOK, MapDifference, require_overlap
from app.science.engine.efficiency_map import CellGrid, CellSums
from app.science.engine.resolution import resolve
from app.science.engine.significance import told_apart, two_sided_chance

TRIP_SD = 0.01
"""How far the level of one trip may lie from another's by wind, load and tyres, as long as trips have not shown it."""
TRIP_SD_COUNTS = 2.0
"""That assumption weighs as much as so many trips; with many trips their own scatter decides."""
SMALLEST_SD = 1e-4


@dataclass(frozen=True, slots=True)
class TripComparison:
    """What two sets of trips say.

    Attributes
    ----------
    difference : MapDifference
    grid : CellGrid
        Cells that both sets can fill.
    trips_first, trips_second, trips_in_both : int
        Trips with points; those in both count in either.
    points_per_look : float
        Points that tell as much as one independent one, by how trips scatter in the same cell.
    trip_sd : float
        Standard deviation of the level of one trip, as a fraction.
    """

    difference: MapDifference
    grid: CellGrid
    trips_first: int
    trips_second: int
    trips_in_both: int
    points_per_look: float
    trip_sd: float


def compare_trips(
    trips: Sequence[CellSums], in_first: BoolArray, in_second: BoolArray, grid: CellGrid
) -> TripComparison:
    """Compare the maps of two sets of trips where both are trusted.

    Each cell's difference is a weighted sum over trips, so what a trip that is in both sets adds to either map
    cancels as far as it should. A trip's mean in a cell errs by its points' scatter, `TripComparison.points_per_look`
    of which are one look, and by the trip's level as a whole, `TripComparison.trip_sd`. Both are estimated from how
    trips of the same set differ, leaning on `POINTS_PER_LOOK` and `TRIP_SD` where there are few. The level is that of
    the work which the fuel of all these trips would do.

    Parameters
    ----------
    trips : sequence of CellSums
        Over the cells of ``grid``.
    in_first, in_second : bool array, shape (len(trips),)
    grid : CellGrid

    Raises
    ------
    ScienceError
        When too few cells are trusted in both.
    """
    chosen = (in_first, in_second)
    whole = [merge(itertools.compress(trips, inside)) for inside in chosen]
    wider = max((resolve(sums, grid).grid for sums in whole), key=lambda g: g.rpm * g.nm)
    if wider != grid:
        factors = round(wider.rpm / grid.rpm), round(wider.nm / grid.nm)
        trips, whole = [coarsen(sums, *factors) for sums in trips], [coarsen(sums, *factors) for sums in whole]
    rows = _Rows.of(trips)
    sides = [_Side.of(sums, rows, inside, wider) for sums, inside in zip(whole, chosen, strict=True)]
    common = sides[0].trusted & sides[1].trusted
    require_overlap(int(common.sum()))
    own = np.where(in_first[:, np.newaxis], sides[0].efficiency, sides[1].efficiency)
    spread = np.maximum(np.sqrt(_pooled(*sides)), SMALLEST_SD)
    looks = 1.0 if wider.independent else _points_per_look(rows, own, spread, in_first, in_second)
    trip_sd, freedom = _trip_sd(rows, own, in_first, in_second)
    gain = (sides[1].share - sides[0].share)[:, common]
    single = np.where(gain != 0.0, spread[common] ** 2 * looks / np.maximum(rows.n[:, common], 1.0), 0.0)
    before, after = (side.efficiency[common] for side in sides)
    chance_variance = np.maximum(np.sum(gain**2 * single, axis=0), SMALLEST_SD**2)
    trip_variance = (trip_sd * before) ** 2 * np.sum(gain**2, axis=0)
    variance = chance_variance + trip_variance
    freedoms = freedom * (variance / np.maximum(trip_variance, 1e-9 * variance)) ** 2
    driven = rows.fuel[:, common].sum(axis=0)
    work = float(driven @ before)
    by_chance, by_trips = driven**2 @ chance_variance, np.sum((gain @ (driven * before)) ** 2)
    difference, sd = after - before, np.sqrt(variance)
    return TripComparison(
        difference=MapDifference(
            rpm=wider.centre_rpm(rows.i[common]),
            nm=wider.centre_nm(rows.j[common]),
            first=before,
            second=after,
            difference=difference,
            sd=sd,
            significant=told_apart(two_sided_chance(difference / sd, freedoms)),
            level=float(driven @ after) / work,
            level_sd=float(np.sqrt(by_chance + trip_sd**2 * by_trips)) / work,
            only_first=int((sides[0].trusted & ~sides[1].trusted).sum()),
            only_second=int((sides[1].trusted & ~sides[0].trusted).sum()),
        ),
        grid=wider,
        trips_first=int(in_first.sum()),
        trips_second=int(in_second.sum()),
        trips_in_both=int((in_first & in_second).sum()),
        points_per_look=looks,
        trip_sd=trip_sd,
    )


@dataclass(frozen=True, slots=True)
class _Rows:
    """Sums by trip and cell, shape (trips, cells), and the cells' indices."""

    i: IntArray
    j: IntArray
    n: FloatArray
    work: FloatArray
    fuel: FloatArray

    @classmethod
    def of(cls, parts: Sequence[CellSums]) -> _Rows:
        every = merge(parts)
        height = int(every.j.max(initial=0)) + 1
        cells = every.i * height + every.j
        tables = np.zeros((3, len(parts), len(cells)))
        for trip, sums in enumerate(parts):
            at = np.searchsorted(cells, sums.i * height + sums.j)
            tables[:, trip, at] = sums.n, sums.power_sum_w, sums.fuel_power_sum_w
        return cls(every.i, every.j, *tables)


@dataclass(frozen=True, slots=True)
class _Side:
    """One set of trips over the cells of all.

    ``share`` is each trip's part of a cell's fuel, shape (trips, cells); ``squares`` and ``freedom`` are of the points'
    scatter, shape (cells,).
    """

    trusted: BoolArray
    efficiency: FloatArray
    share: FloatArray
    squares: FloatArray
    freedom: FloatArray

    @classmethod
    def of(cls, sums: CellSums, rows: _Rows, inside: BoolArray, grid: CellGrid) -> _Side:
        height = int(rows.j.max(initial=0)) + 1
        at = np.searchsorted(rows.i * height + rows.j, sums.i * height + sums.j)
        trusted = np.zeros(len(rows.i), np.bool_)
        trusted[at] = trusted_cells(sums, grid)
        efficiency, squares, freedom = np.full(len(rows.i), np.nan), np.zeros(len(rows.i)), np.zeros(len(rows.i))
        efficiency[at] = cell_efficiency(sums)
        squares[at] = np.maximum(sums.efficiency_squared_sum - sums.efficiency_sum**2 / sums.n, 0.0)
        freedom[at] = sums.n - 1.0
        fuel = np.where(inside[:, np.newaxis], rows.fuel, 0.0)
        share = fuel / np.maximum(fuel.sum(axis=0), 1e-9)
        return cls(trusted, efficiency, share, squares, freedom)


def _pooled(first: _Side, second: _Side) -> FloatArray:
    """Return the variance of single points in each cell around their own side's mean; the median where few tell."""
    freedom = first.freedom + second.freedom
    variance = (first.squares + second.squares) / np.maximum(freedom, 1.0)
    known = freedom >= 1.0
    return np.where(known, variance, np.median(variance[known]) if known.any() else SMALLEST_SD**2)


def _points_per_look(
    rows: _Rows, own: FloatArray, spread: FloatArray, in_first: BoolArray, in_second: BoolArray
) -> float:
    """Ask how much more trips scatter around their cell's mean than single points let expect; never less than usual.

    In the mean trips scatter less, but a trip that passes a cell in a transient lies far off: with the mean alone one
    cell in a hundred would be called changed between trips of the same car.
    """
    squares, freedom = 0.0, 1.0
    for side in (in_first, in_second & ~in_first):
        n = rows.n[side]
        several = np.count_nonzero(n, axis=0) >= 2
        mean = np.divide(rows.work[side], rows.fuel[side], out=np.zeros_like(n), where=n > 0.0)
        off = np.where(n > 0.0, mean - own[side], 0.0)[:, several] / spread[several]
        squares += float(np.sum(n[:, several] * off**2))
        freedom += float(np.sum(np.count_nonzero(n[:, several], axis=0) - 1))
    return max(squares / freedom, POINTS_PER_LOOK)


def _trip_sd(rows: _Rows, own: FloatArray, in_first: BoolArray, in_second: BoolArray) -> tuple[float, float]:
    """Return how far trips' levels scatter around their set's, as a fraction, and the degrees of freedom of that.

    Each trip pulls the mean of its cells towards itself, which leaves less of the scatter to be seen.
    """
    variance, freedom = TRIP_SD_COUNTS * TRIP_SD**2, TRIP_SD_COUNTS
    for side in (in_first, in_second & ~in_first):
        fuel = rows.fuel[side]
        several = np.count_nonzero(fuel, axis=0) >= 2
        expected = np.sum(fuel[:, several] * own[side][:, several], axis=1)
        known = expected > 0.0
        if np.count_nonzero(known) < 2:
            continue
        fuel, expected = fuel[known][:, several], expected[known]
        level = rows.work[side][known][:, several].sum(axis=1) / expected - 1.0
        pull = np.einsum("kc,lc->kl", fuel / fuel.sum(axis=1, keepdims=True), fuel / fuel.sum(axis=0))
        left = np.sum((np.eye(len(pull)) - pull) ** 2, axis=1)
        counts = float(len(level) - 1)
        variance += counts * float(expected @ level**2) / float(expected @ left)
        freedom += counts
    return float(np.sqrt(variance / freedom)), freedom
