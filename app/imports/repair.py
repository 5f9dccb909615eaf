"""Mending a foreign table's streams: order, repeats, impossible values, clocks, and samples that belong together."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field

import numpy as np

from app.imports.streams import Stream
from app.science.arrays import FloatArray
from app.science.logger.recording import ACCELEROMETER, GYROSCOPE, SIGNAL_UNITS

LIMITS: Mapping[str, tuple[float, float]] = {
    "speed_mps": (-30.0, 150.0),
    "gnss_speed_mps": (-30.0, 150.0),
    "engine_speed_rpm": (0.0, 25_000.0),
    "fuel_rate_lph": (0.0, 1000.0),
    "injector_pulse_s": (0.0, 1.0),
    "vss_tick": (0.0, 1e6),
    "ax_mps2": (-400.0, 400.0),
    "ay_mps2": (-400.0, 400.0),
    "az_mps2": (-400.0, 400.0),
    "gx_radps": (-100.0, 100.0),
    "gy_radps": (-100.0, 100.0),
    "gz_radps": (-100.0, 100.0),
    "lat_deg": (-90.0, 90.0),
    "lon_deg": (-180.0, 180.0),
    "alt_m": (-1000.0, 10_000.0),
    "hdop": (0.0, 100.0),
    "heading_deg": (-360.0, 720.0),
    "engine_torque_nm": (-10_000.0, 10_000.0),
    "maf_gps": (0.0, 5000.0),
    "battery_soc": (-0.1, 1.1),
}
"""What a car can do, widely drawn: a value outside is a sensor's way of saying “not available”."""

_EPOCH_SCALES = (1.0, 1e-3, 1e-6, 1e-9)
_YEAR_2000, _YEAR_2100 = 0.946e9, 4.103e9
EARLIEST_START_S, LATEST_START_S = -1.0, 3600.0
PAIRING_S = 0.5
CLOCK_TEXT = "clock_zero_s"
"""Key in `Recording.texts`: what the file's own clock showed at the recording's zero."""
SOURCE_TEXT = "source"
"""Key in `Recording.texts`: which known logger the table was taken for."""


@dataclass(slots=True)
class Repairs:
    """What had to be mended, gathered so that signals with the same trouble share a sentence."""

    _found: dict[str, list[str]] = field(default_factory=dict)

    def note(self, what: str, signal: str) -> None:
        """Add a finding; ``{}`` in it stands for the signals it holds for."""
        self._found.setdefault(what, []).append(signal)

    def sentences(self) -> list[str]:
        """Return the findings in sentences."""
        return [what.format(", ".join(dict.fromkeys(signals))) for what, signals in self._found.items()]


def tidy(name: str, stream: Stream, repairs: Repairs) -> Stream:
    """Leave out what can't be, sort by time, and keep the first of rows with the same time."""
    low, high = LIMITS.get(name, (-np.inf, np.inf))
    wrong = np.flatnonzero((stream.value < low) | (stream.value > high))
    if len(wrong):
        first = wrong[0]
        repairs.note(
            f"{{}}: {_values(len(wrong))} outside {low:g} to {high:g} {SIGNAL_UNITS[name]} left out (first: "
            f"{stream.value[first]:g} in row {stream.row[first]}).",
            name,
        )
        stream = stream.where((stream.value >= low) & (stream.value <= high))
    step = np.diff(stream.t_s)
    if np.all(step > 0.0):
        return stream
    back = np.flatnonzero(step < 0.0)
    if len(back):
        times = "once" if len(back) == 1 else f"{len(back)} times"
        repairs.note(f"{{}}: time went backwards {times} and was sorted (first: row {stream.row[back[0] + 1]}).", name)
        stream = stream.where(np.argsort(stream.t_s, kind="stable"))
    fresh = np.concatenate([[True], np.diff(stream.t_s) > 0.0])
    repeated = np.flatnonzero(~fresh)
    if len(repeated):
        repairs.note(
            f"{{}}: {_values(len(repeated))} at the same time as an earlier one left out (first: row "
            f"{stream.row[repeated].min()}).",
            name,
        )
    return stream.where(fresh)


@dataclass(frozen=True, slots=True)
class Clock:
    """How a file's times become the recording's: t = time · scale − zero; the file's clock showed `zero` at zero."""

    scale: float
    zero_s: float

    @property
    def is_utc(self) -> bool:
        """Whether the file's times are seconds (or parts of them) since 1970."""
        return self.zero_s >= _YEAR_2000


