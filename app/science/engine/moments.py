"""Moments of driving sorted by the fuel that the engine took per turn.

Fuel is counted pulse by pulse and hardly errs, while torque comes out of accelerations and scatters by percents. So
where torque is averaged over moments that took the same fuel, neither the highest of many noisy torques passes for the
full load, nor the luckiest of them for the best efficiency; in cells of torque both happen.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, fields
from math import pi

import numpy as np

from app.science.arrays import BoolArray, FloatArray, IntArray
from app.science.engine.points import OperatingPoints

RADPS_PER_RPM = pi / 30.0
COLUMN_RPM = 100.0
STEP = 0.01
"""Rows are this far apart in the logarithm of the fuel per turn: one per cent."""
KEPT_ROWS = 70
LONGEST_GAP_S = {"observer": 0.12, "ecu": 1.5}
FEWEST_POINTS = {"observer": 3, "ecu": 1}
LONGEST_S = 2.0
SWEEP_PER_S = 0.01


@dataclass(frozen=True, slots=True)
class MomentSums:
    """Sums over moments by column of engine speed and row of fuel per turn, arrays of shape (m,); sorted by (i, k).

    Sums are plain, so those of several trips add up in any order.

    Attributes
    ----------
    i, k : integer array
        The column covers ``[i, i + 1) · COLUMN_RPM``, the row ``exp([k, k + 1) · STEP)`` joules per radian.
    moments, sweeps : integer array
        Times the engine went through the column there, and those of them in which it gained speed.
    rpm_sum, torque_sum, torque_squared_sum : array
        Of the moments' mean engine speeds and torques, rpm, Nm and Nm².
    charge_sum : array
        Of the moments' fuel per turn, J/rad.
    """

    i: IntArray
    k: IntArray
    moments: IntArray
    sweeps: IntArray
    rpm_sum: FloatArray
    torque_sum: FloatArray
    torque_squared_sum: FloatArray
    charge_sum: FloatArray


def moments_of(points: OperatingPoints) -> MomentSums:
    """Sum a trip's moments, of each engine speed only those that took at least half of the most fuel taken there."""
    return _added_up(single_moments(points))


def single_moments(points: OperatingPoints) -> MomentSums:
    """Return a trip's moments one by one, in the order of time.

    A moment is a stretch of operating points without a gap inside one column of engine speed, for two seconds at most.
    """
    if not len(points):
        return NO_MOMENTS
    column = np.floor(points.engine_speed_rpm / COLUMN_RPM).astype(np.int64)
    apart = np.diff(points.t_s) > LONGEST_GAP_S[points.torque_source]
    first = _starts(points.t_s, np.concatenate(([True], apart | (np.diff(column) != 0))))
    count = np.diff(np.concatenate((first, [len(points)])))

    def mean(values: FloatArray) -> FloatArray:
        return np.asarray(np.add.reduceat(values, first) / count)

    charge = mean(points.fuel_power_w / (points.engine_speed_rpm * RADPS_PER_RPM))
    torque = mean(points.torque_nm)
    began, ended = (points.engine_speed_rpm[at] for at in (first, first + count - 1))
    rising = ended - began > SWEEP_PER_S * began * (points.t_s[first + count - 1] - points.t_s[first])
    rows = MomentSums(
        i=column[first],
        k=np.floor(np.log(charge) / STEP).astype(np.int64),
        moments=np.ones(len(first), np.int64),
        sweeps=((count == 1) | rising).astype(np.int64),
        rpm_sum=mean(points.engine_speed_rpm),
        torque_sum=torque,
        torque_squared_sum=torque**2,
        charge_sum=charge,
    )
    return _chosen(rows, np.flatnonzero(count >= FEWEST_POINTS[points.torque_source]))


def _starts(t_s: FloatArray, begins: BoolArray) -> IntArray:
    """Return where moments start: where stretches begin, and again after every two seconds of them."""
    since = t_s - t_s[np.flatnonzero(begins)[np.cumsum(begins) - 1]]
    again = np.diff(np.floor(since / LONGEST_S), prepend=0.0) != 0.0
    return np.flatnonzero(begins | again)


def merge_moments(sums: Iterable[MomentSums]) -> MomentSums:
    """Add the sums of several trips, in any order."""
    parts = [NO_MOMENTS, *sums]
    return _added_up(
        MomentSums(*(np.concatenate([getattr(part, f.name) for part in parts]) for f in fields(MomentSums)))
    )


def _added_up(rows: MomentSums) -> MomentSums:
    """Add up rows of the same place, and drop those too far below the highest of their column to matter."""
    if not len(rows.i):
        return NO_MOMENTS
    top = np.full(int(rows.i.max()) + 1, np.iinfo(np.int64).min)
    np.maximum.at(top, rows.i, rows.k)
    rows = _chosen(rows, np.flatnonzero(rows.k >= top[rows.i] - KEPT_ROWS))
    lowest, height = int(rows.k.min()), int(rows.k.max() - rows.k.min()) + 1
    places, place = np.unique(rows.i * height + rows.k - lowest, return_inverse=True)

    def total(values: FloatArray | IntArray) -> FloatArray:
        return np.asarray(np.bincount(place, weights=values, minlength=len(places)), dtype=np.float64)

    return MomentSums(
        i=places // height,
        k=places % height + lowest,
        moments=total(rows.moments).astype(np.int64),
        sweeps=total(rows.sweeps).astype(np.int64),
        rpm_sum=total(rows.rpm_sum),
        torque_sum=total(rows.torque_sum),
        torque_squared_sum=total(rows.torque_squared_sum),
        charge_sum=total(rows.charge_sum),
    )


def _chosen(rows: MomentSums, which: IntArray) -> MomentSums:
    return MomentSums(*(getattr(rows, field.name)[which] for field in fields(MomentSums)))


NO_MOMENTS = MomentSums(
    i=np.empty(0, np.int64),
    k=np.empty(0, np.int64),
    moments=np.empty(0, np.int64),
    sweeps=np.empty(0, np.int64),
    rpm_sum=np.empty(0),
    torque_sum=np.empty(0),
    torque_squared_sum=np.empty(0),
    charge_sum=np.empty(0),
)
