"""Loggers that hang: the same row over and over, where nothing else stands still."""

from __future__ import annotations

import numpy as np

from app.science.battery.record import BatteryRecord
from app.science.battery.stuck import Screened, without_runs

LEAST_ROWS = 30
MOST_SAME_AMPS, MOST_SAME_VOLTS = 0.2, 0.6
"""Shares of the other rows with the current, and the voltage, of the row before: where more do, thirty may do so."""


def without_repeats(record: BatteryRecord) -> Screened:
    """Return the record without rows that repeat the one before in current and voltage, many in a row.

    A battery at rest, or rounded values of a constant current, may be as still as that: nothing is taken for repeated
    where the current is zero, or where single values repeat elsewhere, too.
    """
    same_amps, same_volts = np.diff(record.current_a) == 0.0, np.diff(record.voltage_v) == 0.0
    changes = np.flatnonzero(np.concatenate([[True], ~(same_amps & same_volts)])).astype(np.int64)
    ends = np.append(changes[1:], len(record.t_s)).astype(np.int64)
    long = (ends - changes >= LEAST_ROWS) & (record.current_a[changes] != 0.0)
    if not long.any():
        return Screened(record)
    inside = np.zeros(len(same_amps), dtype=np.bool_)
    for begin, end in zip(changes[long], ends[long], strict=True):
        inside[begin : end - 1] = True
    others = ~inside
    if same_amps[others].mean() > MOST_SAME_AMPS or same_volts[others].mean() > MOST_SAME_VOLTS:
        return Screened(record)
    return without_runs(
        record, changes[long], ends[long], "The same row is repeated", "no other rows are alike: the logger hung"
    )
