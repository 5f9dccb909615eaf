"""Currents that stand still while the voltage shows that they don't, and what searching for stuck sensors shares."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from app.science.arrays import AnyArray, BoolArray, FloatArray, IntArray
from app.science.battery.config import BatteryConfig
from app.science.battery.record import BatteryRecord
from app.science.battery.response import Response, quantum, thinned
from app.science.battery.swings import LONG_RUN, swings
from app.science.battery.words import counted, duration
from app.science.errors import SignalsError

CAREFUL = 3.0
"""The resistance may be so many times smaller than it is thought to be."""
LEAST_RUN = 5
EACH_WAY = 3
"""Steps up and steps down of the voltage under one current: the end of a charge goes one way only."""
LEAST_SHARE = 0.003
NOISES, QUANTA, SEEN_V = 6.0, 3.0, 0.004
"""A step is seen when it is so many times the noise, the sensor's smallest steps, and so many volts of a cell."""
OF_OTHERS = 0.2
"""… and so much of what the voltage does where the current changes."""
NEARLY_ALL = 0.9
BLOCK = 5
"""Rows over which a voltage is averaged where nothing else tells its noise."""
DRIFT, CERTAIN = 101, 4.0
"""Rows over which a voltage's drift is followed, and how many times its noise a swing is away from that each time."""


@dataclass(frozen=True, slots=True)
class Screened:
    """A record without what stuck sensors wrote.

    Attributes
    ----------
    record : BatteryRecord
    unknown_from_s : tuple of float
        Times of rows after which the current is not known until the next row, because its sensor was stuck.
    """

    record: BatteryRecord
    unknown_from_s: tuple[float, ...] = ()


def without_stuck_currents(record: BatteryRecord, config: BatteryConfig, response: Response) -> Screened:
    """Return the record without rows whose current stands still while the voltage goes up and down.

    Rows of a frozen current are left out, and the current is unknown until the next one. At a clipped current the
    charge is known to be larger than counted; its rows keep it, and lose their voltage.

    Raises
    ------
    SignalsError
        When the current's sensor was stuck nearly all the time.
    """
    amps, series = record.current_a, config.cell.series
    if np.ptp(amps) == 0.0:
        _refuse_dead(record, series)
        return Screened(record)
    begins, ends = runs(amps)
    up, down = _seen_steps(record, response, series, begins, ends)
    swung, level = _seen_swings(record, response, series, begins, ends)
    frozen = _goes_both_ways(ends - begins, up, down) & (ends - begins >= LEAST_RUN)
    frozen |= (level >= 2 * EACH_WAY) & (level >= LEAST_SHARE * (ends - begins)) & (ends - begins >= LONG_RUN)
    if (ends - begins)[frozen].sum() > NEARLY_ALL * len(amps):
        value = amps[begins[int(np.argmax(ends - begins))]]
        raise _dead(value, record)
    clipped = _clipped(amps, begins, ends, up, down, swung)
    frozen &= ~clipped
    return _without_frozen(_without_clipped(record, begins, ends, clipped), begins, ends, frozen)


def least_ohm(config: BatteryConfig, response: Response) -> float:
    """Return a resistance of the pack that the true one is hardly below."""
    cell = config.cell
    thought = cell.circuit.resistance_ohm * cell.series / cell.parallel
    seen = abs(response.ohm) if abs(response.certainty) > CAREFUL else thought
    return min(thought, seen) / CAREFUL


def runs(values: AnyArray) -> tuple[IntArray, IntArray]:
    """Return where each run of one value begins, and where the next one does."""
    begins = np.flatnonzero(np.concatenate([[True], np.diff(values) != 0.0])).astype(np.int64)
    return begins, np.append(begins[1:], len(values)).astype(np.int64)


def members(begins: IntArray, ends: IntArray) -> IntArray:
    """Return all rows of some runs."""
    return np.concatenate([np.arange(0), *(np.arange(a, b) for a, b in zip(begins, ends, strict=True))]).astype(
        np.int64
    )


def picked(record: BatteryRecord, rows: IntArray | BoolArray, said: str) -> BatteryRecord:
    """Return some rows of a record, and say why."""
    temperature = None if record.temperature_c is None else record.temperature_c[rows]
    return replace(
        record,
        t_s=record.t_s[rows],
        current_a=record.current_a[rows],
        voltage_v=record.voltage_v[rows],
        temperature_c=temperature,
        warnings=(*record.warnings, said),
    )


def _seen_steps(
    record: BatteryRecord, response: Response, series: int, begins: IntArray, ends: IntArray
) -> tuple[IntArray, IntArray]:
    """Return how often the voltage steps up and down inside each run by more than noise."""
    volts = record.voltage_v
    # the middle one of three rows: a single row's spike is no step
    low, high = np.minimum(np.roll(volts, 1), np.roll(volts, -1)), np.maximum(np.roll(volts, 1), np.roll(volts, -1))
    steps = np.diff(np.maximum(np.minimum(volts, high), low))
    others = np.abs(steps[(np.diff(record.current_a) != 0.0) & np.isfinite(steps)])
    usual = float(np.quantile(thinned(others), 0.9)) if len(others) else np.inf
    needed = max(SEEN_V * series, NOISES * response.noise_v, QUANTA * quantum(volts), OF_OTHERS * usual)
    ups, downs = (np.concatenate([[0], np.cumsum(way * steps > needed)]) for way in (1.0, -1.0))
    return ups[ends - 1] - ups[begins], downs[ends - 1] - downs[begins]


