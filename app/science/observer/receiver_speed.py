"""A receiver's speed in place of the wheels': how late it comes, and where it says that the car stood."""

from __future__ import annotations

import numpy as np
from scipy.ndimage import maximum_filter1d, uniform_filter1d

from app.science.arrays import BoolArray, FloatArray
from app.science.logger.recording import Recording, Series
from app.science.observer.body_axes import body_acceleration
from app.science.vehicle.model import Vehicle

LATEST_S = 0.6
LAG_STEP_S = 0.01
SLOW_S = 5.0
ENOUGH_S = 60.0
CERTAIN_SIGMA = 5.0
STANDING_WITHIN_S = 2.0
STANDING_MEAN_MPS = 0.15
STANDING_MOST_MPS = 0.4
LONGEST_STEP_S = 0.6
OF_THE_RECEIVER = ("lat_deg", "lon_deg", "alt_m", "hdop", "heading_deg", "gnss_speed_mps", "satellites")


def speed_is_the_receivers(recording: Recording) -> bool:
    """Whether only a receiver tells the speed."""
    return "gnss_speed_mps" in recording and "vss_tick" not in recording and "speed_mps" not in recording


def in_time(recording: Recording, vehicle: Vehicle) -> Recording:
    """Return the recording with its receiver's signals moved back by how late its speed follows the accelerometer.

    A recording whose speed comes from elsewhere, or without an accelerometer, stays as it is: there the receiver is
    too slow a witness for its lateness to matter.
    """
    late_s = lateness_s(recording, vehicle) if speed_is_the_receivers(recording) else 0.0
    if late_s == 0.0:
        return recording
    moved = {
        name: Series(own.t_s - late_s, own.value) if name in OF_THE_RECEIVER else own
        for name, own in recording.signals.items()
    }
    return Recording(moved, recording.started_at_utc_s, recording.texts, recording.warnings)


def lateness_s(recording: Recording, vehicle: Vehicle) -> float:
    """Return by how much a receiver's speed is later than the accelerometer, s; 0 where that can't be told.

    It is the shift at which the speed, apart from its slow part, is most like the integral of what the accelerometer
    reads forward; slopes and biases are in the slow part.
    """
    speed, acceleration = recording.get("gnss_speed_mps"), body_acceleration(recording, vehicle)
    if speed is None or acceleration is None or speed.t_s[-1] - speed.t_s[0] < ENOUGH_S:
        return 0.0
    t, body = acceleration
    gained = np.concatenate(([0.0], np.cumsum(0.5 * (body[1:, 0] + body[:-1, 0]) * np.diff(t))))
    step_s = float(np.median(np.diff(speed.t_s)))
    if step_s > LONGEST_STEP_S:
        return 0.0
    window = max(round(SLOW_S / step_s), 3)
    lags = np.arange(0.0, LATEST_S + LAG_STEP_S, LAG_STEP_S)
    misfit = np.array([_quick(speed.value - np.interp(speed.t_s - lag, t, gained), window) for lag in lags])
    best = int(np.argmin(misfit))
    gain = len(speed) * (misfit[0] / misfit[best] - 1.0)
    if best in (0, len(lags) - 1) or gain < CERTAIN_SIGMA**2:
        return 0.0
    before, at, after = misfit[best - 1 : best + 2]
    return float(lags[best] + 0.5 * LAG_STEP_S * (before - after) / (before - 2.0 * at + after))


def _quick(difference: FloatArray, window: int) -> float:
    quick = difference - uniform_filter1d(difference, window)
    limit = 4.0 * np.median(np.abs(quick))
    return float(np.mean(np.clip(quick, -limit, limit) ** 2))


def standing(t_s: FloatArray, speed: Series) -> BoolArray:
    """Return at which times a receiver's speed is nothing but noise, shape of ``t_s``."""
    if len(speed) < 2:
        return np.zeros(len(t_s), np.bool_)
    samples = max(round(STANDING_WITHIN_S / float(np.median(np.diff(speed.t_s)))), 1)
    still = (uniform_filter1d(speed.value, samples) < STANDING_MEAN_MPS) & (
        maximum_filter1d(speed.value, samples) < STANDING_MOST_MPS
    )
    after = np.clip(np.searchsorted(speed.t_s, t_s), 1, len(speed) - 1)
    often = np.diff(speed.t_s)[after - 1] < LONGEST_STEP_S
    inside = (t_s >= speed.t_s[0]) & (t_s <= speed.t_s[-1])
    return np.asarray(still[after] & still[after - 1] & often & inside)
