"""How the car accelerated forward and to the right, by wheels and receiver, beside what the raw accelerometer read."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.ndimage import gaussian_filter1d, minimum_filter1d, uniform_filter1d

from app.science.arrays import BoolArray, FloatArray
from app.science.logger.recording import ACCELEROMETER, Recording, Series
from app.science.vehicle.model import Vehicle

STEP_S = 0.1
SHARPEST_S = 0.5
SLOWEST_COURSE_MPS = 2.0
SLOWEST_TICKS_MPS = 0.9
FASTEST_SILENT_MPS = 3.0
RAMP_S = 0.8
RAMPS_MPS2 = (0.3, 4.0)
LONGEST_GAP_S = 3.0
OFTEN_S = 1.5


@dataclass(frozen=True, slots=True)
class Motion:
    """Accelerations on a regular grid, each smoothed alike; all arrays of shape (n,) unless stated.

    Attributes
    ----------
    t_s : array
    raw_mps2 : array, shape (n, 3)
        Accelerometer, its own axes.
    speed_mps, forward_mps2, right_mps2 : array
        ``right_mps2`` is speed times turning rate.
    has_forward, has_right : array of bool
        Where these are known.
    source : str
        Signal the speed came from.
    """

    t_s: FloatArray
    raw_mps2: FloatArray
    speed_mps: FloatArray
    forward_mps2: FloatArray
    right_mps2: FloatArray
    has_forward: BoolArray
    has_right: BoolArray
    source: str


def speed_source(recording: Recording) -> str:
    """Return the signal that tells best how the speed changes; empty without any."""
    names = [name for name in ("vss_tick", "speed_mps", "gnss_speed_mps") if name in recording]
    often = [name for name in names if name == "vss_tick" or spacing(recording[name]) <= OFTEN_S]
    return next((name for name in often if len(recording[name]) > 2), "")


def read_motion(recording: Recording, vehicle: Vehicle) -> Motion:
    """Put the accelerometer, which must have three axes, and what the car did on one grid."""
    axes = [recording[name] for name in ACCELEROMETER]
    source = speed_source(recording)
    t = np.arange(np.ceil(axes[0].t_s[0] / STEP_S) + 1, np.floor(axes[0].t_s[-1] / STEP_S)) * STEP_S
    course = recording.get("heading_deg")
    smooth_s = SHARPEST_S
    if source and source != "vss_tick":
        smooth_s = max(smooth_s, spacing(recording[source]))
    if course is not None:
        smooth_s = max(smooth_s, spacing(course))
    width = smooth_s / STEP_S
    raw = np.column_stack([gaussian_filter1d(mean_between(axis, t), width) for axis in axes])
    dense = all_around(within(axes[0], t, LONGEST_GAP_S), smooth_s)
    nothing = np.zeros(len(t))
    speed, forward, known = nothing, nothing, np.zeros(len(t), np.bool_)
    if source:
        speed, forward, known = speed_of(recording, vehicle, source, t, smooth_s)
    right, turning = nothing, np.zeros(len(t), np.bool_)
    if course is not None and source and len(course) > 2:
        angle = np.interp(t, course.t_s, np.unwrap(np.radians(course.value)))
        right = speed * gaussian_filter1d(angle, width, order=1) / STEP_S
        told = within(course, t, max(LONGEST_GAP_S, 2.5 * spacing(course))) | (speed < SLOWEST_COURSE_MPS)
        turning = known & all_around(told, smooth_s)
    return Motion(t, raw, speed, forward, right, known & dense, turning & dense, source)


def speed_of(
    recording: Recording, vehicle: Vehicle, source: str, t: FloatArray, smooth_s: float
) -> tuple[FloatArray, FloatArray, BoolArray]:
    """Return speed, its derivative and where both are known, on the grid."""
    signal = recording[source]
    if source == "vss_tick":
        value, known = speed_by_ticks(signal, vehicle.vss_m_per_tick, t)
    else:
        value, near = np.interp(t, signal.t_s, signal.value), max(LONGEST_GAP_S, 2.5 * spacing(signal))
        known = within(signal, t, near)
    width = smooth_s / STEP_S
    speed, forward = gaussian_filter1d(value, width), gaussian_filter1d(value, width, order=1) / STEP_S
    return speed, forward, all_around(known, smooth_s)


def speed_by_ticks(ticks: Series, metres: float, t: FloatArray) -> tuple[FloatArray, BoolArray]:
    """Speed at each time, and whether it is known.

    Below walking pace the sensor is silent; the speed goes on falling there as it fell before, and has risen before
    the next tick as it rises behind it. What that gets wrong lies along the car's forward axis.
    """
    gap, known = np.diff(ticks.t_s), np.zeros(len(t), np.bool_)
    rolling = gap < metres / SLOWEST_TICKS_MPS
    if np.count_nonzero(rolling) < 2:
        return np.zeros(len(t)), known
    middle = 0.5 * (ticks.t_s[1:] + ticks.t_s[:-1])[rolling]
    speed = metres * (ticks.value[1:] / gap)[rolling]
    value, known = np.interp(t, middle, speed), (t >= t[0])
    begins = np.concatenate(([-np.inf], ticks.t_s[:-1][~rolling], ticks.t_s[-1:]))
    ends = np.concatenate((ticks.t_s[:1], ticks.t_s[1:][~rolling], [np.inf]))
    for begin, end in zip(begins, ends, strict=True):
        inside = slice(np.searchsorted(t, begin), np.searchsorted(t, end))
        falling = ramp(middle, speed, begin, -1.0, t[inside])
        rising = ramp(middle, speed, end, 1.0, t[inside])
        value[inside] = np.maximum(falling, rising)
        known[inside] = is_silence(middle, speed, begin, end)
    return value, known


def ramp(speed_t: FloatArray, speed: FloatArray, edge: float, sign: float, t: FloatArray) -> FloatArray:
    """Go on from the edge of a silence as steadily as the speed changed beside it, down to standstill."""
    if not np.isfinite(edge):
        return np.zeros(len(t))
    beside = slice(*np.searchsorted(speed_t, sorted((edge, edge + sign * RAMP_S))))
    times, speeds = speed_t[beside] - edge, speed[beside]
    if len(times) < 2:
        return np.zeros(len(t))
    slope, there = np.polyfit(times, speeds, 1)
    slope = sign * np.clip(sign * slope, *RAMPS_MPS2)
    return np.asarray(np.maximum(there + slope * (t - edge), 0.0))


def is_silence(speed_t: FloatArray, speed: FloatArray, begin: float, end: float) -> bool:
    """Whether the ticks end and begin again slowly, as the sensor does, and not because some were lost."""
    beside = np.clip([np.searchsorted(speed_t, begin) - 1, np.searchsorted(speed_t, end)], 0, len(speed) - 1)
    slow = speed[beside] < FASTEST_SILENT_MPS
    return bool(slow[0] or begin == -np.inf) and bool(slow[1] or end == np.inf)


def spacing(signal: Series) -> float:
    """Usual time between two samples, s."""
    return float(np.median(np.diff(signal.t_s))) if len(signal) > 1 else np.inf


def mean_between(signal: Series, t: FloatArray) -> FloatArray:
    """Mean of a signal over the grid's step around each of its times, shape of ``t``."""
    area = np.concatenate(([0.0], np.cumsum(0.5 * np.diff(signal.t_s) * (signal.value[1:] + signal.value[:-1]))))
    edges = np.concatenate((t - 0.5 * STEP_S, t[-1:] + 0.5 * STEP_S))
    return np.asarray(np.diff(np.interp(edges, signal.t_s, area)) / STEP_S)


