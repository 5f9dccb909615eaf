"""When a moment counts as an operating point."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from app.science.arrays import BoolArray, FloatArray


@dataclass(frozen=True, slots=True)
class PointRules:
    """Which moments show what the engine does with its fuel.

    Attributes
    ----------
    min_power_w : float
        The engine propels the car above this mechanical power.
    settle_s : float
        Nothing counts this close to a change of gear, on either side: the clutch slips, and the observer's estimates
        of thrust and fuel power need that long to follow.
    max_gap_s : float
        A signal is interpolated only between samples at most this far apart.
    max_sd : float
        A point of the observer whose own standard deviation of efficiency is larger says nothing about a cell that
        has to agree within as much. An observer that is unsure all along is judged by the scatter in its cells
        instead: points up to twice the trip's median deviation count in any case.
    """

    min_power_w: float = 2000.0
    settle_s: float = 0.5
    max_gap_s: float = 10.0
    max_sd: float = 0.05


def meaningful(power_w: FloatArray, fuel_power_w: FloatArray, rules: PointRules) -> BoolArray:
    """Tell where the engine propels the car by burning fuel.

    A moment at which more work comes out than fuel goes in is a transient of the estimates, not an efficiency. NaN
    never counts.
    """
    return np.asarray((power_w > rules.min_power_w) & (fuel_power_w > power_w) & np.isfinite(fuel_power_w))


def settled(t_s: FloatArray, gear_t_s: FloatArray, gear: FloatArray, rules: PointRules) -> BoolArray:
    """Tell at which times a gear is in and has been in, and stays in, for the settling time.

    Parameters
    ----------
    t_s : array, shape (n,)
        Times asked for, seconds.
    gear_t_s, gear : array, shape (m,)
        Gear over time; 0 is neutral, an open clutch or unknown.
    rules : PointRules
    """
    if not len(gear_t_s):
        return np.zeros(len(t_s), dtype=np.bool_)
    nearest = np.clip(np.searchsorted(gear_t_s, t_s, side="right") - 1, 0, len(gear) - 1)
    in_gear = gear[nearest] >= 1
    changes = gear_t_s[1:][np.diff(gear) != 0]
    first_after = np.searchsorted(changes, t_s)
    padded = np.concatenate(([-np.inf], changes, [np.inf]))
    since, until = t_s - padded[first_after], padded[first_after + 1] - t_s
    return np.asarray(in_gear & (np.minimum(since, until) >= rules.settle_s))


def certain(efficiency_sd: FloatArray, rules: PointRules) -> BoolArray:
    """Tell which points are certain enough; a point whose deviation is unknown is not."""
    known = efficiency_sd[np.isfinite(efficiency_sd)]
    largest = max(rules.max_sd, 2.0 * float(np.median(known))) if len(known) else rules.max_sd
    return np.asarray(efficiency_sd <= largest)
