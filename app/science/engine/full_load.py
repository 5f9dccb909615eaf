"""The full-load curve: the torque with the throttle wide open, by engine speed, with what is known of its error."""

from __future__ import annotations

from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from app.science.arrays import BoolArray, FloatArray, IntArray
from app.science.engine.envelope import CLOSED_RPM, Envelope, closed
from app.science.engine.moments import COLUMN_RPM, STEP, MomentSums

CEILING_ROWS = 3
BELOW_ROWS = 9
PILE = 4.0
FEWEST_MOMENTS = 4
STRAY_SHARE = 0.1
ROW_VARIANCE = (CEILING_ROWS * STEP) ** 2 / 12.0
DIP = 0.06
DIP_RPM = 1000.0
BEND = 0.02
"""Standard deviation of how much the curve's slope changes from column to column, as a share of its highest torque."""


@dataclass(frozen=True, slots=True)
class FullLoad:
    """The most that the engine gave, arrays of shape (k,), by rising engine speed.

    Attributes
    ----------
    rpm : array
        Where the moments of a column had their mean engine speed.
    nm, sd : array
        Torque and its standard deviation from the scatter between moments, Nm. What is wrong with the car's mass,
        gears or resistance shifts all of the curve and is not in it.
    reached : boolean array
        True where several separate moments agree that there is no more; elsewhere the torque is a lower bound.
    """

    rpm: FloatArray
    nm: FloatArray
    sd: FloatArray
    reached: BoolArray

    def exceeded(self, rpm: FloatArray, nm: FloatArray) -> BoolArray:
        """Tell which operating points lie above the curve, by more than two deviations, where it was reached.

        Between two columns that were reached at most 500 rpm apart it is taken as reached, too.
        """
        at = np.flatnonzero(self.reached)
        if len(at) < 2:
            return np.zeros(len(rpm), np.bool_)
        known = self.rpm[at]
        right = np.clip(np.searchsorted(known, rpm), 1, len(at) - 1)
        near = (rpm >= known[0]) & (rpm <= known[-1]) & (known[right] - known[right - 1] <= CLOSED_RPM)
        return np.asarray(near & (nm > np.interp(rpm, known, self.nm[at] + 2.0 * self.sd[at])))


def lower_bound(seen: Envelope) -> FullLoad:
    """Return an envelope of cells as a full load that nothing says was reached."""
    return FullLoad(seen.rpm, seen.nm, np.full(len(seen.rpm), np.nan), np.zeros(len(seen.rpm), np.bool_))


@dataclass(frozen=True, slots=True)
class _Columns:
    """What each column of engine speed shows at the most fuel, arrays over the columns from lowest to highest."""

    charge: FloatArray
    rpm: FloatArray
    count: IntArray
    torque: FloatArray
    variance: FloatArray
    piled: BoolArray


def full_load_curve(sums: MomentSums) -> FullLoad:
    """Find the full load in moments of driving (Sebesta 2010, 3.4.1.4 takes the highest cell instead).

    In a column of engine speed the ceiling counts as reached where at least four moments, engine speed rising, agree
    on the most fuel within 3 %, and are more, by four standard deviations, than there would be if moments lay there as
    they do in the 9 % below; at most a tenth as many may have strayed above. A driver who stops anywhere short of the
    ceiling leaves no such pile. A neighbouring column must show the same, and none within 500 rpm on both sides may
    show 6 % more fuel.

    Reached torques are smoothed: their scatter, and a curve whose slope changes by about 2 % of its torque per
    column, decide together. The standard deviation told is that before smoothing, since one pass through many
    columns has one error in common.

    Returns
    -------
    FullLoad
        Empty when there is no moment.
    """
    if not len(sums.i):
        return FullLoad(np.empty(0), np.empty(0), np.empty(0), np.empty(0, np.bool_))
    low = int(sums.i.min())
    columns = _columns(sums, low)
    reached = _side_by_side(columns.piled) & ~_dips(columns)
    torque, sd = columns.torque.copy(), _deviations(columns)
    if reached.any():
        torque[reached] = _smoothed(columns.rpm[reached], columns.torque[reached], sd[reached])
    seen = np.flatnonzero(columns.count > 0)
    centre = np.asarray(seen * COLUMN_RPM, dtype=np.float64)
    bound = closed(Envelope(centre, torque[seen]), COLUMN_RPM)
    nm = np.where(reached[seen], torque[seen], np.interp(centre, bound.rpm, bound.nm))
    return FullLoad(columns.rpm[seen], nm, sd[seen], reached[seen])