def _seen_swings(
    record: BatteryRecord, response: Response, series: int, begins: IntArray, ends: IntArray
) -> tuple[IntArray, IntArray]:
    """Return how often the voltage goes to and fro inside each run, without its noise; and without its slow drift."""
    from scipy.ndimage import uniform_filter1d  # for workers, as all that looks through records

    known = np.isfinite(record.voltage_v)
    if not known.any():
        return np.zeros_like(begins), np.zeros_like(begins)
    rows = np.arange(len(known))
    volts = np.interp(rows, rows[known], record.voltage_v[known])
    smooth, slow = (uniform_filter1d(volts, width, mode="nearest") for width in (BLOCK, DRIFT))
    wide = max(SEEN_V * series, 2.0 * CERTAIN * response.noise_v / BLOCK**0.5, QUANTA * quantum(record.voltage_v))
    from_edge = np.minimum(rows - np.repeat(begins, ends - begins), np.repeat(ends - 1, ends - begins) - rows)
    plain, level = (
        swings(np.where(known & (from_edge >= width // 2), column, np.nan), begins, ends, wide)
        for width, column in ((BLOCK, smooth), (DRIFT, smooth - slow))
    )
    return plain, level


def _goes_both_ways(rows: IntArray, up: IntArray, down: IntArray) -> BoolArray:
    return np.asarray((np.minimum(up, down) >= EACH_WAY) & (up + down >= LEAST_SHARE * rows))


def _clipped(
    amps: FloatArray, begins: IntArray, ends: IntArray, up: IntArray, down: IntArray, swung: IntArray
) -> BoolArray:
    """Tell which runs stand at the largest or smallest current, if the voltage goes both ways there all together."""
    result = np.zeros(len(begins), dtype=np.bool_)
    for extreme in (amps.max(), amps.min()):
        there = (amps[begins] == extreme) & (ends - begins >= 2)
        rows = (ends - begins)[there].sum()
        to_and_fro = np.maximum(swung[there] - 1, 0).sum()
        steps = there.any() and _goes_both_ways(rows, up[there].sum(), down[there].sum())
        if steps or (to_and_fro >= 2 * EACH_WAY and to_and_fro >= LEAST_SHARE * rows):
            result |= there
    return result


def _without_clipped(record: BatteryRecord, begins: IntArray, ends: IntArray, clipped: BoolArray) -> BatteryRecord:
    rows = members(begins[clipped], ends[clipped])
    if len(rows) == 0:
        return record
    values = " and ".join(f"{value:.4g} A" for value in np.unique(record.current_a[rows]))
    said = (
        f"The current stands at its extreme value, {values}, in {counted(len(rows), 'row')} while the voltage goes on "
        "changing: a clipped sensor. The charge is counted too small there: do not trust the capacity."
    )
    volts = np.where(np.isin(np.arange(len(record.t_s)), rows), np.nan, record.voltage_v)
    return replace(record, voltage_v=volts, warnings=(*record.warnings, said))


def _without_frozen(record: BatteryRecord, begins: IntArray, ends: IntArray, frozen: BoolArray) -> Screened:
    return without_runs(
        record,
        begins[frozen],
        ends[frozen],
        "The current stands still",
        "the voltage goes up and down: a frozen sensor",
    )


def without_runs(record: BatteryRecord, begins: IntArray, ends: IntArray, what: str, why: str) -> Screened:
    """Return the record without some runs but for the first row of each, after which the current is not known."""
    if len(begins) == 0:
        return Screened(record)
    longest = int(np.argmax(ends - begins))
    left_out = members(begins + 1, ends)
    begin, value = float(record.t_s[begins[longest]]), record.current_a[begins[longest]]
    lasting = duration(float(record.t_s[ends[longest] - 1]) - begin)
    said = (
        f"{what} at {value:.4g} A from {begin:g} s on for {lasting} while {why}. "
        f"{counted(len(left_out), 'row')} of such stretches {'was' if len(left_out) == 1 else 'were'} left out; what "
        "flowed there is not known."
    )
    kept = ~np.isin(np.arange(len(record.t_s)), left_out)
    return Screened(picked(record, kept, said), tuple(record.t_s[begins].tolist()))


def _refuse_dead(record: BatteryRecord, series: int) -> None:
    """Refuse a current that never changes while the voltage goes up and down by more than any noise."""
    volts = record.voltage_v[np.isfinite(record.voltage_v)]
    blocks = volts[: len(volts) // BLOCK * BLOCK].reshape(-1, BLOCK).mean(axis=1)
    steps = np.diff(blocks)
    up, down = (np.asarray(np.sum(way * steps > 2.0 * SEEN_V * series)) for way in (1.0, -1.0))
    if _goes_both_ways(np.asarray(len(blocks)), up, down):
        raise _dead(float(record.current_a[0]), record)


def _dead(value: float, record: BatteryRecord) -> SignalsError:
    low, high = np.nanmin(record.voltage_v), np.nanmax(record.voltage_v)
    return SignalsError(
        f"current_a stands still at {value:.4g} A while the voltage goes up and down between {low:.4g} and {high:.4g} "
        "V: its sensor is stuck or not connected. Nothing can be told without a current.",
        field="current_a",
    )
