"""Records of laboratory cyclers, whose rows tell what has flowed, made into records that tell what flows."""

from __future__ import annotations

import numpy as np

from app.science.arrays import FloatArray
from app.science.battery.record import BatteryRecord

AFTER = 1e-3
"""Part of an interval after which the next row's current is said to begin; the row's own voltage stays before it."""

COUNTER_STEP_AH = 0.01
"""Digit to which cyclers tell their count of charge; smaller differences say nothing."""

MANY_TIMES = 4.0
"""How much better, in squares, one reading of the rows must explain the counter than the other."""

SLOW_CHANGE = 0.3
"""Share of the current up to which a change is taken as gradual, as while a voltage is held."""


def held_from_logged(record: BatteryRecord) -> BatteryRecord:
    """Return a record whose currents flow from their rows on, of one whose rows tell what flowed up to them.

    A cycler writes a row at the end of an interval: its current has flowed since the row before, its voltage is under
    that current. Taken as currents that flow from the row on, a discharge's last row would flow through all of the
    first, often long, interval of the rest that follows. Where the current changes, a row without a voltage is put in
    just behind the earlier one; where it glides, the mean of both rows is what flows between them.

    Parameters
    ----------
    record : BatteryRecord
        As logged.
    """
    now, flowing = record.current_a[:-1], flowed(record.current_a)
    changes = np.flatnonzero(np.abs(flowing - now) > 0.0)
    begins = record.t_s[changes] + AFTER * np.diff(record.t_s)[changes]
    places = changes + 1

    def filled(values: FloatArray, into: FloatArray | float) -> FloatArray:
        return np.insert(values, places, into)

    warmth = record.temperature_c
    return BatteryRecord(
        filled(record.t_s, begins),
        filled(record.current_a, flowing[changes]),
        filled(record.voltage_v, np.nan),
        None if warmth is None else filled(warmth, warmth[changes]),
        record.warnings,
    )


def tells_the_past(t_s: FloatArray, current_a: FloatArray, counter_ah: FloatArray) -> bool:
    """Tell from a cycler's own count of charge whether its rows tell the current that has flowed up to them.

    Only intervals count over which both readings differ by more than the counter's digits, as at the end of a
    discharge, before the first, late row of a rest; and in which the counter was not set back.

    Parameters
    ----------
    t_s, current_a, counter_ah : ndarray (n,)
        As logged; the counter in ampere-hours.
    """
    hours, counted = np.diff(t_s) / 3600.0, np.abs(np.diff(counter_ah))
    as_past, as_future = np.abs(flowed(current_a)) * hours, np.abs(current_a[:-1]) * hours
    telling = np.abs(as_past - as_future) > COUNTER_STEP_AH
    telling &= counted <= np.maximum(as_past, as_future) + COUNTER_STEP_AH
    if not telling.any():
        return False
    off_past = float(np.sum((counted - as_past)[telling] ** 2))
    off_future = float(np.sum((counted - as_future)[telling] ** 2))
    return off_future > MANY_TIMES * max(off_past, int(telling.sum()) * COUNTER_STEP_AH**2 / 6.0)


def flowed(current_a: FloatArray) -> FloatArray:
    """Return what flowed before each row but the first, (n − 1,), of currents that were logged at its end.

    Where the current glides, as while a voltage is held, that is the mean of both rows.
    """
    now, later = current_a[:-1], current_a[1:]
    gradual = np.abs(later - now) <= SLOW_CHANGE * np.minimum(np.abs(now), np.abs(later))
    return np.asarray(np.where(gradual & (now * later > 0.0), 0.5 * (now + later), later))
