"""What a map says at a glance: where the engine is best, and how much of its field is known."""

from __future__ import annotations

from dataclasses import dataclass
from math import pi

import numpy as np

from app.science.arrays import BoolArray, FloatArray
from app.science.engine.efficiency_map import EfficiencyMap
from app.science.engine.raster import raster, smoothed
from app.science.engine.rules import PointRules

RADPS_PER_RPM = pi / 30.0
AS_GOOD = 0.002


@dataclass(frozen=True, slots=True)
class Peak:
    """Where the engine is most efficient.

    Attributes
    ----------
    efficiency, sd : float
        Mean of the trusted cells around the best one, and the deviation of single points from it.
    rpm, nm : float
        Centre of the best cell.
    bsfc_gpkwh : float
    rpm_low, rpm_high, nm_low, nm_high : float
        Where the cells lie that are as good within `AS_GOOD`: on a flat top the best place is known no better.
    """

    efficiency: float
    sd: float
    rpm: float
    nm: float
    bsfc_gpkwh: float
    rpm_low: float
    rpm_high: float
    nm_low: float
    nm_high: float


def peak(efficiency_map: EfficiencyMap) -> Peak | None:
    """Find the best trusted cell, judged together with its neighbours.

    A cell at a ragged edge has few neighbours to speak for it, so cells with less than a fifth of their
    neighbourhood trusted are passed over as long as there is a better supported one.

    Returns
    -------
    Peak or None
        None when no cell is trusted.
    """
    cells = raster(efficiency_map)
    around = smoothed(cells)
    candidates = np.where(around.supported, around.efficiency, np.nan) if around.supported.any() else around.efficiency
    if not np.isfinite(candidates).any():
        return None
    row, column = np.unravel_index(int(np.nanargmax(candidates)), candidates.shape)
    efficiency = float(around.efficiency[row, column])
    consumption = cells.bsfc_gpkwh[row, column] * cells.efficiency[row, column] / efficiency
    as_good = candidates >= efficiency - AS_GOOD
    return Peak(
        efficiency=efficiency,
        sd=float(around.sd[row, column]),
        rpm=float(cells.rpm[column]),
        nm=float(cells.nm[row]),
        bsfc_gpkwh=float(consumption),
        rpm_low=float(cells.rpm[as_good.any(axis=0)].min()),
        rpm_high=float(cells.rpm[as_good.any(axis=0)].max()),
        nm_low=float(cells.nm[as_good.any(axis=1)].min()),
        nm_high=float(cells.nm[as_good.any(axis=1)].max()),
    )


def coverage(efficiency_map: EfficiencyMap, idle_rpm: float) -> float:
    """Share of the engine's field that is known: trusted cells among those an operating point can fall in.

    The field reaches from idle to the highest engine speed of the full-load envelope, from the power that counts as
    propelling up to the envelope (linear between its corners).

    Parameters
    ----------
    efficiency_map : EfficiencyMap
    idle_rpm : float

    Returns
    -------
    float
        0 to 1; 0 when nothing is trusted.
    """
    grid, top = efficiency_map.grid, efficiency_map.full_load_rpm
    if not len(top):
        return 0.0

    def inside(rpm: FloatArray, nm: FloatArray) -> BoolArray:
        ceiling = np.interp(rpm, top, efficiency_map.full_load_nm, right=-np.inf)
        power = rpm * nm * RADPS_PER_RPM
        return np.asarray((rpm >= idle_rpm) & (nm <= ceiling) & (power > PointRules().min_power_w))

    columns = grid.centre_rpm(np.arange(int(grid.column(top)[-1]) + 1))
    rows = grid.centre_nm(np.arange(int(grid.row(efficiency_map.full_load_nm).max()) + 1))
    field = int(inside(*np.meshgrid(columns, rows)).sum())
    trusted = np.isfinite(efficiency_map.efficiency) & inside(efficiency_map.rpm, efficiency_map.nm)
    return float(trusted.sum() / field) if field else 0.0
