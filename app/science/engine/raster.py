"""The map's cells as a rectangle, for everything that looks at neighbours."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.lib.stride_tricks import sliding_window_view

from app.science.arrays import BoolArray, FloatArray, IntArray
from app.science.engine.efficiency_map import CellGrid, EfficiencyMap

SMOOTHING_RPM = 100.0
SMOOTHING_NM = 4.0
WELL_SUPPORTED = 0.2 - 1e-9


@dataclass(frozen=True, slots=True)
class MapRaster:
    """Cells of a map from the lowest to the highest occupied row and column.

    Attributes
    ----------
    grid : CellGrid
    rpm : array, shape (columns,)
    nm : array, shape (rows,)
        Cell centres.
    n : integer array, shape (rows, columns)
        0 where no point fell.
    efficiency, sd, bsfc_gpkwh : array, shape (rows, columns)
        NaN where the map has none.
    """

    grid: CellGrid
    rpm: FloatArray
    nm: FloatArray
    n: IntArray
    efficiency: FloatArray
    sd: FloatArray
    bsfc_gpkwh: FloatArray


@dataclass(frozen=True, slots=True)
class SmoothedRaster:
    """Efficiency averaged over neighbouring cells.

    Attributes
    ----------
    efficiency : array, shape (rows, columns)
        NaN where the cell itself is not trusted.
    filled : array, shape (rows, columns)
        The same, and small holes closed: also known where at least half of the neighbourhood is trusted.
    sd : array, shape (rows, columns)
        Root mean square of the neighbours' deviations.
    supported : bool array, shape (rows, columns)
        True where the cell and at least a fifth of its neighbourhood are trusted.
    """

    efficiency: FloatArray
    filled: FloatArray
    sd: FloatArray
    supported: BoolArray


def raster(efficiency_map: EfficiencyMap) -> MapRaster:
    """Lay the cells of a map out as a rectangle; empty when the map is empty."""
    grid = efficiency_map.grid
    i, j = grid.column(efficiency_map.rpm), grid.row(efficiency_map.nm)
    if not len(i):
        nothing = np.empty((0, 0))
        return MapRaster(grid, np.empty(0), np.empty(0), nothing.astype(np.int64), nothing, nothing, nothing)
    i0, j0 = int(i.min()), int(j.min())
    shape = (int(j.max()) - j0 + 1, int(i.max()) - i0 + 1)

    def filled(values: FloatArray) -> FloatArray:
        laid_out = np.full(shape, np.nan)
        laid_out[j - j0, i - i0] = values
        return laid_out

    n = np.zeros(shape, np.int64)
    n[j - j0, i - i0] = efficiency_map.n
    return MapRaster(
        grid=grid,
        rpm=grid.centre_rpm(np.arange(i0, i0 + shape[1])),
        nm=grid.centre_nm(np.arange(j0, j0 + shape[0])),
        n=n,
        efficiency=filled(efficiency_map.efficiency),
        sd=filled(efficiency_map.sd),
        bsfc_gpkwh=filled(efficiency_map.bsfc_gpkwh),
    )


def smoothed(cells: MapRaster) -> SmoothedRaster:
    """Average trusted cells over ±100 rpm and ±4 Nm, so that one lucky cell does not stand out.

    Every trusted cell counts the same: ten thousand points of steady cruising are no more independent than the few
    that a cell needs to be trusted. Cells coarser than the window stay as they are.
    """
    reach = int(SMOOTHING_NM // cells.grid.nm), int(SMOOTHING_RPM // cells.grid.rpm)
    trusted = np.isfinite(cells.efficiency)
    support = _window_mean(trusted.astype(np.float64), reach)
    known = np.where(support > 0.0, support, 1.0)

    def neighbourhood_mean(values: FloatArray) -> FloatArray:
        return _window_mean(np.where(trusted, values, 0.0), reach) / known

    efficiency = neighbourhood_mean(cells.efficiency)
    return SmoothedRaster(
        efficiency=np.where(trusted, efficiency, np.nan),
        filled=np.where(trusted | (support >= 0.5), efficiency, np.nan),
        sd=np.where(trusted, np.sqrt(neighbourhood_mean(cells.sd**2)), np.nan),
        supported=trusted & (support > WELL_SUPPORTED),
    )


def _window_mean(values: FloatArray, reach: tuple[int, int]) -> FloatArray:
    """Mean over the cell and ``reach`` cells to each side; beyond the edge lie zeros."""
    if not values.size:
        return values
    padded = np.pad(values, [(reach[0], reach[0]), (reach[1], reach[1])])
    windows = sliding_window_view(padded, (2 * reach[0] + 1, 2 * reach[1] + 1))
    return np.asarray(windows.mean(axis=(-1, -2)))


def confidence(cells: MapRaster) -> FloatArray:
    """How much a cell's number can be relied on, 0 to 1, shape (rows, columns): for showing what is well known.

    It rises with the number of points and falls with their scatter; 0 where the cell is not trusted.
    """
    many = cells.n / (cells.n + 2.0 * cells.grid.min_count)
    spread = cells.sd / np.sqrt(cells.n) if cells.grid.independent else cells.sd
    agreeing = 1.0 - 0.6 * spread / cells.grid.max_sd
    return np.where(np.isfinite(cells.efficiency), many * agreeing, 0.0)