def _columns(sums: MomentSums, low: int) -> _Columns:
    n = int(sums.i.max()) - low + 1
    charge, rpm, torque, variance = (np.full(n, np.nan) for _ in range(4))
    count, piled = np.zeros(n, np.int64), np.zeros(n, np.bool_)
    edges = np.searchsorted(sums.i, low + np.arange(n + 1))
    for column, (a, b) in enumerate(pairwise(edges.tolist())):
        if a == b:
            continue
        k, moments = sums.k[a:b], sums.moments[a:b]
        within = np.array([moments[(k <= top) & (k > top - CEILING_ROWS)].sum() for top in k])
        full = np.flatnonzero(within >= FEWEST_MOMENTS)
        top = k[full[-1]] if len(full) else k[-1]
        at = (k <= top) & (k > top - CEILING_ROWS)
        below = moments[(k <= top - CEILING_ROWS) & (k > top - CEILING_ROWS - BELOW_ROWS)].sum()
        strayed, sweeps = moments[k > top].sum(), sums.sweeps[a:b][at].sum()
        spread_out = below * CEILING_ROWS / BELOW_ROWS
        count[column] = moments[at].sum()
        charge[column] = np.average(k[at], weights=moments[at])
        rpm[column] = sums.rpm_sum[a:b][at].sum() / count[column]
        torque[column] = sums.torque_sum[a:b][at].sum() / count[column]
        spread = sums.torque_squared_sum[a:b][at].sum() - count[column] * torque[column] ** 2
        variance[column] = max(spread, 0.0) / max(count[column] - 1, 1)
        many = max(FEWEST_MOMENTS, spread_out + PILE * np.sqrt(spread_out + 1.0))
        piled[column] = sweeps >= many and strayed <= STRAY_SHARE * count[column]
    return _Columns(charge, rpm, count, torque, variance, piled)


def _deviations(columns: _Columns) -> FloatArray:
    """Standard deviation of each column's mean torque, Nm.

    It is made of the relative scatter that all columns show together, and of not knowing where in its rows the ceiling
    lies.
    """
    known = columns.count >= 2
    if not known.any():
        return np.full(len(columns.count), np.nan)
    freedom = columns.count[known] - 1
    relative = np.sum(freedom * columns.variance[known] / columns.torque[known] ** 2) / freedom.sum()
    return np.asarray(np.sqrt(relative / np.maximum(columns.count, 1) + ROW_VARIANCE) * columns.torque)


def _side_by_side(piled: BoolArray) -> BoolArray:
    """Keep columns with a neighbour like them: wide open, an engine passes through more than one."""
    padded = np.concatenate(([False], piled, [False]))
    return np.asarray(piled & (padded[:-2] | padded[2:]))


def _dips(columns: _Columns) -> BoolArray:
    """Tell which columns took clearly less fuel than some on both sides, close by."""
    reach = round(DIP_RPM / 2.0 / COLUMN_RPM)
    filled = np.where(columns.count > 0, columns.charge, -np.inf)
    padded = np.concatenate((np.full(reach, -np.inf), filled, np.full(reach, -np.inf)))
    windows = np.lib.stride_tricks.sliding_window_view(padded, reach)
    left, right = windows[: len(filled)].max(axis=1), windows[reach + 1 :].max(axis=1)
    return np.asarray(np.minimum(left, right) > filled + DIP / STEP)


def _smoothed(rpm: FloatArray, torque: FloatArray, sd: FloatArray) -> FloatArray:
    """Return the most probable curve at these engine speeds: least squares with a penalty on changes of slope."""
    if len(torque) < 3:
        return torque
    place = (rpm - rpm[0]) / COLUMN_RPM
    size = int(place[-1]) + 2
    node = np.minimum(place.astype(np.int64), size - 2)
    between = np.zeros((len(rpm), size))
    each, share = np.arange(len(rpm)), place - node
    between[each, node], between[each, node + 1] = 1.0 - share, share
    bend = np.diff(np.eye(size), 2, axis=0) / (BEND * torque.max())
    weighted = between.T / np.maximum(sd, 1e-3 * torque) ** 2
    curve = np.linalg.solve(weighted @ between + bend.T @ bend, weighted @ torque)
    return np.asarray(between @ curve)
