"""Where a formula can be believed, and where the engine is best by it (Sebesta 2010, 3.4).

A polynomial goes astray where there are no data, so its best point is looked for in the driven area only.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.ndimage import binary_dilation, label

from app.science.arrays import BoolArray, FloatArray
from app.science.engine.efficiency_map import EfficiencyMap
from app.science.engine.fitting.polynomial import RADPS_PER_RPM, PolynomialFit
from app.science.engine.fitting.terms import FitError

ISLAND = 0.01
NEAR_CELLS = 2


@dataclass(frozen=True, slots=True)
class Island:
    """Best point of a formula inside the driven area and how far the efficiency stays within one point of it.

    Attributes
    ----------
    rpm, nm, efficiency : float
    rpm_range, nm_range : (float, float)
    at_the_edge : bool
        The best point lies at the border of the driven area, so the engine may be better still outside.
    """

    rpm: float
    nm: float
    efficiency: float
    rpm_range: tuple[float, float]
    nm_range: tuple[float, float]
    at_the_edge: bool


def driven_area(efficiency_map: EfficiencyMap) -> tuple[FloatArray, FloatArray, BoolArray]:
    """Return the grid's engine speeds (rpm) and torques (Nm), and where a trusted cell is or is near (rpm, nm)."""
    known = np.isfinite(efficiency_map.efficiency)
    if not known.any():
        raise FitError("The map has no trusted cell yet. Drive on, then try again.")
    grid = efficiency_map.grid
    column, row = grid.column(efficiency_map.rpm[known]), grid.row(efficiency_map.nm[known])
    columns, rows = np.arange(column.min(), column.max() + 1), np.arange(row.min(), row.max() + 1)
    trusted = np.zeros((len(columns), len(rows)), np.bool_)
    trusted[column - columns[0], row - rows[0]] = True
    near = binary_dilation(trusted, iterations=NEAR_CELLS)
    return grid.centre_rpm(columns), grid.centre_nm(rows), near


def peak_island(fit: PolynomialFit, efficiency_map: EfficiencyMap) -> Island:
    """Return the best point of a formula inside the driven area; raises `FitError` when it has none."""
    rpm, nm, driven = driven_area(efficiency_map)
    at_rpm, at_nm = np.meshgrid(rpm, nm, indexing="ij")
    efficiency = fit.efficiency(at_rpm.ravel() * RADPS_PER_RPM, at_nm.ravel()).reshape(at_rpm.shape)
    inside = np.where(driven & np.isfinite(efficiency), efficiency, -np.inf)
    if not np.isfinite(inside).any():
        raise FitError("The formula gives no efficiency anywhere in the driven area; choose another one.")
    i, j = np.unravel_index(int(np.argmax(inside)), inside.shape)
    pieces, _ = label(inside > inside[i, j] - ISLAND)
    island = pieces == pieces[i, j]
    around = binary_dilation(island) & ~driven
    return Island(
        rpm=float(rpm[i]),
        nm=float(nm[j]),
        efficiency=float(inside[i, j]),
        rpm_range=(float(at_rpm[island].min()), float(at_rpm[island].max())),
        nm_range=(float(at_nm[island].min()), float(at_nm[island].max())),
        at_the_edge=bool(around.any() or i in (0, len(rpm) - 1) or j in (0, len(nm) - 1)),
    )
