"""Where a record charges, discharges and rests, and where it reaches the cell's full and empty ends."""

from __future__ import annotations

from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from app.science.arrays import FloatArray
from app.science.battery.circuit import AS_PER_AH
from app.science.battery.record import BatteryRecord

REST = 0.01
"""Share of the record's largest current below which it rests."""

TAPERED = 0.25
"""Share of a charge's largest current below which holding the voltage has filled the cell."""

SHORT = 0.05
"""Share of the record's span of charge below which a charge without tapering is a pulse, and fills nothing."""

NEAR = 0.01
"""Share of the span between both end voltages that counts as having reached one."""


@dataclass(frozen=True, slots=True)
class Stroke:
    """Rows of one direction: charging 1, discharging −1, resting 0; ``end`` is the first row that is no longer so."""

    begin: int
    end: int
    direction: int


@dataclass(frozen=True, slots=True)
class End:
    """Where a cell was full or empty.

    Attributes
    ----------
    row : int
        Row at which the end is reached.
    charge_ah : float
        Of the record's count of charge, between rows where the voltage passes the end between two rows.
    step_ah : float
        Charge between the two rows around the end: how well its place is known.
    full : bool
    voltage_v : float
    taken : bool
        Taken to be an end because nothing lies beyond it, with nothing else that says so.
    """

    row: int
    charge_ah: float
    step_ah: float
    full: bool
    voltage_v: float
    taken: bool = False


def charge_ah(record: BatteryRecord) -> FloatArray:
    """Return the charge that has gone in by each row, ampere-hours, zero at the first."""
    moved = record.current_a[:-1] * np.diff(record.t_s)
    return np.concatenate(([0.0], np.cumsum(moved))) / AS_PER_AH


def strokes(record: BatteryRecord) -> tuple[Stroke, ...]:
    """Split a record into stretches of charging, discharging and resting."""
    quiet = REST * float(np.abs(record.current_a).max())
    direction = np.where(np.abs(record.current_a) <= quiet, 0, np.sign(record.current_a)).astype(int)
    borders = np.concatenate(([0], np.flatnonzero(np.diff(direction)) + 1, [len(direction)]))
    return tuple(Stroke(begin, end, int(direction[begin])) for begin, end in pairwise(borders.tolist()))


def voltage_limits(record: BatteryRecord) -> tuple[float, float]:
    """Return the lowest voltage while discharging and the highest while charging; of all rows where it never does."""
    seen = np.isfinite(record.voltage_v)
    if not seen.any():
        return np.nan, np.nan
    falling, rising = seen & (record.current_a < 0.0), seen & (record.current_a > 0.0)
    low = record.voltage_v[falling if falling.any() else seen].min()
    return float(low), float(record.voltage_v[rising if rising.any() else seen].max())


def ends(record: BatteryRecord, limits_v: tuple[float, float]) -> tuple[End, ...]:
    """Return where a record reaches the full and the empty end, in order, the last of neighbours of one kind.

    Full is a charge that ends at the upper voltage after its current has tapered there, or one of constant current
    that stops there; empty is where a discharge first passes the lower voltage. A record that begins at rest at the
    upper voltage begins full. Pulses that only touch a voltage are no ends.

    Parameters
    ----------
    record : BatteryRecord
    limits_v : tuple of float
        Lower and upper voltage that are the ends, in the record's volts.
    """
    charge = charge_ah(record)
    span = float(np.ptp(charge))
    near = NEAR * (limits_v[1] - limits_v[0])
    found: list[End] = []
    for stroke in strokes(record):
        if stroke.direction > 0:
            end = _full(record, charge, stroke, limits_v[1] - near, SHORT * span)
        elif stroke.direction < 0:
            end = _empty(record, charge, stroke, limits_v[0], near)
        else:
            end = _full_at_rest(record, stroke, limits_v[1] - near)
        if end is None:
            continue
        if found and found[-1].full == end.full and abs(end.charge_ah - found[-1].charge_ah) < SHORT * span:
            found.pop()
        found.append(end)
    return tuple(found)


def _full(record: BatteryRecord, charge: FloatArray, stroke: Stroke, upper_v: float, pulse_ah: float) -> End | None:
    rows = np.arange(stroke.begin, stroke.end)
    rows = rows[np.isfinite(record.voltage_v[rows])]
    if len(rows) == 0 or record.voltage_v[rows[-1]] < upper_v:
        return None
    after = min(stroke.end, len(charge) - 1)
    current = record.current_a[rows]
    tapered = current[-1] <= TAPERED * float(current.max())
    if not tapered and charge[after] - charge[stroke.begin] < pulse_ah:
        return None
    last = int(rows[-1])
    return End(
        last, float(charge[after]), float(charge[after] - charge[max(last - 1, 0)]), True, float(record.voltage_v[last])
    )


def _empty(record: BatteryRecord, charge: FloatArray, stroke: Stroke, lower_v: float, near_v: float) -> End | None:
    rows = np.arange(stroke.begin, stroke.end)
    rows = rows[np.isfinite(record.voltage_v[rows])]
    volts = record.voltage_v[rows]
    below = np.flatnonzero(volts <= lower_v)
    if len(below) == 0:
        below = np.flatnonzero(volts <= lower_v + near_v)[-1:]
    if len(below) == 0:
        return None
    at = int(below[0])
    here, before = int(rows[at]), int(rows[max(at - 1, 0)])
    fall = volts[max(at - 1, 0)] - volts[at]
    share = (record.voltage_v[before] - lower_v) / fall if fall > 0.0 and volts[at] <= lower_v else 1.0
    step = charge[here] - charge[before]
    crossed = max(lower_v, float(volts[at]))
    return End(here, float(charge[before] + share * step), float(abs(step)), False, crossed)


def _full_at_rest(record: BatteryRecord, stroke: Stroke, upper_v: float) -> End | None:
    volts = record.voltage_v[stroke.begin : stroke.end]
    if stroke.begin > 0 or not np.isfinite(volts).any():
        return None
    last = float(volts[np.isfinite(volts)][-1])
    return End(stroke.end - 1, 0.0, 0.0, True, last, taken=True) if last >= upper_v else None
