"""From a trip's packets to a recording in SI units."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from app.science.arrays import AnyArray, FloatArray
from app.science.logger import kernels as k
from app.science.logger.fixes import merge_fixes
from app.science.logger.gnss_clock import GnssTimes, align_fixes
from app.science.logger.nmea import Sentences
from app.science.logger.recording import ACCELEROMETER, Recording, Series
from app.science.logger.trips import Trip

MPS2_PER_COUNT = 9.80665e-3
TICK_S = 125e-6
S_PER_INJECTOR_COUNT = 250e-9
FIRST_HOUR_MS = 3_600_000
COURSE_FROM_MPS = 1.5
"""A receiver's course means nothing when it hardly moves."""


@dataclass(frozen=True, slots=True)
class Assembled:
    """A recording and where it comes from.

    Attributes
    ----------
    recording : Recording
    clock_origin_ms : int
        Milliseconds since power-on at time zero.
    gnss : GnssTimes or None
        How the fixes were put on the logger's clock; None without fixes.
    """

    recording: Recording
    clock_origin_ms: int
    gnss: GnssTimes | None


def assemble(trip: Trip) -> Assembled:
    """Convert counts to SI units and put every signal on one clock.

    Time zero is the logger's own (power-on) for the first trip of a power-on that begins within the first hour; any
    other trip begins at zero with its first packet. Times of one signal increase strictly: samples are sorted, of
    several at one time the first is kept.

    Parameters
    ----------
    trip : Trip

    Returns
    -------
    Assembled
    """
    first_ms = min(piece.first_ms for piece in trip.pieces if len(piece.timed))
    origin_ms = 0 if trip.is_first and first_ms < FIRST_HOUR_MS else first_ms
    signals: dict[str, Series] = {}

    counts = OfOneKind(trip, k.ACCELEROMETER, origin_ms)
    axes = {name: counts.values(axis, MPS2_PER_COUNT, np.int16) for axis, name in enumerate(ACCELEROMETER)}
    put(signals, counts.t_s, axes)
    ticks = OfOneKind(trip, k.VSS, origin_ms)
    put(signals, ticks.t_s + ticks.values(0, TICK_S), {"vss_tick": np.ones(len(ticks.t_s))})
    pulses = OfOneKind(trip, k.INJECTOR, origin_ms)
    put(signals, pulses.t_s, {"injector_pulse_s": pulses.values(0, S_PER_INJECTOR_COUNT)})
    gnss, started_at_utc_s = put_fixes(signals, trip, origin_ms), None
    if "utc_s" in signals:
        utc = signals["utc_s"]
        started_at_utc_s = float(utc.value[0] - utc.t_s[0])
    text = b"".join(piece.text.text.tobytes() for piece in trip.pieces).decode("latin-1")
    return Assembled(Recording(signals, started_at_utc_s, {"nmea": text} if text else {}), origin_ms, gnss)


class OfOneKind:
    """Packets of one type on the recording's clock."""

    def __init__(self, trip: Trip, kind: int, origin_ms: int) -> None:
        self._timed = [piece.timed for piece in trip.pieces]
        self._rows = [np.flatnonzero(timed.kind == kind) for timed in self._timed]
        t_ms = joined([timed.t_ms[rows] for timed, rows in zip(self._timed, self._rows, strict=True)])
        self.t_s: FloatArray = (t_ms - origin_ms) / 1e3

    def values(self, index: int, scale: float, dtype: type[np.integer[Any]] = np.uint16) -> FloatArray:
        """Return one of their 16-bit values, scaled."""
        counts = joined([timed.words[rows, index] for timed, rows in zip(self._timed, self._rows, strict=True)])
        return np.asarray(counts.view(dtype), np.float64) * scale


def joined(parts: list[AnyArray]) -> AnyArray:
    """Join the arrays of a trip's pieces."""
    return np.concatenate(parts)


def put(signals: dict[str, Series], t_s: FloatArray, values: dict[str, FloatArray]) -> None:
    """Add signals sampled together, which then share their times; NaN is left out."""
    if len(t_s) and not np.all(np.diff(t_s) > 0):
        t_s, first = np.unique(t_s, return_index=True)
        values = {name: value[first] for name, value in values.items()}
    for name, value in values.items():
        good = np.isfinite(value)
        if len(value) and good.all():
            signals[name] = Series(t_s, np.ascontiguousarray(value))
        elif good.any():
            signals[name] = Series(t_s[good], value[good])


def put_fixes(signals: dict[str, Series], trip: Trip, origin_ms: int) -> GnssTimes | None:
    """Add what the receiver said wherever it had a position."""
    told = [piece.told for piece in trip.pieces]
    sentences = Sentences(*(joined([getattr(t.sentences, name) for t in told]) for name in ("kind", "start", "values")))
    fixes = merge_fixes(sentences)
    valid = np.flatnonzero(fixes.valid)
    if len(valid) == 0:
        return None
    arrival_s = (joined([t.after_ms for t in told])[fixes.first[valid]] - origin_ms) / 1e3
    gnss = align_fixes(fixes.utc_s[valid], arrival_s)
    rows = valid[gnss.used]
    speed, course = fixes.speed_mps[rows], fixes.course_deg[rows]
    values = {
        "lat_deg": fixes.lat_deg[rows],
        "lon_deg": fixes.lon_deg[rows],
        "alt_m": fixes.alt_m[rows],
        "hdop": fixes.hdop[rows],
        "satellites": fixes.satellites[rows],
        "gnss_speed_mps": speed,
        "heading_deg": np.where(speed >= COURSE_FROM_MPS, course, np.nan),
        "utc_s": fixes.utc_s[rows] if fixes.has_date else np.full(len(rows), np.nan),
    }
    put(signals, gnss.t_s[gnss.used], values)
    return gnss
