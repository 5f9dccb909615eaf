"""Two maps cell by cell: what has changed between two cars, or two times of one, and what may be chance."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.stats import norm

from app.science.arrays import BoolArray, FloatArray
from app.science.engine.efficiency_map import EfficiencyMap
from app.science.errors import ScienceError

POINTS_PER_LOOK = 20.0
"""Operating points twenty times a second tell the same story; so many count as one look at the engine."""
FALSE_SHARE = 0.05
FEWEST_CELLS = 10


@dataclass(frozen=True, slots=True)
class MapDifference:
    """Cells that both maps trust, each array of shape (n,), and what they say together.

    Attributes
    ----------
    rpm, nm : array
    difference, sd : array
        Second map minus first, and the standard deviation of that.
    significant : boolean array
        Changed, with at most `FALSE_SHARE` of those so called being chance (Benjamini and Hochberg 1995).
    level, level_sd : float
        Factor by which the second map's efficiency differs, over all cells, and its standard deviation.
    only_first, only_second : int
        Cells that one map alone trusts.
    """

    rpm: FloatArray
    nm: FloatArray
    difference: FloatArray
    sd: FloatArray
    significant: BoolArray
    level: float
    level_sd: float
    only_first: int
    only_second: int


def compare_maps(first: EfficiencyMap, second: EfficiencyMap) -> MapDifference:
    """Compare two maps where both are trusted.

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
    if len(common) < FEWEST_CELLS:
        raise ScienceError(f"The maps share {len(common)} trusted cells; it takes {FEWEST_CELLS} to compare them.")
    i, j = (np.array([table[cell] for cell in common]) for table in (at_first, at_second))
    difference = second.efficiency[j] - first.efficiency[i]
    sd = np.hypot(_mean_sd(first)[i], _mean_sd(second)[j])
    level, level_sd = _level(first.efficiency[i], second.efficiency[j], sd)
    return MapDifference(
        rpm=first.rpm[i],
        nm=first.nm[i],
        difference=difference,
        sd=sd,
        significant=_told_apart(difference / sd),
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


def _level(first: FloatArray, second: FloatArray, sd: FloatArray) -> tuple[float, float]:
    """Return the factor from one map to the other by weighted least squares, widened by what the cells scatter."""
    weight = 1.0 / sd**2
    information = float(np.sum(weight * first**2))
    factor = float(np.sum(weight * first * second)) / information
    scatter = float(np.sum(weight * (second - factor * first) ** 2)) / (len(first) - 1)
    return factor, float(np.sqrt(max(scatter, 1.0) / information))


def _told_apart(normalised: FloatArray) -> BoolArray:
    chance = 2.0 * norm.sf(np.abs(normalised))
    order = np.argsort(chance)
    allowed = FALSE_SHARE * np.arange(1, len(chance) + 1) / len(chance)
    passed = np.flatnonzero(chance[order] <= allowed)
    significant = np.zeros(len(chance), np.bool_)
    if len(passed):
        significant[order[: passed[-1] + 1]] = True
    return significant
