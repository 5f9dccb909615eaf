"""Where a formula can be believed, and where the engine is best by it (Sebesta 2010, 3.4).

A polynomial goes astray where there are no data, so its best point is looked for in the driven area only. The second of
the thesis' remedies stands here: cut the formula off where it rises again.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from app.science.arrays import BoolArray, FloatArray
from app.science.engine.efficiency_map import EfficiencyMap
from app.science.engine.fitting.areas import piece_around, widened
from app.science.engine.fitting.cells import RADPS_PER_RPM
from app.science.engine.fitting.polynomial import Formula
from app.science.engine.fitting.terms import FitError

ISLAND = 0.01
NEAR_RPM, NEAR_NM = 100.0, 4.0
RAY_STEPS = 48
RISES = 0.01


@dataclass(frozen=True, slots=True)
class Island:
    """Best point of a formula inside the driven area and how far the efficiency stays within one point of it.

    Attributes
    ----------
    rpm, nm, efficiency : float
    sd : float
        Standard deviation of the efficiency, from that of the coefficients alone.
    rpm_range, nm_range : (float, float)
    at_the_edge : bool
        The best point lies at the border of the driven area, so the engine may be better still outside.
    """

    rpm: float
    nm: float
    efficiency: float
    sd: float
    rpm_range: tuple[float, float]
    nm_range: tuple[float, float]
    at_the_edge: bool


@dataclass(frozen=True, slots=True)
class DrivenArea:
    """Where the map speaks.

    Attributes
    ----------
    rpm : array, shape (columns,)
    nm : array, shape (rows,)
        Cell centres, from the lowest to the highest trusted cell.
    near : bool array, shape (columns, rows)
        True where a trusted cell is or is near.
    """

    rpm: FloatArray
    nm: FloatArray
    near: BoolArray

    def holds(self, rpm: FloatArray, nm: FloatArray) -> BoolArray:
        """Tell which of a grid's points lie inside, shape (len(rpm), len(nm))."""
        i, away_i = _nearest(self.rpm, rpm)
        j, away_j = _nearest(self.nm, nm)
        return np.asarray(self.near[np.ix_(i, j)] & ~away_i[:, None] & ~away_j[None, :])


def _nearest(centres: FloatArray, values: FloatArray) -> tuple[np.ndarray, BoolArray]:
    """Return the index of the nearest centre, and whether the value is further away than half a cell."""
    step = float(centres[1] - centres[0]) if len(centres) > 1 else 1.0
    index = np.round((values - centres[0]) / step).astype(np.int64)
    return np.clip(index, 0, len(centres) - 1), np.asarray((index < 0) | (index >= len(centres)))


def driven_area(efficiency_map: EfficiencyMap) -> DrivenArea:
    """Return where a trusted cell is, or is near: within 100 rpm and 4 Nm, of coarser cells the cell itself.

    Raises
    ------
    FitError
        When no cell is trusted.
    """
    known = np.isfinite(efficiency_map.efficiency)
    if not known.any():
        raise FitError("The map has no trusted cell yet. Drive on, then try again.")
    grid = efficiency_map.grid
    column, row = grid.column(efficiency_map.rpm[known]), grid.row(efficiency_map.nm[known])
    columns, rows = np.arange(column.min(), column.max() + 1), np.arange(row.min(), row.max() + 1)
    trusted = np.zeros((len(columns), len(rows)), np.bool_)
    trusted[column - columns[0], row - rows[0]] = True
    near = widened(trusted, int(min(NEAR_RPM // grid.rpm, NEAR_NM // grid.nm)))
    return DrivenArea(grid.centre_rpm(columns), grid.centre_nm(rows), near)


def peak_island(formula: Formula, area: DrivenArea) -> Island:
    """Return the best point of a formula inside the driven area; raises `FitError` when it has none."""
    rpm, nm, driven = area.rpm, area.nm, area.near
    at_rpm, at_nm = np.meshgrid(rpm, nm, indexing="ij")
    efficiency = formula.efficiency(at_rpm * RADPS_PER_RPM, at_nm)
    inside = np.where(driven & np.isfinite(efficiency), efficiency, -np.inf)
    if not np.isfinite(inside).any():
        raise FitError("The formula gives no efficiency anywhere in the driven area; choose another one.")
    i, j = np.unravel_index(int(np.argmax(inside)), inside.shape)
    island = piece_around(inside > inside[i, j] - ISLAND, int(i), int(j))
    outside = widened(island) & ~driven
    return Island(
        rpm=float(rpm[i]),
        nm=float(nm[j]),
        efficiency=float(inside[i, j]),
        sd=_efficiency_sd(formula, float(rpm[i]) * RADPS_PER_RPM, float(nm[j]), float(inside[i, j])),
        rpm_range=(float(at_rpm[island].min()), float(at_rpm[island].max())),
        nm_range=(float(at_nm[island].min()), float(at_nm[island].max())),
        at_the_edge=bool(outside.any() or i in (0, len(rpm) - 1) or j in (0, len(nm) - 1)),
    )


def _efficiency_sd(formula: Formula, omega: float, torque: float, efficiency: float) -> float:
    """Carry the deviation of the target over to η: a relative error of φ or P_in is one of η, too."""
    sd = formula.value_sd(omega, torque)
    if formula.target == "eta":
        return sd
    return efficiency * sd / abs(float(formula.values(np.array([omega]), np.array([torque]))[0]))


def cut_off(formula: Formula, peak: Island, omega: FloatArray, torque: FloatArray) -> FloatArray:
    """Return η, 0 where it rises by a point again on the straight way from the peak: the thesis' second remedy.

    Parameters
    ----------
    formula : Formula
    peak : Island
        Of the formula.
    omega, torque : array, shape (n,)
        rad/s and Nm.
    """
    share = np.linspace(0.0, 1.0, RAY_STEPS)[:, None]
    from_omega, from_torque = peak.rpm * RADPS_PER_RPM, peak.nm
    way = formula.efficiency(from_omega + share * (omega - from_omega), from_torque + share * (torque - from_torque))
    lowest = np.minimum.accumulate(way, axis=0)
    rises_again = (way - lowest > RISES).any(axis=0) | ~np.isfinite(way).all(axis=0)
    return np.where(rises_again | (way[-1] < 0.0), 0.0, way[-1])
