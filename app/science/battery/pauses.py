"""Holes in a record through which nobody knows what current flowed."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from app.science.arrays import BoolArray, FloatArray, IntArray
from app.science.battery.carrying import between, open_soc
from app.science.battery.config import BatteryConfig
from app.science.battery.curve import soc_at, voltage_at
from app.science.battery.record import BatteryRecord
from app.science.battery.run import Carry
from app.science.battery.words import duration

LONG_S, LONG_STEPS = 60.0, 20.0
"""A hole lasts longer than either: in seconds, and in usual steps."""
REST_SHARE = 0.02
"""Share of the usual current below which a battery rests, and to which two currents are the same."""
JUMP_V = 0.02
"""A rest over which a cell's voltage changes by more, beyond what relaxation explains, was no rest."""
AROUND = (-2, -1, 0, 1, 2, 3)
"""Rows before and after a gap that must have the same current."""
OFF_SHARE = 0.3
"""Share by which the voltage's rise over a gap may differ from the configured cell's."""
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
    battery rests on both sides, or has rested for a minute before, and its voltage afterwards agrees; or the current is
    the same afterwards and the voltage agrees, as when a laboratory logs a constant current now and then. Otherwise a
    gap of over a minute and of twenty usual steps is a hole, and so is what follows a row at ``unknown_from_s``.
    """
    step = np.diff(record.t_s)
    stuck = np.isin(record.t_s[:-1], unknown_from_s)
    long = np.flatnonzero(stuck | _is_long(step)).astype(np.int64)
    if len(long) == 0:
        return ()
    current = record.current_a
    size = float(np.sqrt(np.mean(current**2)))
    same = _goes_on(record, config, long, REST_SHARE * size)
    rest = _rests(record, long, REST_SHARE * size)
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
    """Say where the gaps are, and what is taken to have flowed in them."""
    step, unknown = np.diff(record.t_s), np.array([hole.before for hole in holes], dtype=np.int64)
    bridged = np.setdiff1d(np.flatnonzero(_is_long(step)), unknown)
    told = []
    if len(unknown):
        told.append(
            f"{_gaps(record, step, unknown)}, during which an unknown current flowed: the state of charge is taken as "
            f"less certain after {'each' if len(unknown) > 1 else 'it'}, and what flowed meanwhile is not counted."
        )
    if len(bridged):
        told.append(
            f"{_gaps(record, step, bridged)}, in which the current before is taken to have flowed on: what comes after "
            "agrees with that."
        )
    return tuple(told)


def _gaps(record: BatteryRecord, step: FloatArray, rows: IntArray) -> str:
    longest = int(rows[np.argmax(step[rows])])
    where = f"{duration(float(step[longest]))} from {record.t_s[longest]:g} s on"
    return f"1 gap of {where}" if len(rows) == 1 else f"{len(rows)} gaps, the longest {where}"


def _is_long(step: FloatArray) -> BoolArray:
    return np.asarray(step > max(LONG_S, LONG_STEPS * float(np.median(step))))


def _rests(record: BatteryRecord, rows: IntArray, room_a: float) -> BoolArray:
    """Tell after which rows the battery rests: no current on both sides, or none for a minute before."""
    busy = np.abs(record.current_a) > room_a
    row = np.arange(len(busy))
    last_busy = np.maximum.accumulate(np.where(busy, row, 0))[rows]
    rested = record.t_s[rows] - record.t_s[last_busy] >= LONG_S
    return np.asarray(~busy[rows] & (rested | ~busy[rows + 1]))


def _goes_on(record: BatteryRecord, config: BatteryConfig, rows: IntArray, room_a: float) -> BoolArray:
    """Tell after which rows the same current may have gone on: it is steady on both sides, and the voltage agrees."""
    cell, amps = config.cell, record.current_a
    around = np.clip(rows[:, None] + np.array(AROUND), 0, len(amps) - 1)
    steady = np.ptp(amps[around], axis=1) <= np.maximum(REST_SHARE * np.abs(amps[rows]), room_a)
    at_rest = record.voltage_v / cell.series - cell.circuit.resistance_ohm * amps / cell.parallel
    moved = amps[rows] / cell.parallel * (record.t_s[rows + 1] - record.t_s[rows]) / cell.circuit.capacity_as
    begun = soc_at(cell.curve, at_rest[rows])
    rise = voltage_at(cell.curve.pieces, begun + moved) - voltage_at(cell.curve.pieces, begun)
    off = np.abs(at_rest[rows + 1] - at_rest[rows] - rise)
    return np.asarray(steady & ~(off > JUMP_V + OFF_SHARE * np.abs(rise)))


def _charged_unseen(record: BatteryRecord, config: BatteryConfig, rows: IntArray) -> BoolArray:
    """Tell after which rows the voltage has changed by more than a rest explains."""
    cell, volts = config.cell, record.voltage_v / config.cell.series
    ohm, settling = cell.circuit.resistance_ohm, cell.circuit.relaxation_resistance_ohm
    amps = record.current_a / cell.parallel
    jump = volts[rows + 1] - volts[rows] - ohm * (amps[rows + 1] - amps[rows])
    relaxing = 1.5 * settling * float(np.max(np.abs(amps)))
    return np.asarray(np.abs(jump) > JUMP_V + relaxing)
