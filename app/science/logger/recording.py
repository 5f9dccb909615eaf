"""Measurement streams of one trip: the common form of every kind of input.

A logger image, a signals table and any foreign log all become a `Recording`: per signal name, strictly increasing
times and values in SI units. Sensor axes stay raw; the car's XML rotates them later.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field

import numpy as np

from app.science.arrays import FloatArray

SIGNAL_UNITS: Mapping[str, str] = {
    # the signals table of the contract
    "speed_mps": "m/s",
    "engine_speed_rpm": "rpm",
    "fuel_rate_lph": "l/h",
    "injector_pulse_s": "s",  # one row per pulse: opening time of the injector and how long the voltage was on
    "vss_tick": "1",  # one row per tick of the wheel-speed sensor; the value is the number of ticks, usually 1
    "ax_mps2": "m/s²",
    "ay_mps2": "m/s²",
    "az_mps2": "m/s²",
    "gx_radps": "rad/s",
    "gy_radps": "rad/s",
    "gz_radps": "rad/s",
    "lat_deg": "°",
    "lon_deg": "°",
    "alt_m": "m",
    "hdop": "1",
    "heading_deg": "°",
    "engine_torque_nm": "Nm",
    "maf_gps": "g/s",
    "battery_current_a": "A",
    "battery_voltage_v": "V",
    "battery_soc": "1",
    # what receivers and road maps add
    "gnss_speed_mps": "m/s",
    "satellites": "1",
    "utc_s": "s",  # UTC as seconds since 1970-01-01, at the recording's own clock
    "road_heading_deg": "°",
    "road_curvature_radpm": "rad/m",
    "road_alt_m": "m",
    "pitch_rad": "rad",
}
"""Every signal Ponthy knows, with its unit."""

ACCELEROMETER = ("ax_mps2", "ay_mps2", "az_mps2")
GYROSCOPE = ("gx_radps", "gy_radps", "gz_radps")


@dataclass(frozen=True, slots=True)
class Series:
    """One signal over time.

    Attributes
    ----------
    t_s : array, shape (n,)
        Strictly increasing times since the start of the recording, seconds.
    value : array, shape (n,)
        Values in the signal's unit (`SIGNAL_UNITS`); NaN never occurs.
    """

    t_s: FloatArray
    value: FloatArray

    def __len__(self) -> int:
        return len(self.t_s)


@dataclass(frozen=True, slots=True)
class Recording:
    """All measurements of one trip.

    Attributes
    ----------
    signals : mapping of str to Series
        By name of `SIGNAL_UNITS`. A signal without samples is absent. Signals sampled together (the three
        accelerometer axes; ``lat_deg``, ``lon_deg`` and ``hdop`` of one fix) share the very same times.
    started_at_utc_s : float or None
        UTC of time zero, seconds since 1970-01-01, when a receiver or a file told it.
    texts : mapping of str to str
        Material kept as it came, for example the NMEA sentences under ``nmea``.
    warnings : tuple of str
        What was repaired or left out, in words.
    """

    signals: Mapping[str, Series]
    started_at_utc_s: float | None = None
    texts: Mapping[str, str] = field(default_factory=dict)
    warnings: tuple[str, ...] = ()

    def __contains__(self, name: object) -> bool:
        return name in self.signals

    def __getitem__(self, name: str) -> Series:
        return self.signals[name]

    def get(self, name: str) -> Series | None:
        """Return the series of that name, or None."""
        return self.signals.get(name)

    def __iter__(self) -> Iterator[str]:
        return iter(self.signals)

    @property
    def duration_s(self) -> float:
        """Time from the first to the last sample of any signal, seconds; time zero may lie long before."""
        sampled = [s for s in self.signals.values() if len(s)]
        if not sampled:
            return 0.0
        return max(float(s.t_s[-1]) for s in sampled) - min(float(s.t_s[0]) for s in sampled)

    @property
    def sample_count(self) -> int:
        """Number of samples of all signals together."""
        return sum(len(s) for s in self.signals.values())

    def without(self, names: set[str]) -> Recording:
        """Return the same recording with the named signals left out."""
        kept = {k: v for k, v in self.signals.items() if k not in names}
        return Recording(kept, self.started_at_utc_s, self.texts, self.warnings)


def series(t_s: object, value: object) -> Series:
    """Build a `Series`: sorted by time, rows with NaN dropped, of duplicated times the first kept.

    Parameters
    ----------
    t_s, value : array_like, shape (n,)
        Times in seconds and values.
    """
    t = np.asarray(t_s, dtype=np.float64)
    v = np.asarray(value, dtype=np.float64)
    good = np.isfinite(t) & np.isfinite(v)
    t, v = t[good], v[good]
    if len(t) > 1 and not np.all(np.diff(t) > 0):
        t, first = np.unique(t, return_index=True)
        v = v[first]
    return Series(np.ascontiguousarray(t), np.ascontiguousarray(v))
