"""Whether a record can be of the battery it is said to be of: units, cells in series and parallel, the curve."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from app.science.arrays import FloatArray
from app.science.battery.circuit import AS_PER_AH
from app.science.battery.config import BatteryConfig
from app.science.battery.record import BatteryRecord
from app.science.battery.response import Response
from app.science.battery.words import counted, duration
from app.science.errors import SignalsError

FAR_SHARE, FAR_V = 0.3, 0.02
"""A usual voltage is not the curve's when it lies outside by so much of its span, and of its height."""
OUTSIDE_SHARE = 0.02
"""Share of the rows outside the curve from which on it is said."""
LOST_V = 1.0
"""Rows further outside the curve than this much more than its span can't be of this cell at all."""
BLOCK_S = 12 * 3600.0
"""A charge is counted over at most so long: over days, the sensor's error alone may add up to more than there is."""
FULL, ABSURD = 1.3, 5.0
"""Capacities that may be moved one way: more is said, and refused."""
SLOW = 3.0


def with_plausible_voltage(record: BatteryRecord, config: BatteryConfig, response: Response) -> BatteryRecord:
    """Return the record without voltages that can't be this battery's, with what was noticed.

    Raises
    ------
    SignalsError
        When the voltage as a whole can't be: with what may be the reason.
    """
    volts = at_rest(record, config, response)
    low, high = config.cell.curve.voltages()
    usual, span = float(np.nanmedian(volts)), high - low
    circuit, usual_a = config.cell.circuit, float(np.median(np.abs(record.current_a))) / config.cell.parallel
    by_current = 2.0 * (circuit.resistance_ohm + circuit.relaxation_resistance_ohm) * usual_a
    far = max(FAR_SHARE * span, FAR_V * high) + min(by_current, span)
    if not low - far <= usual <= high + far:
        raise SignalsError(_wrong_height(usual, low, high, config.cell.series), field="voltage_v")
    settling = circuit.relaxation_resistance_ohm * np.abs(record.current_a).max() / config.cell.parallel
    room = 0.02 * span + 3.0 * settling
    with np.errstate(invalid="ignore"):  # rows without a voltage are outside of nothing
        beyond = np.maximum(volts - high, low - volts)
        lost, outside = beyond > span + LOST_V * high / 4.0, beyond > room
    warnings = list(record.warnings)
    if lost.any():
        first = record.t_s[np.flatnonzero(lost)[0]]
        warnings.append(
            f"{counted(int(lost.sum()), 'voltage')} far outside the open-circuit curve (first: {first:g} s) counted as "
            "missing."
        )
    share = float(np.mean(outside[np.isfinite(volts)]))
    if share > OUTSIDE_SHARE:
        warnings.append(
            f"In {share:.0%} of the rows the voltage of one cell, {np.nanmin(volts):.3f} to {np.nanmax(volts):.3f} V "
            f"without the current's part, lies outside the open-circuit curve, {low:.3f} to {high:.3f} V. The curve "
            "goes on there as a straight line; give one that reaches as far."
        )
    return replace(record, voltage_v=np.where(lost, np.nan, record.voltage_v), warnings=tuple(warnings))


def with_plausible_charge(
    record: BatteryRecord, config: BatteryConfig, unknown_from_s: tuple[float, ...]
) -> BatteryRecord:
    """Return the record with what was noticed of its current and its times; what flows in a hole is not counted.

    Raises
    ------
    SignalsError
        When the current as a whole can't be: with what may be the reason.
    """
    cell, t_s = config.cell, record.t_s
    step = np.where(np.isin(t_s[:-1], unknown_from_s), 0.0, np.diff(t_s))
    charge_ah = np.concatenate([[0.0], np.cumsum(record.current_a[:-1] * step)]) / (AS_PER_AH * cell.parallel)
    begins = np.unique(np.searchsorted(t_s, np.arange(t_s[0], t_s[-1], BLOCK_S)))
    spans = np.maximum.reduceat(charge_ah, begins) - np.minimum.reduceat(charge_ah, begins)
    by_error = 3.0 * config.current_bias_a * min(BLOCK_S, float(t_s[-1] - t_s[0])) / AS_PER_AH
    moved = float(spans.max()) - by_error
    times = moved / cell.circuit.capacity_ah
    if times <= FULL:
        return _slow_rows(record, config)
    said = (
        f"{moved:.4g} Ah of one cell flow one way within {duration(min(BLOCK_S, float(t_s[-1] - t_s[0])))}, "
        f"{times:.3g} times its capacity of {cell.circuit.capacity_ah:g} Ah"
    )
    if times > ABSURD:
        raise SignalsError(
            f"{said}: is current_a in milliamperes, t_s in milliseconds, or parallel missing from the configuration?",
            field="current_a",
        )
    warning = f"{said}: the capacity in the configuration is too small, or parallel is."
    return _slow_rows(replace(record, warnings=(*record.warnings, warning)), config)


def at_rest(record: BatteryRecord, config: BatteryConfig, response: Response) -> FloatArray:
    """Return the voltage of one cell less what the current does to it at once, (n,)."""
    cell = config.cell
    ohm = cell.circuit.resistance_ohm
    if response.certainty > 3.0:
        ohm = min(ohm, response.ohm * cell.parallel / cell.series)
    return np.asarray(record.voltage_v / cell.series - ohm * record.current_a / cell.parallel)


def _wrong_height(usual: float, low: float, high: float, series: int) -> str:
    times = usual / (0.5 * (low + high))
    said = f"voltage_v is {usual:.4g} V of one cell in the middle, and the open-circuit curve {low:.4g} to {high:.4g} V"
    if 800.0 <= times <= 1250.0:
        return f"{said}: is it in millivolts? Divide it by 1000."
    if times >= 1.6:
        missing = "is series missing from the configuration?" if series == 1 else f"is series = {series} too small?"
        return f"{said}: {times * series:.0f} times a cell of that curve; {missing}"
    if times <= 0.6 and series > 1:
        return f"{said}: it looks like {times * series:.1f} cells in series, not {series}; is it of one cell already?"
    if 0.0008 <= times <= 0.00125:
        return f"{said}: is it in kilovolts? Multiply it by 1000."
    return f"{said}: the curve is another battery's, or the voltage is not this one's."


def _slow_rows(record: BatteryRecord, config: BatteryConfig) -> BatteryRecord:
    usual, settling = float(np.median(np.diff(record.t_s))), config.cell.circuit.time_constant_s
    if usual <= SLOW * settling:
        return record
    said = (
        f"The rows are {duration(usual)} apart, and the relaxation takes {duration(settling)}: its capacitance and "
        "resistance can't be told apart from the series resistance. (Are the times in seconds?)"
    )
    return replace(record, warnings=(*record.warnings, said))