def find_clock(streams: Mapping[str, Stream]) -> Clock:
    """Tell seconds since 1970 (in s, ms, µs or ns) from a logger's own time, and where the recording's zero is.

    A logger's own time is kept, so that files of one logger stay together, unless it begins more than a second
    before 0 or an hour after.
    """
    times = np.concatenate([stream.t_s for stream in streams.values()])
    usual = float(np.median(times))
    for scale in _EPOCH_SCALES:
        if _YEAR_2000 <= usual * scale <= _YEAR_2100:
            return Clock(scale, float(times[times * scale >= _YEAR_2000].min()) * scale)
    first = float(times.min())
    return Clock(1.0, 0.0 if EARLIEST_START_S <= first <= LATEST_START_S else first)


def on_clock(name: str, stream: Stream, clock: Clock, repairs: Repairs) -> Stream:
    """Return the stream on the recording's time; stamps from before the clock was set are left out."""
    t_s = stream.t_s * clock.scale - clock.zero_s
    early = np.flatnonzero(t_s < EARLIEST_START_S)
    if len(early):
        repairs.note(
            f"{{}}: {_values(len(early))} from before the logger's clock was set left out (first: row "
            f"{stream.row[early[0]]}).",
            name,
        )
    return Stream(t_s, stream.value, stream.row).where(t_s >= EARLIEST_START_S)


def sampled_together(streams: dict[str, Stream], repairs: Repairs) -> dict[str, Stream]:
    """Give signals that belong together the very same times: sensor axes; latitude, longitude and HDOP of one fix."""
    result = dict(streams)
    for group in (ACCELEROMETER, GYROSCOPE, ("lat_deg", "lon_deg")):
        present = [name for name in group if name in result]
        if len(present) > 1:
            result |= _paired({name: result[name] for name in present}, repairs)
    if ("lat_deg" in result) != ("lon_deg" in result):
        lonely = "lat_deg" if "lat_deg" in result else "lon_deg"
        repairs.note("{} is there without its partner and was left out.", lonely)
        del result[lonely]
    if "lat_deg" in result:
        lat, lon = result["lat_deg"], result["lon_deg"]
        real = (lat.value != 0.0) | (lon.value != 0.0)
        if not real.all():
            repairs.note(f"{{}}: {_values(int((~real).sum()))} at 0° north, 0° east (no fix) left out.", "lat_deg")
            result |= {"lat_deg": lat.where(real), "lon_deg": lon.where(real)}
    if "hdop" in result and "lat_deg" in result:
        result["hdop"] = _at_times(result["hdop"], result["lat_deg"])
    return result


def _paired(streams: dict[str, Stream], repairs: Repairs) -> dict[str, Stream]:
    first = next(iter(streams.values()))
    if all(np.array_equal(first.t_s, other.t_s) for other in streams.values()):
        return {name: Stream(first.t_s, stream.value, stream.row) for name, stream in streams.items()}
    common = first.t_s
    for other in streams.values():
        common = np.intersect1d(common, other.t_s, assume_unique=True)
    names = ", ".join(streams)
    if 2 * len(common) >= len(first):
        lost = max(len(stream) for stream in streams.values()) - len(common)
        repairs.note(f"{names}: {_values(lost)} without partners at the same time left out.", "")
        return {name: stream.where(np.isin(stream.t_s, common)) for name, stream in streams.items()}
    repairs.note(f"{names} were not sampled at the same times and have been interpolated to the first one's.", "")
    inside = np.ones(len(first), dtype=np.bool_)
    for other in streams.values():
        inside &= _distance_to_samples(other.t_s, first.t_s) <= PAIRING_S
    t_s, row = first.t_s[inside], first.row[inside]
    return {name: Stream(t_s, np.interp(t_s, stream.t_s, stream.value), row) for name, stream in streams.items()}


def _distance_to_samples(samples: FloatArray, t_s: FloatArray) -> FloatArray:
    after = np.clip(np.searchsorted(samples, t_s), 0, len(samples) - 1)
    before = np.maximum(after - 1, 0)
    return np.minimum(np.abs(samples[after] - t_s), np.abs(samples[before] - t_s))


def _at_times(stream: Stream, other: Stream) -> Stream:
    """Return the stream's last value at or before each time of the other."""
    at = np.maximum(np.searchsorted(stream.t_s, other.t_s, side="right") - 1, 0)
    return Stream(other.t_s, stream.value[at], other.row)


def _values(count: int) -> str:
    return "1 value" if count == 1 else f"{count} values"
