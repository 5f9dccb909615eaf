"""The GPS receiver: NMEA sentences with a slowly wandering error, cold start and outages."""

from __future__ import annotations

from dataclasses import dataclass
from datetime import UTC, datetime, timedelta
from functools import reduce

import numpy as np
from pyproj import Transformer
from scipy.signal import lfilter

from app.science.arrays import FloatArray
from app.science.virtualcar.specification import SensorSettings

FIX_STEP_S = 0.2
_BYTES_PER_S = 3840.0
_GEOID_M = 47.0
_KNOTS_PER_MPS = 3600.0 / 1852.0


@dataclass(frozen=True, slots=True)
class Outage:
    """Time without a fix, trip seconds."""

    begin_s: float
    end_s: float


@dataclass(frozen=True, slots=True)
class SentenceBurst:
    """The text of one fix and when its first byte reaches the logger, trip seconds."""

    t_s: float
    text: bytes


def to_geographic(north_m: FloatArray, east_m: FloatArray, lat0_deg: float, lon0_deg: float) -> FloatArray:
    """Latitude and longitude (degrees), shape (n, 2), of points on the transverse Mercator plane at a centre."""
    transformer = Transformer.from_crs(
        f"+proj=tmerc +lat_0={lat0_deg!r} +lon_0={lon0_deg!r} +k=1 +ellps=WGS84 +units=m", "EPSG:4326", always_xy=True
    )
    lon, lat = transformer.transform(east_m, north_m)
    return np.column_stack([lat, lon])


def draw_outages(duration_s: float, settings: SensorSettings, tunnel: bool, rng: np.random.Generator) -> list[Outage]:
    """Cold start, short losses at random times, and for a tunnel three minutes in the middle; in order, disjoint."""
    begins = rng.uniform(
        60.0, max(duration_s - 60.0, 61.0), rng.poisson(settings.gps_outages_per_hour * duration_s / 3600)
    )
    raw = [Outage(0.0, settings.gps_cold_start_s)]
    raw += [Outage(float(b), float(b + rng.uniform(5.0, 40.0))) for b in begins]
    if tunnel:
        middle = 0.5 * duration_s
        raw.append(Outage(max(middle - 90.0, 30.0), middle + 90.0))
    merged: list[Outage] = []
    for outage in sorted(raw, key=lambda o: o.begin_s):
        if merged and outage.begin_s <= merged[-1].end_s + 1.0:
            merged[-1] = Outage(merged[-1].begin_s, max(merged[-1].end_s, outage.end_s))
        else:
            merged.append(outage)
    return merged


def wandering(n: int, sd: float, correlation_s: float, rng: np.random.Generator) -> FloatArray:
    """First-order Gauss–Markov sequence every `FIX_STEP_S`, stationary from the start, shape (n,)."""
    keep = np.exp(-FIX_STEP_S / correlation_s)
    white = rng.standard_normal(n)
    white[1:] *= np.sqrt(1.0 - keep**2)
    return sd * np.asarray(lfilter([1.0], [1.0, -keep], white))


def fixes(
    t_s: FloatArray,
    lat_deg: FloatArray,
    lon_deg: FloatArray,
    alt_m: FloatArray,
    speed_mps: FloatArray,
    heading_rad: FloatArray,
    *,
    started_at_utc_s: float,
    outages: list[Outage],
    settings: SensorSettings,
    rng: np.random.Generator,
) -> list[SentenceBurst]:
    """GGA, GSA, RMC and VTG of every fix.

    Parameters
    ----------
    t_s : array, shape (n,)
        Trip time of the fixes; their UTC is ``started_at_utc_s + t_s``.
    lat_deg, lon_deg, alt_m, speed_mps, heading_rad : array, shape (n,)
        Truth at these times.
    """
    n = len(t_s)
    horizontal, vertical = settings.gps_sd_m
    tau_h, tau_v = settings.gps_correlation_s
    white_h, white_v = settings.gps_white_sd_m
    north = wandering(n, horizontal, tau_h, rng) + white_h * rng.standard_normal(n)
    east = wandering(n, horizontal, tau_h, rng) + white_h * rng.standard_normal(n)
    up = wandering(n, vertical, tau_v, rng) + white_v * rng.standard_normal(n)
    lat = lat_deg + north / 111_200.0
    lon = lon_deg + east / (111_320.0 * np.cos(np.radians(lat_deg)))
    hdop = np.clip(1.1 + wandering(n, 0.25, 200.0, rng), 0.7, 3.0)
    satellites = np.clip(np.rint(8.5 - 3.0 * (hdop - 1.1)), 4, 12).astype(int)
    speed = np.abs(speed_mps + 0.08 * rng.standard_normal(n))
    course = np.degrees(heading_rad) + np.degrees(0.15 / np.maximum(speed_mps, 0.5)) * rng.standard_normal(n)
    blind = np.zeros(n, dtype=bool)
    for outage in outages:
        blind |= (t_s >= outage.begin_s) & (t_s < outage.end_s)
    epoch = datetime.fromtimestamp(started_at_utc_s, UTC)
    bursts = []
    for i in range(n):
        moment = epoch + timedelta(seconds=round(float(t_s[i]), 3))
        if blind[i]:
            text = _no_fix(moment, known_time=t_s[i] > 0.3 * settings.gps_cold_start_s)
        else:
            text = _fix(
                moment, lat[i], lon[i], alt_m[i] + up[i], hdop[i], int(satellites[i]), speed[i], course[i] % 360.0
            )
        bursts.append(SentenceBurst(float(t_s[i]) + settings.gps_latency_s, text))
    return bursts


