"""The envelope of a map's cells: the highest trusted torque, by engine speed."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.lib.stride_tricks import sliding_window_view

from app.science.arrays import BoolArray, FloatArray
from app.science.engine.efficiency_map import CellGrid, CellSums

CLOSED_RPM = 500.0


@dataclass(frozen=True, slots=True)
class Envelope:
    """A polyline, arrays of shape (k,), by rising engine speed."""

    rpm: FloatArray
    nm: FloatArray


def envelope(sums: CellSums, trusted: BoolArray, grid: CellGrid) -> Envelope:
    """Take the highest trusted cell of every engine-speed column (Sebesta 2010, 3.4.1.4).

    What was never floored over a wide band stays low: the envelope is what was seen, a lower bound of what the engine
    can do. Narrow dips are `closed`.

    Parameters
    ----------
    sums : CellSums
    trusted : bool array, shape (m,)
    grid : CellGrid

    Returns
    -------
    Envelope
        Column centres and cell centres; empty when no cell is trusted.
    """
    if not trusted.any():
        return Envelope(np.empty(0), np.empty(0))
    columns, place = np.unique(sums.i[trusted], return_inverse=True)
    top = np.full(len(columns), -1, dtype=np.int64)
    np.maximum.at(top, place, sums.j[trusted])
    return closed(Envelope(grid.centre_rpm(columns), grid.centre_nm(top)), grid.rpm)


def closed(line: Envelope, step_rpm: float) -> Envelope:
    """Close dips narrower than 500 rpm: there the car was not floored.

    No engine loses and regains its torque within so little.

    Parameters
    ----------
    line : Envelope
        At some of the columns that lie ``step_rpm`` apart.
    step_rpm : float

    Returns
    -------
    Envelope
        With the columns that were missing in narrow gaps.
    """
    column = np.round((line.rpm - line.rpm[0]) / step_rpm).astype(np.int64)
    reach = int(CLOSED_RPM / 2 // step_rpm)
    # unseen columns on both sides, so that the closing leaves the ends alone
    top = np.full(int(column[-1]) + 1 + 4 * reach, -np.inf)
    top[column + 2 * reach] = line.nm
    width = 2 * reach + 1
    highest = sliding_window_view(top, width).max(axis=-1)
    filled = sliding_window_view(highest, width).min(axis=-1)
    seen = np.flatnonzero(np.isfinite(filled))
    return Envelope(line.rpm[0] + seen * step_rpm, filled[seen])
