"""Sensors that sit somehow in the car, turned to its axes."""

from __future__ import annotations

from itertools import pairwise

import numpy as np

from app.science.arrays import BoolArray, FloatArray
from app.science.logger.recording import ACCELEROMETER, GYROSCOPE, Recording, Series
from app.science.vehicle.model import Vehicle

ENOUGH_OF_DOWN = 0.8
"""Share of the square of the down axis that a gyroscope's axes have to cover to tell how the car turns."""
ENOUGH_STILL_SAMPLES = 20
SLOWEST_COURSE_MPS = 5.0
LONGEST_COURSE_STEP_S = 2.5
ENOUGH_COURSE_S = 60.0


def body_acceleration(recording: Recording, vehicle: Vehicle) -> tuple[FloatArray, FloatArray] | None:
    """Return times (n,) and the accelerometer's readings rotated to forward, right, down (n, 3).

    None without an accelerometer, or when one of its axes is missing.
    """
    axes = [recording.signals[name] for name in ACCELEROMETER if name in recording]
    if len(axes) < len(ACCELEROMETER):
        return None
    t = axes[0].t_s
    raw = np.column_stack([axis.value if axis.t_s is t else np.interp(t, axis.t_s, axis.value) for axis in axes])
    return t, raw @ vehicle.mounting.matrix.T


def yaw_rate(recording: Recording, vehicle: Vehicle) -> Series | None:
    """Return how fast the gyroscope says that the car turns, rad/s, with its bias; None where it can't tell.

    A missing axis does no harm as long as the others cover the car's down axis nearly: the car hardly rolls and nods.
    """
    down = dict(zip(GYROSCOPE, vehicle.mounting.matrix[2] / vehicle.mounting.scale, strict=True))
    axes = {name: recording[name] for name in GYROSCOPE if name in recording}
    covered = sum(down[name] ** 2 for name in axes)
    if covered < ENOUGH_OF_DOWN:
        return None
    t = next(iter(axes.values())).t_s
    rate = sum(down[name] * np.interp(t, own.t_s, own.value) for name, own in axes.items())
    return Series(t, np.asarray(rate / covered))


def gyroscope_bias(rate: Series, still: BoolArray, course: Series | None, speed_mps: FloatArray | None) -> float:
    """Return the bias of a yaw rate, rad/s: what it reads at standstill, else what its integral has beyond the course.

    Parameters
    ----------
    rate : Series
    still : array, shape (len(rate),)
        Where the car stood.
    course : Series or None
        Heading over ground, degrees.
    speed_mps : array or None
        Speed at the times of the course.

    Returns
    -------
    float
        0 where neither tells.
    """
    if np.count_nonzero(still) >= ENOUGH_STILL_SAMPLES:
        return float(np.median(rate.value[still]))
    if course is None or speed_mps is None or len(course) < 2:
        return 0.0
    turned = np.concatenate(([0.0], np.cumsum(0.5 * (rate.value[1:] + rate.value[:-1]) * np.diff(rate.t_s))))
    inside = (course.t_s >= rate.t_s[0]) & (course.t_s <= rate.t_s[-1]) & (speed_mps > SLOWEST_COURSE_MPS)
    t, heading = course.t_s[inside], np.radians(course.value[inside])
    total_s = excess = 0.0
    for first, last in _unbroken(t):
        span = slice(first, last)
        own = np.unwrap(heading[span])
        excess += float(np.diff(np.interp(t[span][[0, -1]], rate.t_s, turned))[0] - (own[-1] - own[0]))
        total_s += float(t[last - 1] - t[first])
    return excess / total_s if total_s >= ENOUGH_COURSE_S else 0.0


def _unbroken(t_s: FloatArray) -> list[tuple[int, int]]:
    """Return where runs without a long pause begin and end."""
    edges = [0, *(np.flatnonzero(np.diff(t_s) > LONGEST_COURSE_STEP_S) + 1).tolist(), len(t_s)]
    return [(first, last) for first, last in pairwise(edges) if last - first > 1]