def packets_of(bursts: list[SentenceBurst], packet_bytes: int) -> tuple[list[float], list[bytes]]:
    """Cut the text into packets of a fixed size, each with the time its last byte came; an unfilled rest is lost."""
    times: list[float] = []
    chunks: list[bytes] = []
    buffer = b""
    for burst in bursts:
        taken = 0
        while len(buffer) + len(burst.text) - taken >= packet_bytes:
            missing = packet_bytes - len(buffer)
            chunks.append(buffer + burst.text[taken : taken + missing])
            taken += missing
            times.append(burst.t_s + taken / _BYTES_PER_S)
            buffer = b""
        buffer += burst.text[taken:]
    return times, chunks


def sentence(body: str) -> bytes:
    """Frame a sentence: ``$``, body, ``*``, exclusive-or of the body's bytes in hex, line end."""
    raw = body.encode("ascii")
    return b"$%s*%02X\r\n" % (raw, reduce(lambda a, b: a ^ b, raw, 0))


def _angle(value_deg: float, width: int, letters: str) -> str:
    minutes_total = round(abs(value_deg) * 60.0, 5)
    degrees, minutes = divmod(minutes_total, 60.0)
    return f"{int(degrees):0{width}d}{minutes:08.5f},{letters[0] if value_deg >= 0 else letters[1]}"


def _fix(
    moment: datetime, lat: float, lon: float, alt: float, hdop: float, satellites: int, speed: float, course: float
) -> bytes:
    clock = f"{moment:%H%M%S}.{moment.microsecond // 10000:02d}"
    place = f"{_angle(lat, 2, 'NS')},{_angle(lon, 3, 'EW')}"
    used = ",".join(f"{2 + 3 * i:02d}" if i < satellites else "" for i in range(12))
    knots = speed * _KNOTS_PER_MPS
    return b"".join(
        (
            sentence(f"GPGGA,{clock},{place},1,{satellites:02d},{hdop:.2f},{alt:.1f},M,{_GEOID_M:.1f},M,,"),
            sentence(f"GPGSA,A,3,{used},{1.6 * hdop:.2f},{hdop:.2f},{1.25 * hdop:.2f}"),
            sentence(f"GPRMC,{clock},A,{place},{knots:.2f},{course:.2f},{moment:%d%m%y},,,A"),
            sentence(f"GPVTG,{course:.2f},T,,M,{knots:.2f},N,{3.6 * speed:.2f},K,A"),
        )
    )


def _no_fix(moment: datetime, *, known_time: bool) -> bytes:
    clock = f"{moment:%H%M%S}.{moment.microsecond // 10000:02d}" if known_time else ""
    date = f"{moment:%d%m%y}" if known_time else ""
    return b"".join(
        (
            sentence(f"GPGGA,{clock},,,,,0,00,99.99,,,,,,"),
            sentence("GPGSA,A,1,,,,,,,,,,,,,99.99,99.99,99.99"),
            sentence(f"GPRMC,{clock},V,,,,,,,{date},,,N"),
            sentence("GPVTG,,T,,M,,N,,K,N"),
        )
    )
