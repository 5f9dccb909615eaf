"""The battery's signals of a trip's recording as a battery's record."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from app.science.arrays import FloatArray
from app.science.battery.cleaning import Rows, clean
from app.science.battery.record import BatteryRecord
from app.science.logger.recording import Recording, Series

CURRENT, VOLTAGE = "battery_current_a", "battery_voltage_v"


def has_battery(recording: Recording) -> bool:
    """Tell whether a recording holds what a battery's state is told from."""
    return CURRENT in recording and VOLTAGE in recording


def record_of(recording: Recording) -> BatteryRecord:
    """Return a recording's current and voltage as a record; the two may have been sampled at different times.

    A row stands at every time of either signal. The current is the last one measured; the voltage is there only where
    one was measured. Rows before the first current are left out.

    Parameters
    ----------
    recording : Recording
        One that `has_battery`.

    Raises
    ------
    SignalsError
        When less than two rows can be used.
    """
    current, voltage = recording.signals[CURRENT], recording.signals[VOLTAGE]
    t_s = np.union1d(current.t_s, voltage.t_s)
    t_s = t_s[t_s >= current.t_s[0]]
    measured = _at(voltage, t_s)
    rows = Rows(t_s, _held(current, t_s), measured, None, np.arange(1, len(t_s) + 1))
    record = clean(rows)
    if np.array_equal(current.t_s, voltage.t_s):
        return record
    said = "Current and voltage were not sampled together; each voltage goes with the current before it."
    return replace(record, warnings=(said,))  # a row without a voltage is no fault here


def _held(series: Series, t_s: FloatArray) -> FloatArray:
    return np.asarray(series.value[np.searchsorted(series.t_s, t_s, side="right") - 1])


def _at(series: Series, t_s: FloatArray) -> FloatArray:
    place = np.minimum(np.searchsorted(series.t_s, t_s), len(series.t_s) - 1)
    return np.where(series.t_s[place] == t_s, series.value[place], np.nan)
