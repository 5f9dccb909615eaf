"""The full-load envelope: the highest torque the engine was seen to give, by engine speed."""

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


def full_load(sums: CellSums, trusted: BoolArray, grid: CellGrid) -> Envelope:
    """Take the highest trusted cell of every engine-speed column (Sebesta 2010, 3.4.1.4).

    Dips narrower than 500 rpm are closed: there the car was not floored, for no engine loses and regains its torque
    within so little. What was never floored over a wider band stays low: the envelope is what was seen, a lower
    bound of what the engine can do.

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
    i, j = sums.i[trusted], sums.j[trusted]
    reach = int(CLOSED_RPM / 2 // grid.rpm)
    first = int(i.min()) - 2 * reach  # unseen columns on both sides, so that the closing leaves the ends alone
    top = np.full(int(i.max()) + 2 * reach - first + 1, -1, dtype=np.int64)
    np.maximum.at(top, i - first, j)
    width = 2 * reach + 1
    highest = sliding_window_view(top, width).max(axis=-1)
    closed = sliding_window_view(highest, width).min(axis=-1)
    seen = np.flatnonzero(closed >= 0)
    return Envelope(grid.centre_rpm(int(i.min()) + seen), grid.centre_nm(closed[seen]))
