"""Capacities measured outright: full discharges and charges between the cell's two ends."""

from __future__ import annotations

from dataclasses import dataclass
from itertools import pairwise
from typing import Literal

import numpy as np

from app.science.battery.record import BatteryRecord
from app.science.battery.strokes import End, ends, strokes, voltage_limits

GAIN_SD = 0.002
"""Share by which a current sensor's scale is thought to be off."""

STEP_SHARE = 12.0**-0.5
"""Standard deviation of a place known to lie somewhere in a step, as a share of the step."""


@dataclass(frozen=True, slots=True)
class CapacityTest:
    """One capacity, counted between two ends.

    Attributes
    ----------
    t_s : float
        When it was finished, in the record's time.
    capacity_ah, sd_ah : float
        Of the pack, with the standard deviation that the sensor's scale, its zero while resting, and the rows' distance
        leave.
    direction : str
        ``discharge`` or ``charge``.
    from_v, to_v : float
        Voltages of its ends.
    current_a : float
        Mean current while it flowed, its size: capacities depend on it.
    temperature_c : float or None
        Mean temperature.
    """

    t_s: float
    capacity_ah: float
    sd_ah: float
    direction: Literal["charge", "discharge"]
    from_v: float
    to_v: float
    current_a: float
    temperature_c: float | None = None


def capacity_tests(record: BatteryRecord, limits_v: tuple[float, float] | None = None) -> tuple[CapacityTest, ...]:
    """Find all full discharges and charges of a record, in order.

    Parameters
    ----------
    record : BatteryRecord
    limits_v : tuple of float, optional
        Voltages at which the pack counts as empty and as full. Without them, those the record keeps to; then only a
        charge whose current has tapered says that the pack was full.
    """
    found = ends(record, limits_v or voltage_limits(record))
    known = [end for end in found if limits_v is not None or not end.taken]
    return tuple(_test(record, first, last) for first, last in pairwise(known) if first.full != last.full)


def _test(record: BatteryRecord, first: End, last: End) -> CapacityTest:
    rows = slice(first.row, last.row + 1)
    current, duration_s = record.current_a[rows], np.diff(record.t_s[rows])
    flowing = np.abs(current[:-1]) > 0.02 * np.abs(current).max()
    moved = last.charge_ah - first.charge_ah
    lasted_h = float(duration_s[flowing].sum()) / 3600.0
    unknown = [GAIN_SD * moved, STEP_SHARE * first.step_ah, STEP_SHARE * last.step_ah, _zero_a(record) * lasted_h]
    warmth = None if record.temperature_c is None else float(np.nanmean(record.temperature_c[rows]))
    return CapacityTest(
        t_s=float(record.t_s[last.row]),
        capacity_ah=abs(moved),
        sd_ah=float(np.linalg.norm(unknown)),
        direction="discharge" if first.full else "charge",
        from_v=first.voltage_v,
        to_v=last.voltage_v,
        current_a=float(np.average(np.abs(current[:-1][flowing]), weights=duration_s[flowing])) if lasted_h else 0.0,
        temperature_c=warmth,
    )


def _zero_a(record: BatteryRecord) -> float:
    """Return what the current sensor shows while nothing should flow, amperes; zero for a record without rest."""
    resting = [record.current_a[one.begin : one.end] for one in strokes(record) if one.direction == 0]
    return float(abs(np.mean(np.concatenate(resting)))) if resting else 0.0
