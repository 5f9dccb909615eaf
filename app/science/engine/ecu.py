"""Operating points of a car whose engine control unit reports its torque."""

from __future__ import annotations

from dataclasses import dataclass
from math import pi

import numpy as np

from app.science.arrays import FloatArray
from app.science.engine.points import OperatingPoints
from app.science.engine.rules import PointRules, meaningful, settled
from app.science.logger.recording import Recording, Series
from app.science.observer.result import Observation
from app.science.vehicle.model import Vehicle

RADPS_PER_RPM = pi / 30.0


@dataclass(frozen=True, slots=True)
class _Measured:
    """A quantity over time with its standard deviation, all arrays of shape (n,)."""

    t_s: FloatArray
    value: FloatArray
    sd: FloatArray

    def at(self, t_s: FloatArray, max_gap_s: float) -> _Measured:
        """Interpolate linearly; NaN outside the samples and inside gaps wider than ``max_gap_s``."""
        if len(self.t_s) < 2:
            unknown = np.full(len(t_s), np.nan)
            return _Measured(t_s, unknown, unknown)
        right = np.clip(np.searchsorted(self.t_s, t_s), 1, len(self.t_s) - 1)
        inside = (t_s >= self.t_s[0]) & (t_s <= self.t_s[-1])
        known = inside & (self.t_s[right] - self.t_s[right - 1] <= max_gap_s)
        value = np.where(known, np.interp(t_s, self.t_s, self.value), np.nan)
        return _Measured(t_s, value, np.interp(t_s, self.t_s, self.sd))


def _reported(series: Series, factor: float) -> _Measured:
    """Scale a bus signal. All that is known of its error is the rounding to its smallest step."""
    steps = np.diff(np.unique(series.value))
    step = float(steps.min()) if len(steps) else 0.0
    return _Measured(series.t_s, series.value * factor, np.full(len(series), step * factor / np.sqrt(12.0)))


def _observed(observation: Observation, column: str, factor: float) -> _Measured:
    """Take a state of the observer, where it is known."""
    value = observation.columns[column]
    known = np.isfinite(value)
    return _Measured(
        observation.columns["t_s"][known], value[known] * factor, observation.columns[f"{column}_sd"][known] * factor
    )


def ecu_points(observation: Observation, recording: Recording, vehicle: Vehicle, rules: PointRules) -> OperatingPoints:
    """Take operating points at the samples of the reported torque.

    Engine speed and fuel power are interpolated to these times from the recording's own series, because a state that
    was filtered through the car's motion would bring the road load's errors back in; where the recording lacks one,
    the observer's state stands in. ``efficiency_sd`` holds what is known of the errors: the rounding of bus signals
    and the observer's own standard deviations. The signals' different ages come on top.

    Parameters
    ----------
    observation : Observation
    recording : Recording
        With ``engine_torque_nm``.
    vehicle : Vehicle
    rules : PointRules
    """
    torque = _reported(recording["engine_torque_nm"], 1.0)
    t = torque.t_s
    speed_series, fuel_series = recording.get("engine_speed_rpm"), recording.get("fuel_rate_lph")
    speed = (
        _reported(speed_series, 1.0)
        if speed_series is not None
        else _observed(observation, "engine_speed_radps", 1.0 / RADPS_PER_RPM)
    ).at(t, rules.max_gap_s)
    fuel = (
        _reported(fuel_series, vehicle.fuel_energy_j_per_l / 3600.0)
        if fuel_series is not None
        else _observed(observation, "fuel_power_w", 1.0)
    ).at(t, rules.max_gap_s)
    power = torque.value * speed.value * RADPS_PER_RPM
    keep = meaningful(power, fuel.value, rules) & (speed.value > 0.0)
    gear = observation.columns["gear"]
    if vehicle.gear_ratios and np.any(gear >= 1):
        keep &= settled(t, observation.columns["t_s"], gear, rules)
    relative = np.sqrt(
        (torque.sd[keep] / torque.value[keep]) ** 2
        + (speed.sd[keep] / speed.value[keep]) ** 2
        + (fuel.sd[keep] / fuel.value[keep]) ** 2
    )
    efficiency = power[keep] / fuel.value[keep]
    return OperatingPoints(
        t_s=t[keep],
        engine_speed_rpm=speed.value[keep],
        torque_nm=torque.value[keep],
        power_w=power[keep],
        fuel_power_w=fuel.value[keep],
        efficiency=efficiency,
        efficiency_sd=efficiency * relative,
        torque_source="ecu",
    )
