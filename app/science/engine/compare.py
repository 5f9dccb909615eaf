"""Two maps cell by cell: what has changed between two cars, or two times of one, and what may be chance."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from app.science.arrays import BoolArray, FloatArray
from app.science.engine.efficiency_map import EfficiencyMap
from app.science.engine.significance import told_apart, two_sided_chance
from app.science.errors import ScienceError

POINTS_PER_LOOK = 12.0
"""Neighbouring operating points tell the same story; so many count as one look at the engine.

Trips of a virtual car ask for 4 in a cell where each has ten points and for 11 where each has a hundred. With 12, two
halves of twelve half hours of it show a changed cell in one comparison of twelve.
"""
FEWEST_CELLS = 10


@dataclass(frozen=True, slots=True)
class MapDifference:
    """Cells that both maps trust, each array of shape (n,), and what they say together.

    Attributes
    ----------
    rpm, nm : array
    first, second : array
        Efficiencies.
    difference, sd : array
        Second minus first, and the standard deviation of that.
    significant : boolean array
        Changed, with at most one in twenty of those so called being chance (Benjamini and Hochberg 1995).
    level, level_sd : float
        Factor by which the second map's efficiency differs, over all cells, and its standard deviation.
    only_first, only_second : int
        Cells that one map alone trusts.
    """

    rpm: FloatArray
    nm: FloatArray
    first: FloatArray
    second: FloatArray
    difference: FloatArray
    sd: FloatArray
    significant: BoolArray
    level: float
    level_sd: float
    only_first: int
    only_second: int


def compare_maps(first: EfficiencyMap, second: EfficiencyMap) -> MapDifference:
    """Compare two maps where both are trusted, by what the maps alone tell.

    They must have no trip in common. What differs from trip to trip as a whole, such as wind and load, is not in the
    standard deviations: `compare_trips` knows of it.

    Raises
    ------
    ScienceError
        When their cells differ in size, or too few are trusted in both.
    """
    if (first.grid.rpm, first.grid.nm) != (second.grid.rpm, second.grid.nm):
        raise ScienceError(
            f"The maps' cells differ: {first.grid.rpm:g} rpm × {first.grid.nm:g} Nm and {second.grid.rpm:g} rpm × "
            f"{second.grid.nm:g} Nm. Compare maps of the same cells."
        )
    at_first, at_second = _trusted(first), _trusted(second)
    common = sorted(at_first.keys() & at_second.keys())
    require_overlap(len(common))
    i, j = (np.array([table[cell] for cell in common]) for table in (at_first, at_second))
    difference = second.efficiency[j] - first.efficiency[i]
    sd = np.hypot(_mean_sd(first)[i], _mean_sd(second)[j])
    level, level_sd = _level(first.efficiency[i], second.efficiency[j], sd)
    return MapDifference(
        rpm=first.rpm[i],
        nm=first.nm[i],
        first=first.efficiency[i],
        second=second.efficiency[j],
        difference=difference,
        sd=sd,
        significant=told_apart(two_sided_chance(difference / sd)),
        level=level,
        level_sd=level_sd,
        only_first=len(at_first) - len(common),
        only_second=len(at_second) - len(common),
    )


def _trusted(one: EfficiencyMap) -> dict[tuple[int, int], int]:
    known = np.flatnonzero(np.isfinite(one.efficiency))
    column, row = one.grid.column(one.rpm[known]).tolist(), one.grid.row(one.nm[known]).tolist()
    return dict(zip(zip(column, row, strict=True), known.tolist(), strict=True))


def _mean_sd(one: EfficiencyMap) -> FloatArray:
    """Return the standard deviation of each cell's mean, counting looks instead of points."""
    looks = np.maximum(one.n / (1.0 if one.grid.independent else POINTS_PER_LOOK), 1.0)
    usual = float(np.nanmedian(one.sd)) if np.isfinite(one.sd).any() else one.grid.max_sd
    return np.maximum(np.where(np.isfinite(one.sd), one.sd, usual), 1e-4) / np.sqrt(looks)


def require_overlap(cells: int) -> None:
    """Raise `ScienceError` when two maps share too few cells to be compared."""
    if cells < FEWEST_CELLS:
        raise ScienceError(
            f"The maps share {cells} trusted cells; it takes {FEWEST_CELLS} to compare them. Choose trips that ran the "
            "engine at the same speeds and torques, or add some."
        )


def _level(first: FloatArray, second: FloatArray, sd: FloatArray) -> tuple[float, float]:
    """Return the factor from one map to the other by weighted least squares, widened by what the cells scatter."""
    weight = 1.0 / sd**2
    information = float(np.sum(weight * first**2))
    factor = float(np.sum(weight * first * second)) / information
    scatter = float(np.sum(weight * (second - factor * first) ** 2)) / (len(first) - 1)
    return factor, float(np.sqrt(max(scatter, 1.0) / information))
