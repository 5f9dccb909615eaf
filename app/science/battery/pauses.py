"""Holes in a record through which nobody knows what current flowed."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from app.science.arrays import BoolArray, IntArray
from app.science.battery.carrying import between, open_soc
from app.science.battery.config import BatteryConfig
from app.science.battery.record import BatteryRecord
from app.science.battery.run import Carry
from app.science.battery.words import counted, duration

LONG_S, LONG_STEPS = 60.0, 20.0
"""A hole lasts longer than either: in seconds, and in usual steps."""
REST_SHARE = 0.02
"""Share of the usual current below which a battery rests, and to which two currents are the same."""
JUMP_V = 0.02
"""A rest over which a cell's voltage changes by more, beyond what relaxation explains, was no rest."""
MOST_HOLES = 30
LEAST_SD, MOST_SD = 0.01, 0.3


@dataclass(frozen=True, slots=True)
class Hole:
    """A hole between row ``before`` and the next one; ``soc_sd`` is what the charge may have moved by."""

    before: int
    gap_s: float
    soc_sd: float


def find_holes(
    record: BatteryRecord, config: BatteryConfig, unknown_from_s: tuple[float, ...] = ()
) -> tuple[Hole, ...]:
    """Return where the current between two rows is not known, in order; of very many the ones that matter most.

    A row's current flows until the next row, however long that takes, as long as there is reason to think so: the
    battery rests and its voltage afterwards agrees, or the current is the same afterwards, as when a laboratory logs a
    constant current now and then. Otherwise a gap of over a minute and of twenty usual steps is a hole, and so is what
    follows a row at ``unknown_from_s``.
    """
    step = np.diff(record.t_s)
    usual = float(np.median(step))
    stuck = np.isin(record.t_s[:-1], unknown_from_s)
    long = np.flatnonzero(stuck | (step > max(LONG_S, LONG_STEPS * usual))).astype(np.int64)
    if len(long) == 0:
        return ()
    current = record.current_a
    size = float(np.sqrt(np.mean(current**2)))
    before, after = current[long], current[long + 1]
    same = np.abs(after - before) <= REST_SHARE * np.maximum(np.abs(before), size)
    rest = np.abs(before) <= REST_SHARE * size
    unseen = rest & _charged_unseen(record, config, long)
    cell = config.cell
    moved = size / cell.parallel * step[long] / cell.circuit.capacity_as
    sd = np.where(unseen, MOST_SD, np.clip(moved, LEAST_SD, MOST_SD))
    holes = [
        Hole(int(row), float(step[row]), float(one))
        for row, one, known in zip(long, sd, (same | rest) & ~unseen, strict=True)
        if not known or stuck[row]
    ]
    worst = sorted(holes, key=lambda hole: -hole.soc_sd)[:MOST_HOLES]
    return tuple(sorted(worst, key=lambda hole: hole.before))


def across(carry: Carry, hole: Hole, config: BatteryConfig) -> Carry:
    """Return what is still known after a hole: as after any pause, and the charge has moved by something."""
    return open_soc(between(carry, hole.gap_s, config), hole.soc_sd)


def words_of(record: BatteryRecord, holes: tuple[Hole, ...]) -> tuple[str, ...]:
    """Say where the holes are."""
    if not holes:
        return ()
    longest = max(holes, key=lambda hole: hole.gap_s)
    return (
        f"{counted(len(holes), 'gap')} in the data during which an unknown current flowed, the longest "
        f"{duration(longest.gap_s)} from {record.t_s[longest.before]:g} s on: the state of charge is taken as less "
        "certain after each, and the charge that flowed meanwhile is not counted.",
    )


def _charged_unseen(record: BatteryRecord, config: BatteryConfig, rows: IntArray) -> BoolArray:
    """Tell after which rows the voltage has changed by more than a rest explains."""
    cell, volts = config.cell, record.voltage_v / config.cell.series
    ohm, settling = cell.circuit.resistance_ohm, cell.circuit.relaxation_resistance_ohm
    amps = record.current_a / cell.parallel
    jump = volts[rows + 1] - volts[rows] - ohm * (amps[rows + 1] - amps[rows])
    relaxing = 2.0 * (ohm + settling) * float(np.max(np.abs(amps)))
    return np.asarray(np.abs(jump) > JUMP_V + relaxing)
