"""How fine a map the data can carry."""

from __future__ import annotations

from dataclasses import dataclass, replace

from app.science.engine.cells import coarsen, trusted_cells
from app.science.engine.efficiency_map import CellGrid, CellSums

COARSER = ((1, 1), (2, 2), (5, 5), (5, 10), (10, 10))
SPARSE_COUNT = 5
ENOUGH = 0.5


@dataclass(frozen=True, slots=True)
class Resolved:
    """Sums over the cells they can fill, and the grid of these cells."""

    sums: CellSums
    grid: CellGrid


def resolve(sums: CellSums, grid: CellGrid) -> Resolved:
    """Choose the finest cells that the points can fill.

    A bus that is polled every few seconds gives a few hundred points; in cells of 50 rpm by 2 Nm none would ever be
    trusted. So the first of the grids up to 10 times coarser is taken whose trusted cells hold at least half of the
    points, else the one whose trusted cells hold most. Points so far apart in time are independent of each other, so
    coarser cells are trusted from 5 points, by the standard error of their mean.

    Parameters
    ----------
    sums : CellSums
    grid : CellGrid
        The grid the sums were made with.
    """
    best, best_share = Resolved(sums, grid), 0.0
    for rpm_factor, nm_factor in COARSER:
        if (rpm_factor, nm_factor) == (1, 1):
            tried = Resolved(sums, grid)
        else:
            coarser = replace(
                grid,
                rpm=grid.rpm * rpm_factor,
                nm=grid.nm * nm_factor,
                min_count=min(grid.min_count, SPARSE_COUNT),
                independent=True,
            )
            tried = Resolved(coarsen(sums, rpm_factor, nm_factor), coarser)
        share = int(tried.sums.n[trusted_cells(tried.sums, tried.grid)].sum()) / max(int(sums.n.sum()), 1)
        if share >= ENOUGH:
            return tried
        if share > best_share:
            best, best_share = tried, share
    return best
