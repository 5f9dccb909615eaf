"""Slow changes: how freely a cell's parameters may wander, told from how far the filter was made to move."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from app.science.arrays import FloatArray
from app.science.battery.kalman.belief import Belief
from app.science.battery.kalman.layout import RELAXATION_V, SOC, STATES

MEMORY = 0.98
"""Share of the evidence for a trend that is left after a stretch."""
JUMP_NEWEST = 0.3
"""Weight of the newest stretch in the running mean of squares."""
TREND_ALARM, JUMP_ALARM = 3.5, 4.0
"""Standard deviations of a trend, and mean square of moves over what it should be, at which a parameter changes."""
TREND_LASTS, JUMP_LASTS = 2.0, 1.5
"""Below both of these nothing speaks for a change any more."""
TREND_STRONG, JUMP_STRONG = 4.0, 2.0
"""Above one of these a parameter changes faster than it is let to."""
FASTER, CALMER = 1.3, 0.85
"""What its freedom is multiplied with then, or where nothing speaks for it."""
WIDEST = 0.1
"""A parameter is let wander by at most such a share of itself over a stretch."""
IDLE = 0.02
"""Share of the expected move's variance below which freedom is nothing."""


@dataclass(frozen=True, slots=True)
class Drift:
    """By how much variances grow on their own, and the evidence for it; every array is (7,).

    Over a stretch the estimate of something constant moves by an amount whose variance is what its own variance has
    shrunk by, to either side. Where it moves farther, or to the same side time after time, it is not constant.

    Attributes
    ----------
    walks : ndarray
        Variance per second.
    trend, weight : ndarray
        Sum of moves over their expected standard deviations, older ones counting less, and the sum's variance.
    jump : ndarray
        Running mean of squared moves over their expected variances.
    """

    walks: FloatArray
    trend: FloatArray
    weight: FloatArray
    jump: FloatArray


def still() -> Drift:
    """Return that nothing changes."""
    return Drift(np.zeros(STATES), np.zeros(STATES), np.zeros(STATES), np.ones(STATES))


def seen(drift: Drift, before: Belief, after: Belief, elapsed_s: float) -> tuple[Drift, Belief]:
    """Return what a stretch tells about slow changes, and the belief after it, opened where one was found.

    Parameters
    ----------
    drift : Drift
        As it was during the stretch.
    before, after : Belief
    elapsed_s : float
        Length of the stretch.

    Returns
    -------
    Drift, Belief
    """
    variance = np.diag(after.covariance)
    expected = np.diag(before.covariance) + drift.walks * elapsed_s - variance
    told = expected > 1e-3 * variance
    told[[SOC, RELAXATION_V]] = False
    expected = np.where(told, expected, 1.0)
    moved = np.where(told, after.mean - before.mean, 0.0)
    trend = np.where(told, MEMORY * drift.trend + moved / np.sqrt(expected), drift.trend)
    weight = np.where(told, MEMORY**2 * drift.weight + 1.0, drift.weight)
    jump = np.where(told, drift.jump + JUMP_NEWEST * (moved**2 / expected - drift.jump), drift.jump)
    steady = np.abs(trend) / np.sqrt(np.maximum(weight, 1.0))

    active = drift.walks > 0.0
    starts = told & ~active & ((steady > TREND_ALARM) | (jump > JUMP_ALARM))
    lasts = (steady > TREND_LASTS) | (jump > JUMP_LASTS)
    strong = (steady > TREND_STRONG) | (jump > JUMP_STRONG)
    walks = drift.walks * np.where(strong, FASTER, np.where(lasts, 1.0, CALMER))
    walks = np.where(told & (walks * elapsed_s < IDLE * expected), 0.0, np.where(told, walks, drift.walks))
    walks = np.where(starts, _freedom(moved, expected, variance) / elapsed_s, walks)
    walks = np.minimum(walks, WIDEST**2 / elapsed_s)
    opened = after.copy()
    behind = np.minimum(np.maximum(steady**2, jump) * variance, WIDEST**2)
    opened.covariance[np.diag_indices(STATES)] += np.where(starts, behind, 0.0)
    return Drift(
        walks, np.where(starts, 0.0, trend), np.where(starts, 0.0, weight), np.where(starts, 1.0, jump)
    ), opened


def _freedom(moved: FloatArray, expected: FloatArray, variance: FloatArray) -> FloatArray:
    """Return the variance per stretch with which a filter lags behind a steady change by its own standard deviation.

    For one unknown that is told with a variance v in each stretch, and changes by d, that is (d⁴ v)^⅓: with little
    freedom q the gain is √(q/v), the lag d √(v/q), and the filter's variance √(q v). While an estimator still takes
    the unknown for a constant, it moves by about half of d.
    """
    told_with = variance * (variance + expected) / expected
    change = 2.0 * np.abs(moved)
    return np.asarray(np.cbrt(change**4 * told_with))
