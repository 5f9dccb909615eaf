"""What a pause between two records does to what is known of a cell."""

from __future__ import annotations

from typing import Final

import numpy as np

from app.science.arrays import FloatArray
from app.science.battery.circuit import AS_PER_AH
from app.science.battery.config import VALUES, BatteryConfig
from app.science.battery.run import Carry

__all__ = ["CAPACITY_PER_ROOT_DAY", "between", "open_soc"]

DAY_S: Final = 86400.0
LN_CAPACITY, LN_RESISTANCE, LN_CAPACITANCE, LN_RELAXATION, SOC, RELAXATION_V, BIAS = range(7)
"""Places in `Carry.mean`."""

CAPACITY_PER_ROOT_DAY: Final = 0.002
"""Random walk of ln Q: 0.2 % after a day, 3.8 % after a year. Cells lose some 2 to 5 % a year, few of them 10 %."""

OTHERWISE_SD: Final = 0.3
"""Of ln R, ln C_r and ln R_r after a long pause: a temperature that nobody measured changes them by some tens of
percent, and a few minutes of driving tell them anew."""

WARMED_SD: Final = 0.1
"""The same where the configuration says how they depend on temperature: ageing, and what that leaves open."""

COOLING_S: Final = 6 * 3600.0
"""Time over which a battery takes on another temperature."""

MOST_SD: Final = {
    "capacity_ah": 0.2,
    "resistance_ohm": 0.5,
    "relaxation_capacitance_f": 0.5,
    "relaxation_resistance_ohm": 0.5,
}
"""However long a pause, a parameter is no less certain than this, or than a configuration says of its beginning."""

UNPLUGGED_S: Final = 300.0
"""A pause up to which nothing is plugged in and charges."""

FASTEST_1PH: Final = 1.0
"""Charge that may have flowed unseen, as a share of the capacity per hour from then on."""

OPEN_SOC_SD: Final = 0.4
"""Where nothing is known of the state of charge: a little more than of a number drawn between 0 and 1 (0.29), because
what is known lies at one end, as after charging."""

BIAS_KEPT_S: Final = 30 * DAY_S
"""Time over which a current sensor forgets its error: it moves with temperature and with each calibration at rest."""


def between(carry: Carry, gap_s: float, config: BatteryConfig) -> Carry:
    """Return what is still known when the next record begins.

    The capacity walks at random, the other parameters change with temperature, the relaxation decays, the current
    sensor's error drifts back towards its prior, and the state of charge is opened up by what may have been charged
    unseen.

    Parameters
    ----------
    carry : Carry
    gap_s : float
        From the last row of one record to the first of the next, seconds; less than zero counts as zero.
    config : BatteryConfig
        Of the next record: its doubts about the parameters bound theirs, its doubt about the bias returns.

    Returns
    -------
    Carry
        Its time is the gap's end in the first record's time.
    """
    gap_s = max(float(gap_s), 0.0)
    mean, covariance = carry.mean.copy(), carry.covariance.copy()
    most = np.array([max(config.initial_sd.get(name, 0.0), MOST_SD[name]) for name in VALUES[:SOC]])
    otherwise = (WARMED_SD if config.cell.warmth else OTHERWISE_SD) ** 2 * (1.0 - np.exp(-2.0 * gap_s / COOLING_S))
    added = np.full(SOC, otherwise)
    added[LN_CAPACITY] = CAPACITY_PER_ROOT_DAY**2 * gap_s / DAY_S
    for place, more in enumerate(added):
        known = covariance[place, place]
        covariance[place, place] = max(known, min(known + more, most[place] ** 2))
    left = np.exp(-gap_s / np.exp(mean[LN_CAPACITANCE] + mean[LN_RELAXATION]))
    _shrink(mean, covariance, RELAXATION_V, float(left))
    kept = float(np.exp(-gap_s / BIAS_KEPT_S))
    _shrink(mean, covariance, BIAS, kept)
    covariance[BIAS, BIAS] += (1.0 - kept**2) * config.current_bias_a**2
    unseen_h = max(gap_s - UNPLUGGED_S, 0.0) / 3600.0
    moved = min(FASTEST_1PH * unseen_h, OPEN_SOC_SD)
    aged = Carry(mean, covariance, carry.t_s + gap_s)
    return open_soc(aged, moved) if moved > 0.0 else aged


def open_soc(carry: Carry, sd: float = OPEN_SOC_SD) -> Carry:
    """Return what is known after charge has moved unseen by something with the given standard deviation.

    What such a charge leaves in the relaxation is unknown as well: as much as a current makes that moves as much in an
    hour. The mean stays; a state of charge far outside 0 to 1 can't be, so its standard deviation never exceeds that of
    knowing nothing.
    """
    mean, covariance = carry.mean.copy(), carry.covariance.copy()
    before = covariance[SOC, SOC]
    after = min(before + sd**2, max(before, OPEN_SOC_SD**2))
    covariance[SOC, SOC] = after
    if sd >= OPEN_SOC_SD:  # nothing that is known of anything else tells a charge that was replaced
        covariance[SOC, :] = covariance[:, SOC] = 0.0
        covariance[SOC, SOC] = after
        mean[SOC] = np.clip(mean[SOC], 0.0, 1.0)
    amps = sd * np.exp(mean[LN_CAPACITY]) / AS_PER_AH
    covariance[RELAXATION_V, RELAXATION_V] += (amps * np.exp(mean[LN_RELAXATION])) ** 2
    return Carry(mean, covariance, carry.t_s)


def _shrink(mean: FloatArray, covariance: FloatArray, place: int, factor: float) -> None:
    mean[place] *= factor
    covariance[place, :] *= factor
    covariance[:, place] *= factor