def within(signal: Series, t: FloatArray, longest_gap_s: float) -> BoolArray:
    """Whether each time lies between two samples that are not too far apart."""
    after = np.clip(np.searchsorted(signal.t_s, t), 1, len(signal) - 1)
    inside = (t >= signal.t_s[0]) & (t <= signal.t_s[-1])
    return np.asarray((np.diff(signal.t_s)[after - 1] <= longest_gap_s) & inside)


def all_around(known: BoolArray, smooth_s: float) -> BoolArray:
    """Whether everything is known as far as the smoothing reaches."""
    return np.asarray(minimum_filter1d(known.astype(np.int8), 2 * round(3.0 * smooth_s / STEP_S) + 1) > 0)


def without_slow_part(values: FloatArray, weight: FloatArray, slow_s: float) -> FloatArray:
    """Take away what changes slowly: slopes of the road, drifts.

    Parameters
    ----------
    values : array, shape (n,) or (n, k)
    weight : array, shape (n,)
        Of the samples in the slow part, 0 where unknown: so quiet moments tell the level of noisy ones beside them.
    slow_s : float
        Standard deviation of the triangle over which it is averaged, s.
    """
    width = max(round(np.sqrt(6.0) * slow_s / STEP_S), 1)
    shape = (-1,) + (1,) * (values.ndim - 1)
    sums = [np.asarray(weight), values * weight.reshape(shape)]
    for _ in range(2):
        sums = [uniform_filter1d(one, width, axis=0, mode="constant") for one in sums]
    mean = sums[1] / np.maximum(sums[0], 1e-12).reshape(shape)
    return np.asarray(np.where(weight.reshape(shape) > 0.0, values - mean, 0.0))
