"""Where to run the engine at a given power."""

from __future__ import annotations

from dataclasses import dataclass
from math import pi

import numpy as np

from app.science.arrays import FloatArray, IntArray
from app.science.engine.efficiency_map import EfficiencyMap
from app.science.engine.raster import raster, smoothed

RADPS_PER_RPM = pi / 30.0
STEP_W = 500.0
RELUCTANCE_PER_RPM = 4e-5


@dataclass(frozen=True, slots=True)
class OperatingLine:
    """An efficient engine speed and torque for each power, arrays of shape (k,), by rising power."""

    power_w: FloatArray
    rpm: FloatArray
    nm: FloatArray
    efficiency: FloatArray


def optimal_operating_line(efficiency_map: EfficiencyMap) -> OperatingLine:
    """For each power, the most efficient trusted cell on its hyperbola, without jumping about.

    Along a hyperbola efficiency is so flat at its best that noise would decide. So the whole line is chosen at once:
    the sum of the smoothed efficiencies less 0.4 points for every 100 rpm that engine speed moves, which dynamic
    programming over the powers makes largest. Powers run in steps of 500 W; one that no trusted cell gives is left
    out.
    """
    cells = raster(efficiency_map)
    around = smoothed(cells)
    nothing = OperatingLine(np.empty(0), np.empty(0), np.empty(0), np.empty(0))
    if not around.supported.any():
        return nothing
    cell_power = np.outer(cells.nm, cells.rpm * RADPS_PER_RPM)[around.supported]
    power = np.arange(np.ceil(cell_power.min() / STEP_W), np.floor(cell_power.max() / STEP_W) + 1) * STEP_W
    torque = power[:, np.newaxis] / (cells.rpm * RADPS_PER_RPM)
    row = cells.grid.row(torque) - int(cells.grid.row(cells.nm)[0])
    inside = (row >= 0) & (row < len(cells.nm))
    row, column = np.where(inside, row, 0), np.arange(len(cells.rpm))
    efficiency = np.where(inside & around.supported[row, column], around.efficiency[row, column], -np.inf)
    known = np.isfinite(efficiency).any(axis=1)
    if not known.any():
        return nothing
    power, torque, efficiency = power[known], torque[known], efficiency[known]
    path = _steadiest(efficiency, RELUCTANCE_PER_RPM * np.abs(cells.rpm[:, np.newaxis] - cells.rpm))
    each = np.arange(len(path))
    return OperatingLine(power, cells.rpm[path], torque[each, path], efficiency[each, path])


def _steadiest(gain: FloatArray, cost: FloatArray) -> IntArray:
    """Choose one column per row so that the gains less the costs of moving between columns are largest.

    Parameters
    ----------
    gain : array, shape (rows, columns)
        -inf where a column is not to be had; every row has one that is.
    cost : array, shape (columns, columns)
        Of moving from a column to a column in the next row.
    """
    total = gain[0]
    came_from = np.zeros(gain.shape, np.int64)
    for row in range(1, len(gain)):
        candidates = total - cost
        came_from[row] = candidates.argmax(axis=1)
        total = candidates.max(axis=1) + gain[row]
    path = np.empty(len(gain), np.int64)
    for row in range(len(gain) - 1, -1, -1):
        path[row] = total.argmax() if row == len(gain) - 1 else came_from[row + 1, path[row + 1]]
    return path
