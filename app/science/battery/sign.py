"""Which way the current is counted: charging must be positive, and the voltage tells."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from app.science.battery.config import BatteryConfig
from app.science.battery.record import BatteryRecord
from app.science.battery.response import Response

CERTAIN = 6.0
"""Standard deviations by which a slope must differ from nothing."""
MOSTLY = 0.8
"""Share of the large steps that must agree."""
EXPLAINED = 0.5
"""Share of the voltage's steps that the current's must explain: less, and the two are not of the same moment."""
LEAST_CHARGE = 0.05
"""Share of the capacity that must have moved for the voltage's trend to say anything."""
LEAST_TREND_V = 0.01
CLOSE = 0.8
"""Partial correlation of voltage and charge from which on their trend is believed."""
STEPS_OF_TREND = 2000


@dataclass(frozen=True, slots=True)
class Counted:
    """A record whose charging current is positive, and whether it had to be turned."""

    record: BatteryRecord
    turned: bool


def counted_rightly(record: BatteryRecord, config: BatteryConfig, response: Response) -> Counted:
    """Return the record with charging positive.

    Two things tell the direction, and neither needs the configured parameters: at a step of the current the voltage
    steps the same way, by R times as much; and as charge comes in, the voltage rises. A record is turned round when one
    of them is clearly against it and the other is not clearly for it.
    """
    at_steps, over_charge = direction_at_steps(response), direction_of_trend(record, config)
    if at_steps >= 0 and (at_steps > 0 or over_charge >= 0):
        return Counted(record, False)
    if over_charge > 0:
        said = (
            "At steps of the current the voltage goes the other way, but it rises as charge comes in: current and "
            "voltage do not seem to be of the same moment. Nothing was turned round; check how the two were joined."
        )
        return Counted(replace(record, warnings=(*record.warnings, said)), False)
    how = (
        f"at {1.0 - response.agreement:.0%} of {response.steps} large steps of the current the voltage steps back"
        if at_steps < 0
        else "the voltage falls as charge comes in"
    )
    said = (
        f"The current's sign is swapped: {how}. Charging must be positive; the current was turned round for this "
        "estimate. Turn it round at its source, too, or multiply current_a by −1."
    )
    return Counted(replace(record, current_a=-record.current_a, warnings=(*record.warnings, said)), True)


def direction_at_steps(response: Response) -> int:
    """Return 1 where the voltage follows the current's steps, −1 where it goes against them, 0 where it isn't clear."""
    if response.explained < EXPLAINED:
        return 0
    if response.certainty > CERTAIN and response.agreement >= MOSTLY:
        return 1
    if response.certainty < -CERTAIN and response.agreement <= 1.0 - MOSTLY:
        return -1
    return 0


def direction_of_trend(record: BatteryRecord, config: BatteryConfig) -> int:
    """Return 1 where the voltage rises as charge comes in, −1 where it falls, 0 where nothing is clear."""
    cell = config.cell
    step = np.diff(record.t_s, append=record.t_s[-1])
    charge_as = np.concatenate([[0.0], np.cumsum(record.current_a * step)[:-1]]) / cell.parallel
    # what the sensor's constant error alone may add up to says nothing of the direction
    by_error = 3.0 * config.current_bias_a * float(record.t_s[-1] - record.t_s[0])
    if np.ptp(charge_as) < max(LEAST_CHARGE * cell.circuit.capacity_as, 2.0 * by_error):
        return 0
    known = np.flatnonzero(np.isfinite(record.voltage_v))
    rows = known[np.linspace(0, len(known) - 1, min(len(known), STEPS_OF_TREND)).astype(np.int64)]
    volts, amps, charge = record.voltage_v[rows] / cell.series, record.current_a[rows], charge_as[rows]
    others = np.column_stack([np.ones(len(rows)), amps])
    volts_left = volts - others @ np.linalg.lstsq(others, volts, rcond=None)[0]
    charge_left = charge - others @ np.linalg.lstsq(others, charge, rcond=None)[0]
    size = float(np.sqrt(np.sum(volts_left**2) * np.sum(charge_left**2)))
    if size == 0.0:
        return 0
    correlation = float(np.sum(volts_left * charge_left)) / size
    moved_v = float(np.ptp(charge_left)) * abs(float(np.sum(volts_left * charge_left) / np.sum(charge_left**2)))
    if abs(correlation) < CLOSE or moved_v < LEAST_TREND_V:
        return 0
    return 1 if correlation > 0.0 else -1
