"""Records of laboratory cyclers, whose rows tell what has flowed, made into records that tell what flows."""

from __future__ import annotations

import numpy as np

from app.science.arrays import FloatArray
from app.science.battery.record import BatteryRecord

AFTER = 1e-3
"""Part of an interval after which the next row's current is said to begin; the row's own voltage stays before it."""

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
    now, later = record.current_a[:-1], record.current_a[1:]
    gradual = np.abs(later - now) <= SLOW_CHANGE * np.minimum(np.abs(now), np.abs(later))
    flowing = np.where(gradual & (now * later > 0.0), 0.5 * (now + later), later)
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
