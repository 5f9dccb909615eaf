"""Sentences of one moment merged into one fix."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from app.science.arrays import BoolArray, FloatArray, IntArray
from app.science.logger import nmea_kernels as k
from app.science.logger.nmea import Sentences

DAY_S = 86_400.0


@dataclass(frozen=True, slots=True)
class Fixes:
    """One row per moment the receiver reported on, arrays of shape (n,); NaN where it didn't say.

    Attributes
    ----------
    utc_s : array
        UTC as seconds since 1970-01-01 when `has_date`, else since midnight of the first day; goes on over midnight.
    has_date : bool
        A sentence told the date.
    first : array of int
        Index of the sentence with which the moment began.
    valid : array of bool
        The receiver says it has a position, and gives one.
    lat_deg, lon_deg, alt_m, hdop, satellites, speed_mps, course_deg : array
    """

    utc_s: FloatArray
    has_date: bool
    first: IntArray
    valid: BoolArray
    lat_deg: FloatArray
    lon_deg: FloatArray
    alt_m: FloatArray
    hdop: FloatArray
    satellites: FloatArray
    speed_mps: FloatArray
    course_deg: FloatArray

    def __len__(self) -> int:
        return len(self.utc_s)


def merge_fixes(sentences: Sentences) -> Fixes:
    """Merge sentences that tell the same time of day one after the other.

    GSA and VTG tell no time and belong to the moment before them. Where two sentences say the same, the first counts,
    for positions a GGA before an RMC, for speed an RMC before a VTG, for precision a GGA before a GSA; a precision
    holds until the next one. A moment is invalid as soon as one of its sentences says so.

    Parameters
    ----------
    sentences : Sentences

    Returns
    -------
    Fixes
    """
    kind, values = sentences.kind, sentences.values
    time_of_day = values[:, k.TIME_OF_DAY]
    timed = np.flatnonzero(np.isfinite(time_of_day))
    begins = np.zeros(len(kind), np.bool_)
    begins[timed] = np.diff(time_of_day[timed], prepend=np.nan) != 0.0
    moment = np.cumsum(begins) - 1
    count = int(moment[-1]) + 1 if len(kind) else 0

    def merged(column: int, *kinds: int) -> FloatArray:
        """First finite value per moment of the preferred kind that has one."""
        out = np.full(count, np.nan)
        for wanted in reversed(kinds):
            rows = np.flatnonzero((kind == wanted) & (moment >= 0) & np.isfinite(values[:, column]))[::-1]
            out[moment[rows]] = values[rows, column]
        return out

    told = (moment >= 0) & np.isfinite(values[:, k.QUALITY])
    denied = np.zeros(count, np.bool_)
    denied[moment[told & (values[:, k.QUALITY] == 0.0)]] = True
    lat, lon = merged(k.LAT, k.GGA, k.RMC), merged(k.LON, k.GGA, k.RMC)
    first = np.flatnonzero(begins)
    continuous_s = continuous_time(time_of_day[first])
    day = first_day(merged(k.DAY, k.RMC), continuous_s)
    return Fixes(
        utc_s=continuous_s + (DAY_S * day if np.isfinite(day) else 0.0),
        has_date=bool(np.isfinite(day)),
        first=first,
        valid=~denied & np.isfinite(lat) & np.isfinite(lon),
        lat_deg=lat,
        lon_deg=lon,
        alt_m=merged(k.ALT, k.GGA),
        hdop=held(merged(k.HDOP, k.GGA, k.GSA)),
        satellites=merged(k.SATELLITES, k.GGA),
        speed_mps=merged(k.SPEED, k.RMC, k.VTG),
        course_deg=merged(k.COURSE, k.RMC, k.VTG),
    )


def held(value: FloatArray) -> FloatArray:
    """Fill NaN with the value before it."""
    last = np.maximum.accumulate(np.where(np.isfinite(value), np.arange(len(value)), -1))
    return np.where(last >= 0, value[last], np.nan)


def continuous_time(time_of_day_s: FloatArray) -> FloatArray:
    """Seconds since midnight of the first day: a time of day that falls by more than half a day is a new day."""
    step = np.diff(time_of_day_s, prepend=time_of_day_s[:1])
    days = np.cumsum((step < -DAY_S / 2).astype(np.int64) - (step > DAY_S / 2))
    return time_of_day_s + DAY_S * days


def first_day(day: FloatArray, continuous_s: FloatArray) -> float:
    """Date of the first day, as most dates of the text have it, in days since 1970; NaN when none is told."""
    known = np.isfinite(day)
    return float(np.median(day[known] - continuous_s[known] // DAY_S)) // 1 if known.any() else float("nan")
