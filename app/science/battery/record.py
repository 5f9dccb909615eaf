"""Measurements of a battery, ready to be worked with."""

from __future__ import annotations

from dataclasses import dataclass

from app.science.arrays import FloatArray


@dataclass(frozen=True, slots=True)
class BatteryRecord:
    """Current and voltage over time, in order, finite, without double times.

    A row's current flows from its time to the next row's. Its voltage is at its own time: it holds the row's own
    current in the series resistance, but neither charge nor relaxation have moved by it yet.

    Attributes
    ----------
    t_s : ndarray (n,)
        Strictly ascending, seconds.
    current_a : ndarray (n,)
        Charging is positive.
    voltage_v : ndarray (n,)
        NaN in rows without a voltage worth believing: charge is counted there, nothing is learnt.
    temperature_c : ndarray (n,) or None
    warnings : tuple of str
        What was noticed and what was done about it, in words.
    started_at_utc_s : float or None
        UTC at time zero, seconds since 1970, where it is known.
    """

    t_s: FloatArray
    current_a: FloatArray
    voltage_v: FloatArray
    temperature_c: FloatArray | None = None
    warnings: tuple[str, ...] = ()
    started_at_utc_s: float | None = None
