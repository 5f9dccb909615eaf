"""Where a trip began whose first position came late, as when a car leaves a garage."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from app.science.arrays import FloatArray
from app.science.logger.recording import Recording, Series
from app.science.observer.body_axes import body_acceleration, gyroscope_bias, yaw_rate
from app.science.observer.prepass import speed_before_filtering
from app.science.observer.receiver_speed import speed_is_the_receivers
from app.science.observer.timeline import Timeline
from app.science.vehicle.model import Vehicle

LATE_S = 30.0
LEARNING_S = 600.0
SLOWEST_TURN_MPS = 3.0
COURSE_STEP_S = 1.0
SIDEWAYS_BIAS_SD_MPS2 = 0.05
TURN_RATE_SD_RADPS = 0.002
ENOUGH_LEARNING = 30


@dataclass(frozen=True, slots=True)
class StartPose:
    """Where the car stood when the recording began, seen from the first fix, which is the origin.

    Attributes
    ----------
    heading_rad, heading_sd_rad : float
    north_m, east_m, position_sd_m : float
    bias_j_mps2 : float or None
        The accelerometer's bias sideways that made it, None where a gyroscope told the turns.
    """

    heading_rad: float
    heading_sd_rad: float
    north_m: float
    east_m: float
    position_sd_m: float
    bias_j_mps2: float | None


def start_pose(
    recording: Recording, vehicle: Vehicle, timeline: Timeline, fix_t_s: float, course_rad: float
) -> StartPose | None:
    """Follow the car back from its first fix to the beginning by its speed and by how it turned.

    The filter can't find a heading that is far off: it goes by derivatives. From here it starts near enough, and the
    smoother carries what the fixes say back to the beginning.

    Parameters
    ----------
    recording : Recording
    vehicle : Vehicle
    timeline : Timeline
    fix_t_s, course_rad : float
        When the first fix came and where the car headed then.

    Returns
    -------
    StartPose or None
        None when nothing tells speed or turns before the fix.
    """
    if speed_is_the_receivers(recording):
        return None
    t = np.append(timeline.node_t_s[timeline.node_t_s < fix_t_s], fix_t_s)
    speed = speed_before_filtering(t, recording, vehicle)
    turns = _turns(t, recording, vehicle, timeline)
    if speed is None or turns is None or len(t) < 2:
        return None
    rate, bias_j = turns
    step = np.diff(t)
    heading = course_rad - _until_the_end(0.5 * (rate[1:] + rate[:-1]) * step)
    north, east = (
        _until_the_end(0.5 * (pace[1:] + pace[:-1]) * step)
        for pace in (speed * np.cos(heading), speed * np.sin(heading))
    )
    blind_s, way_m = float(t[-1] - t[0]), float(np.sum(0.5 * (speed[1:] + speed[:-1]) * step))
    heading_sd = 0.4 + TURN_RATE_SD_RADPS * blind_s
    return StartPose(float(heading[0]), heading_sd, -float(north[0]), -float(east[0]), 200.0 + way_m, bias_j)


def _until_the_end(parts: FloatArray) -> FloatArray:
    """Return for each node what is still to come, shape (len(parts) + 1,)."""
    return np.append(np.cumsum(parts[::-1])[::-1], 0.0)


def _turns(
    t_s: FloatArray, recording: Recording, vehicle: Vehicle, timeline: Timeline
) -> tuple[FloatArray, float | None] | None:
    """Return how fast the car turned at these times, rad/s, and the sideways bias that was taken off, if any."""
    course = recording.get("heading_deg")
    rate = yaw_rate(recording, vehicle)
    if rate is not None:
        still = np.isin(np.round(rate.t_s / 0.05), np.round(timeline.standstill_t_s / 0.05))
        speed = None if course is None else speed_before_filtering(course.t_s, recording, vehicle)
        return np.interp(t_s, rate.t_s, rate.value - gyroscope_bias(rate, still, course, speed)), None
    acceleration = body_acceleration(recording, vehicle)
    speed = speed_before_filtering(t_s, recording, vehicle)
    if acceleration is None or speed is None:
        return None
    t, body = acceleration
    sideways = Series(t, body[:, 1])
    bias = _sideways_bias(sideways, recording, vehicle)
    quick = np.maximum(speed, SLOWEST_TURN_MPS)
    return (np.interp(t_s, t, _smooth(body[:, 1])) - bias) / quick * np.minimum(speed / SLOWEST_TURN_MPS, 1.0), bias


def _smooth(values: FloatArray, width: int = 9) -> FloatArray:
    return np.convolve(values, np.ones(width) / width, mode="same")


def _sideways_bias(sideways: Series, recording: Recording, vehicle: Vehicle) -> float:
    """Return what the accelerometer reads sideways beyond speed times turn of course; 0 without a course."""
    course = recording.get("heading_deg")
    if course is None or len(course) < 2:
        return 0.0
    t = np.arange(course.t_s[0], min(course.t_s[-1], course.t_s[0] + LEARNING_S), COURSE_STEP_S)
    speed = speed_before_filtering(t, recording, vehicle)
    if speed is None or len(t) < ENOUGH_LEARNING:
        return 0.0
    heading = np.interp(t, course.t_s, np.unwrap(np.radians(course.value)))
    way = np.concatenate(([0.0], np.cumsum(0.5 * (sideways.value[1:] + sideways.value[:-1]) * np.diff(sideways.t_s))))
    mean = np.diff(np.interp(t, sideways.t_s, way)) / COURSE_STEP_S
    middle = 0.5 * (speed[1:] + speed[:-1])
    excess = mean - middle * np.diff(heading) / COURSE_STEP_S
    moving = middle > 2.0 * SLOWEST_TURN_MPS
    return float(np.median(excess[moving])) if np.count_nonzero(moving) >= ENOUGH_LEARNING else 0.0
