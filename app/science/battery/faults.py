"""Sensors that are stuck: frozen, clipped, or hit by a spike. What they wrote is taken out, and it is said."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from app.science.arrays import BoolArray, FloatArray, IntArray
from app.science.battery.config import BatteryConfig
from app.science.battery.record import BatteryRecord
from app.science.battery.repeats import without_repeats
from app.science.battery.response import Response, quantum, thinned
from app.science.battery.strokes import charge_ah
from app.science.battery.stuck import Screened, least_ohm, members, picked, runs, without_stuck_currents
from app.science.battery.swings import LONG_RUN, repeats_by_itself, swings
from app.science.battery.words import counted, duration
from app.science.errors import SignalsError

LEAST_RUN = 4
"""Rows of one value in a row, from which on they may be a sensor that is stuck."""
EACH_WAY = 2
"""Steps up and steps down that must have gone unanswered: a charger holds a voltage while its current only falls."""
QUANTA = 3.0
SEEN_V = 0.004
"""A step that must be seen moves the voltage of one cell by so much and by three of the sensor's smallest steps."""
NEARLY_ALL = 0.9
SPIKE_TIMES, SPIKE_SHARE = 5.0, 0.002
"""A spike is so many times the usual largest current, and rare."""
SEEN_SHARE = 0.01
"""Of the capacity: the voltage does not stand still while so much charge flows one way."""
FALLING = 0.8
ANSWERED = 0.2
"""Share of the expected step from which on the voltage has answered, and a spike was real."""


def screened(record: BatteryRecord, config: BatteryConfig, response: Response) -> Screened:
    """Return the record without repeated rows, and frozen and clipped values.

    Raises
    ------
    SignalsError
        When a sensor was stuck nearly all the time.
    """
    repeated = without_repeats(record)
    record = _without_stuck_voltages(repeated.record, config, response)
    found = without_stuck_currents(record, config, response)
    return Screened(found.record, (*repeated.unknown_from_s, *found.unknown_from_s))


def without_spikes(record: BatteryRecord, config: BatteryConfig, response: Response) -> BatteryRecord:
    """Return the record without single wild currents that the voltage does not answer."""
    amps = np.abs(record.current_a)
    usual = float(np.quantile(thinned(amps), 1.0 - SPIKE_SHARE))
    rows = np.flatnonzero(amps > SPIKE_TIMES * max(usual, 1e-6))
    rows = rows[(rows > 0) & (rows < len(amps) - 1)]
    step_v = np.abs(record.voltage_v[rows] - record.voltage_v[rows - 1])
    expected_v = least_ohm(config, response) * np.abs(record.current_a[rows] - record.current_a[rows - 1])
    rows = rows[np.isnan(step_v) | (step_v < ANSWERED * expected_v)]
    if len(rows) == 0:
        return record
    said = (
        f"{counted(len(rows), 'row')} with a current up to {amps[rows].max():.4g} A that the voltage does not answer, "
        f"left out (first: {record.t_s[rows[0]]:g} s): the current before is taken to flow on."
    )
    return picked(record, np.delete(np.arange(len(amps)), rows), said)


def _without_stuck_voltages(record: BatteryRecord, config: BatteryConfig, response: Response) -> BatteryRecord:
    volts, known = record.voltage_v, np.flatnonzero(np.isfinite(record.voltage_v))
    if len(known) < LEAST_RUN:
        return record
    seen_v = max(SEEN_V * config.cell.series, QUANTA * quantum(volts))
    needed_a = seen_v / least_ohm(config, response)
    begins, ends = runs(volts[known])
    steps = np.diff(record.current_a[known])
    up = np.concatenate([[0], np.cumsum(steps > needed_a)])
    down = np.concatenate([[0], np.cumsum(steps < -needed_a)])
    stuck = (up[ends - 1] - up[begins] >= EACH_WAY) & (down[ends - 1] - down[begins] >= EACH_WAY)
    stuck |= (swings(record.current_a[known], begins, ends, needed_a) >= 2 * EACH_WAY) & (ends - begins >= LONG_RUN)
    stuck |= _clipped(volts[known], begins, ends, up, down)
    stuck |= _held_at_the_end(record, known, begins, ends, config)
    bad = known[members(begins[stuck], ends[stuck])]
    if len(bad) == 0:
        return record
    longest = int(np.argmax(np.where(stuck, ends - begins, 0)))
    value, first = volts[known[begins[longest]]], record.t_s[known[begins[longest]]]
    if len(bad) > NEARLY_ALL * len(known):
        raise SignalsError(
            f"voltage_v stands still at {value:.4g} V while the current changes: the sensor is stuck in "
            f"{len(bad) / len(known):.0%} of the rows. Nothing can be told without a voltage.",
            field="voltage_v",
        )
    said = (
        f"The voltage stands still in {counted(len(bad), 'row')} while the current changes (longest: at {value:.4g} V "
        f"from {first:g} s on for {duration(record.t_s[known[ends[longest] - 1]] - first)}): a frozen or clipped "
        "sensor. Charge is counted there, and nothing is learnt."
    )
    return replace(
        record,
        voltage_v=np.where(np.isin(np.arange(len(volts)), bad), np.nan, volts),
        warnings=(*record.warnings, said),
    )


def _clipped(volts: FloatArray, begins: IntArray, ends: IntArray, up: IntArray, down: IntArray) -> BoolArray:
    """Tell which runs stand at the record's highest or lowest voltage, if these go against the current all together."""
    result = np.zeros(len(begins), dtype=np.bool_)
    for extreme in (volts.max(), volts.min()):
        there = (volts[begins] == extreme) & (ends - begins >= 2)
        ups, downs = ((of[ends[there] - 1] - of[begins[there]]).sum() for of in (up, down))
        if there.sum() > 1 and min(ups, downs) >= 2 * EACH_WAY:
            result |= there
    return result


def _held_at_the_end(
    record: BatteryRecord, known: IntArray, begins: IntArray, ends: IntArray, config: BatteryConfig
) -> BoolArray:
    """Tell which runs stand at an extreme voltage that was held under charge for longer than noise lets any."""
    if repeats_by_itself(begins, ends):
        return np.zeros(len(begins), dtype=np.bool_)
    volts, charge = record.voltage_v[known], charge_ah(record)
    half = known[(begins + ends) // 2]
    first, second = np.abs(charge[half] - charge[known[begins]]), np.abs(charge[known[ends - 1]] - charge[half])
    capacity = config.cell.circuit.capacity_ah * config.cell.parallel
    at_an_end = np.isin(volts[begins], (volts.max(), volts.min()))
    held = at_an_end & (ends - begins >= LONG_RUN) & (first + second > SEEN_SHARE * capacity)
    held &= second > FALLING * first  # a charger that holds a voltage lets its current fall
    return np.isin(volts[begins], volts[begins[held]])
