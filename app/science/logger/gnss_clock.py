"""When, on the logger's clock, a fix was valid.

GPS packets carry no logger time; all that is known is between which other packets they stand. UTC spaces the fixes
evenly, their arrival ties UTC to the logger's clock.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from app.science.arrays import BoolArray, FloatArray, IntArray

WINDOW_S = 60.0
"""The logger's clock may drift (its oscillator is an RC circuit in the first loggers), but evenly over this long."""
FEWEST_IN_WINDOW = 5
OUTLIER_S = 1.5
FLOOR = 0.02
"""Share of arrivals allowed to be earlier than the quickest ones: time stamps interleave a little out of turn."""
STEEPEST = 0.03
"""Largest drift believed in a recording too short to measure it well."""


@dataclass(frozen=True, slots=True)
class GnssTimes:
    """Fixes on the logger's clock.

    Attributes
    ----------
    t_s : array, shape (n,)
        Time of each fix on the clock of the arrivals, seconds.
    used : array of bool, shape (n,)
        False where UTC and arrival disagree by more than `OUTLIER_S` with the fixes around.
    rate_ppm : float
        How much faster than UTC the logger's clock runs, in millionths.
    latency_spread_s : float
        Between the 5th and the 95th percentile of the arrivals' delay behind the quickest ones.
    """

    t_s: FloatArray
    used: BoolArray
    rate_ppm: float
    latency_spread_s: float


def align_fixes(utc_s: FloatArray, arrival_s: FloatArray) -> GnssTimes:
    """Fit the logger's clock to UTC, minute by minute, under the arrivals.

    A fix arrives after the moment it is valid for, by a latency that varies with the receiver's load and with the
    filling of the logger's buffers. Medians per window give the run of the clock, free of outliers; the lower envelope
    of the arrivals around it takes the varying part of the latency away. Its constant part can't be seen from here.

    Parameters
    ----------
    utc_s : array, shape (n,)
        UTC of each fix, increasing but for outliers.
    arrival_s : array, shape (n,)
        Earliest time on the logger's clock by which the fix is known to have arrived.

    Returns
    -------
    GnssTimes
    """
    count = len(utc_s)
    if count == 0:
        return GnssTimes(np.empty(0), np.empty(0, np.bool_), 0.0, 0.0)
    x = utc_s - np.median(utc_s)
    delay = arrival_s - arrival_s[0] - x
    windows = windows_of(x)
    centre = np.array([np.median(x[rows]) for rows in windows])
    middle = np.array([np.median(delay[rows]) for rows in windows])
    late = delay - drift(x, centre, middle)
    used = np.abs(late) <= OUTLIER_S
    envelope = [np.quantile(late[rows][used[rows]], FLOOR) if used[rows].any() else 0.0 for rows in windows]
    late = late - np.interp(x, centre, envelope)
    spread = np.percentile(late[used], (5, 95)) if used.any() else np.zeros(2)
    span = float(centre[-1] - centre[0])
    return GnssTimes(
        t_s=arrival_s - late,
        used=used,
        rate_ppm=1e6 * float(middle[-1] - middle[0]) / span if span > 0 else 0.0,
        latency_spread_s=float(spread[1] - spread[0]),
    )


def windows_of(x: FloatArray) -> list[IntArray]:
    """Split rows into windows of equal duration, at most `WINDOW_S` long where there are rows enough."""
    low, high = np.percentile(x, (1.0, 99.0))
    span = float(high - low)
    count = max(int(span // WINDOW_S), 2 if len(x) >= 2 * FEWEST_IN_WINDOW and span > 0 else 1)
    window = np.clip((x - low) * (count / span) if span > 0 else np.zeros(len(x)), 0, count - 1).astype(np.int64)
    order = np.argsort(window, kind="stable")
    parts = np.split(order, np.flatnonzero(np.diff(window[order])) + 1)
    return [rows for rows in parts if len(rows) >= FEWEST_IN_WINDOW] or [np.arange(len(x))]


def drift(x: FloatArray, centre: FloatArray, middle: FloatArray) -> FloatArray:
    """Join the windows' medians by straight lines, going straight on beyond the first and the last."""
    inside = np.interp(x, centre, middle)
    if len(centre) < 2:
        return inside
    slope = np.clip(np.diff(middle) / np.diff(centre), -STEEPEST, STEEPEST)
    before, after = np.minimum(x - centre[0], 0.0), np.maximum(x - centre[-1], 0.0)
    return np.asarray(inside + slope[0] * before + slope[-1] * after)
