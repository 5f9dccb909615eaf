"""Sums per cell: added up over a trip's points, over trips, and read as a map."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import fields

import numpy as np

from app.science.arrays import BoolArray, FloatArray, IntArray
from app.science.engine.efficiency_map import CellGrid, CellSums, EfficiencyMap, Idle
from app.science.engine.envelope import envelope
from app.science.engine.full_load import FullLoad, lower_bound
from app.science.engine.points import OperatingPoints
from app.science.vehicle.model import Vehicle

HIGHEST_EFFICIENCY = 0.6
"""No piston engine turns more of its fuel into work; the best ship engines reach 0.55."""

TABLE_CELLS = 1_000_000
"""So many cells are looked up in a table; more, which only absurd torques give, are sorted."""
EMPTY = CellSums(
    i=np.empty(0, np.int64),
    j=np.empty(0, np.int64),
    n=np.empty(0, np.int64),
    efficiency_sum=np.empty(0),
    efficiency_squared_sum=np.empty(0),
    power_sum_w=np.empty(0),
    fuel_power_sum_w=np.empty(0),
)


def accumulate(points: OperatingPoints, grid: CellGrid) -> CellSums:
    """Sum operating points per cell.

    Parameters
    ----------
    points : OperatingPoints
    grid : CellGrid

    Returns
    -------
    CellSums
        One entry per occupied cell.
    """
    return _grouped(
        CellSums(
            i=grid.column(points.engine_speed_rpm),
            j=grid.row(points.torque_nm),
            n=np.ones(len(points), np.int64),
            efficiency_sum=points.efficiency,
            efficiency_squared_sum=points.efficiency**2,
            power_sum_w=points.power_w,
            fuel_power_sum_w=points.fuel_power_w,
        )
    )


def merge(sums: Iterable[CellSums]) -> CellSums:
    """Add the sums of several trips over the same grid, in any order.

    A trip is left out of a map by merging the others.
    """
    parts = [EMPTY, *sums]
    return _grouped(CellSums(*(np.concatenate([getattr(p, f.name) for p in parts]) for f in fields(CellSums))))


def coarsen(sums: CellSums, rpm_factor: int, nm_factor: int) -> CellSums:
    """Join ``rpm_factor`` by ``nm_factor`` cells into one; exact, because sums add up.

    Parameters
    ----------
    sums : CellSums
    rpm_factor, nm_factor : int
        At least 1. The cells of the result are that many times wider and taller.
    """
    return _grouped(
        CellSums(
            sums.i // rpm_factor,
            sums.j // nm_factor,
            sums.n,
            sums.efficiency_sum,
            sums.efficiency_squared_sum,
            sums.power_sum_w,
            sums.fuel_power_sum_w,
        )
    )


def build_map(
    sums: CellSums,
    grid: CellGrid,
    vehicle: Vehicle,
    full_load: FullLoad | None = None,
    idle: Idle | None = None,
) -> EfficiencyMap:
    """Read sums as an efficiency map (Sebesta 2010, 3.3.4 and 3.4).

    Parameters
    ----------
    sums : CellSums
    grid : CellGrid
        The grid the sums were made with.
    vehicle : Vehicle
        Whose fuel turns efficiency into specific consumption.
    full_load : FullLoad, optional
        Of the same trips. Cells above it, where it was reached, hold the noise of torque and aren't trusted. Without
        it, or where it is empty, the highest trusted cells stand in as a lower bound.
    idle : Idle, optional
        Of the same trips.

    Returns
    -------
    EfficiencyMap
        Every occupied cell; efficiency is NaN in those that are not trusted.
    """
    line = full_load if full_load is not None and len(full_load.rpm) else None
    rpm, nm = grid.centre_rpm(sums.i), grid.centre_nm(sums.j)
    efficiency = cell_efficiency(sums)
    possible = (efficiency > 0.0) & (efficiency <= HIGHEST_EFFICIENCY)
    trusted = trusted_cells(sums, grid)
    warnings = _impossible(efficiency, trusted & ~possible)
    trusted &= possible
    if line is not None:
        trusted &= ~line.exceeded(rpm, nm)
    efficiency = np.where(trusted, efficiency, np.nan)
    if line is None:
        line = lower_bound(envelope(sums, trusted, grid))
    return EfficiencyMap(
        grid=grid,
        rpm=rpm,
        nm=nm,
        n=sums.n,
        efficiency=efficiency,
        sd=cell_deviation(sums),
        bsfc_gpkwh=specific_consumption_gpkwh(efficiency, vehicle),
        full_load_rpm=line.rpm,
        full_load_nm=line.nm,
        full_load_sd=line.sd,
        full_load_reached=line.reached,
        idle=idle,
        warnings=warnings,
    )


def _impossible(efficiency: FloatArray, refused: BoolArray) -> tuple[str, ...]:
    """Say which cells no engine can have."""
    if not refused.any():
        return ()
    cells = "1 cell has" if refused.sum() == 1 else f"{refused.sum()} cells have"
    low, high = (f"{100.0 * value:.0f}" for value in (efficiency[refused].min(), efficiency[refused].max()))
    which = f"{high} %" if low == high else f"{low} to {high} %"
    return (
        f"{cells} an efficiency that no engine has ({which}; more than {100.0 * HIGHEST_EFFICIENCY:.0f} % can't be) "
        "and are left out. Check the injectors' flow or the fuel rate's scale, the fuel's energy, and the car's mass.",
    )


def cell_efficiency(sums: CellSums) -> FloatArray:
    """Efficiency of each cell, shape (m,): mechanical energy over fuel energy.

    The ratio of sums is taken rather than the mean of ratios, because noise in the fuel power of single points then
    averages out instead of raising the result: the mean of 1/P is above 1/mean(P).
    """
    return np.asarray(sums.power_sum_w / sums.fuel_power_sum_w)


def trusted_cells(sums: CellSums, grid: CellGrid) -> BoolArray:
    """Tell which cells have enough points that agree (Sebesta 2010, 3.3.4: within five points of efficiency)."""
    spread = cell_deviation(sums)
    if grid.independent:
        spread = spread / np.sqrt(sums.n)
    return np.asarray((sums.n >= grid.min_count) & (spread <= grid.max_sd))


def specific_consumption_gpkwh(efficiency: FloatArray, vehicle: Vehicle) -> FloatArray:
    """Brake-specific fuel consumption, g/kWh.

    A kilowatt-hour of work takes 3.6 MJ / η of fuel; a kilogram of fuel holds (energy per litre) / density.
    """
    grams_per_joule = 1000.0 * vehicle.fuel_density_kg_per_l / vehicle.fuel_energy_j_per_l
    return np.asarray(3.6e6 * grams_per_joule / efficiency)


def cell_deviation(sums: CellSums) -> FloatArray:
    """Sample standard deviation of the points of each cell; NaN below two points."""
    spread = sums.efficiency_squared_sum - sums.efficiency_sum**2 / np.maximum(sums.n, 1)
    variance = np.maximum(spread, 0.0) / np.maximum(sums.n - 1, 1)
    return np.where(sums.n >= 2, np.sqrt(variance), np.nan)


def _grouped(rows: CellSums) -> CellSums:
    """Add up rows of the same cell; the result is sorted by (i, j)."""
    if not len(rows.i):
        return EMPTY
    height = int(rows.j.max()) + 1
    cells, row = _places(rows.i * height + rows.j)

    def total(column: FloatArray | IntArray) -> FloatArray:
        return np.asarray(np.bincount(row, weights=column, minlength=len(cells)), dtype=np.float64)

    return CellSums(
        i=cells // height,
        j=cells % height,
        n=total(rows.n).astype(np.int64),
        efficiency_sum=total(rows.efficiency_sum),
        efficiency_squared_sum=total(rows.efficiency_squared_sum),
        power_sum_w=total(rows.power_sum_w),
        fuel_power_sum_w=total(rows.fuel_power_sum_w),
    )


def _places(cell: IntArray) -> tuple[IntArray, IntArray]:
    """Return the occupied cells in order, and for each row which of them it is in; ``cell`` is not negative."""
    whole = int(cell.max()) + 1
    if whole > TABLE_CELLS:
        return np.unique(cell, return_inverse=True)
    occupied = np.flatnonzero(np.bincount(cell, minlength=whole))
    place = np.empty(whole, np.int64)
    place[occupied] = np.arange(len(occupied))
    return occupied, place[cell]
