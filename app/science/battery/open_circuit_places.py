"""The state of charge of a record's rows, counted between the ends it reaches."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from itertools import pairwise

import numpy as np

from app.science.arrays import FloatArray
from app.science.battery.record import BatteryRecord
from app.science.battery.strokes import End, charge_ah, ends
from app.science.errors import TooLittleData

AS_SLOW = 1.5
"""Times the slowest discharge's current up to which another ends where it does."""

CONTRADICTED = 0.05
"""Share by which the charge between two ends may differ from the capacity given."""

BEGINS_FULL, BEGINS_EMPTY = 0.2, 0.5
"""Share of the span between both end voltages within which a record's first voltage passes for full, or for empty."""


@dataclass(frozen=True, slots=True)
class Placed:
    """A record with the state of charge of its rows.

    Attributes
    ----------
    record : BatteryRecord
        Of one cell.
    soc : ndarray (n,)
    capacities_ah : tuple of float
        Between successive ends of opposite kind.
    ends : tuple of End
    """

    record: BatteryRecord
    soc: FloatArray
    capacities_ah: tuple[float, ...]
    ends: tuple[End, ...]


def of_one_cell(record: BatteryRecord, series: int, parallel: int) -> BatteryRecord:
    """Return a pack's record as one of its cells sees it."""
    return replace(record, current_a=record.current_a / parallel, voltage_v=record.voltage_v / series)


def capacity_between(found: tuple[End, ...]) -> tuple[float, ...]:
    """Return the charge between successive ends of opposite kind, ampere-hours."""
    return tuple(abs(b.charge_ah - a.charge_ah) for a, b in pairwise(found) if a.full != b.full)


def slow_current(cells: Sequence[BatteryRecord], limits_v: tuple[float, float]) -> float:
    """Return the current up to which discharges empty a cell as well as the slowest that is there does, amperes."""
    at_empty = [abs(float(cell.current_a[end.row])) for cell in cells for end in ends(cell, limits_v) if not end.full]
    return AS_SLOW * min(at_empty, default=np.inf)


def slow_ends(record: BatteryRecord, limits_v: tuple[float, float], slow_a: float) -> tuple[End, ...]:
    """Return a record's ends without those that a fast discharge reached while there was charge left."""
    found = ends(record, limits_v)
    return tuple(end for end in found if end.full or abs(float(record.current_a[end.row])) <= slow_a)


def place(
    record: BatteryRecord,
    limits_v: tuple[float, float],
    capacity_ah: float,
    ends_soc: tuple[float, float] = (0.0, 1.0),
    *,
    given: bool = False,
    slow_a: float = np.inf,
) -> Placed:
    """Count the state of charge from the ends a record reaches.

    Between two opposite ends the charge is shared out so that both are met, unless that contradicts a capacity that
    was given by more than a few percent: then one of them is no end, and the full one counts. Elsewhere the capacity
    and the nearest end before count.

    Parameters
    ----------
    record : BatteryRecord
        Of one cell.
    limits_v : tuple of float
    capacity_ah : float
    ends_soc : tuple of float
        States of charge that the empty and the full end are.
    given : bool
        The capacity was given, not counted between such ends.
    slow_a : float
        Current above which a discharge ends before the cell is empty.

    Raises
    ------
    TooLittleData
        When the record reaches neither end.
    """
    reached = found = slow_ends(record, limits_v, slow_a)
    if not found:
        raise TooLittleData(
            f"The data reach neither {limits_v[1]:.3f} V after a charge nor {limits_v[0]:.3f} V after a discharge, so "
            "nobody can say which state of charge they show. Give the voltages of the ends, or data that reach one."
        )
    whole_ah = capacity_ah * (ends_soc[1] - ends_soc[0])
    if given and any(abs(one / whole_ah - 1.0) > CONTRADICTED for one in capacity_between(found)):
        found = tuple(end for end in found if end.full)
    charge = charge_ah(record)
    soc = ends_soc[found[0].full] + (charge - found[0].charge_ah) / capacity_ah
    for k, end in enumerate(found):
        following = found[k + 1] if k + 1 < len(found) else None
        capacity = capacity_ah
        if following is not None and following.full != end.full:
            capacity = abs(following.charge_ah - end.charge_ah) / (ends_soc[1] - ends_soc[0])
        rows = slice(end.row, None if following is None else following.row + 1)
        soc[rows] = ends_soc[end.full] + (charge[rows] - end.charge_ah) / capacity
    return Placed(record, soc, capacity_between(reached), reached)


def counted_capacity(
    cells: Sequence[BatteryRecord],
    limits_v: tuple[float, float],
    ends_soc: tuple[float, float] = (0.0, 1.0),
    slow_a: float = np.inf,
) -> tuple[float, tuple[str, ...]]:
    """Return the capacity that records tell, ampere-hours, and what had to be assumed for it.

    Of the whole cell, where the ends are only ``ends_soc`` of it.

    Raises
    ------
    TooLittleData
        When no record runs from one end to the other, nor seems to begin at one.
    """
    found = [slow_ends(cell, limits_v, slow_a) for cell in cells]
    share = ends_soc[1] - ends_soc[0]
    between = [capacity / share for one in found for capacity in capacity_between(one)]
    if between:
        return float(np.median(between)), ()
    begun = [
        abs(one[0].charge_ah) / share
        for cell, one in zip(cells, found, strict=True)
        if one and one[0].charge_ah and _begins_at_other_end(cell, one[0], limits_v)
    ]
    if not begun:
        raise TooLittleData(
            f"No charge or discharge runs between {limits_v[1]:.3f} V and {limits_v[0]:.3f} V, so the data do not tell "
            "the capacity, which the state of charge is a share of. Give the capacity, or a full discharge."
        )
    return max(begun), (
        f"No record runs from one end of the cell to the other and back; one that begins near the other end is taken "
        f"to begin at it, which makes the capacity {max(begun):.4g} Ah.",
    )


def _begins_at_other_end(cell: BatteryRecord, end: End, limits_v: tuple[float, float]) -> bool:
    first = float(cell.voltage_v[np.isfinite(cell.voltage_v)][0])
    span = limits_v[1] - limits_v[0]
    if end.full:
        return first - limits_v[0] <= BEGINS_EMPTY * span
    return limits_v[1] - first <= BEGINS_FULL * span
