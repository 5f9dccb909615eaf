"""The GPS receiver: NMEA sentences with a slowly wandering error, cold start and outages."""

from __future__ import annotations

from dataclasses import dataclass
from datetime import UTC, datetime, timedelta
from functools import reduce

import numpy as np
from scipy.signal import lfilter

from app.science.arrays import FloatArray
from app.science.virtualcar.geography import Place
from app.science.virtualcar.specification import RouteName, SensorSettings

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
class TextChunk:
    """Text and a moment in trip seconds: of a fix, when its first byte comes; of a packet, when its last one has."""

    t_s: float
    text: bytes


def draw_outages(
    duration_s: float, settings: SensorSettings, route: RouteName, rng: np.random.Generator
) -> tuple[Outage, ...]:
    """Cold start, short losses at random times, and the tunnel's three minutes in the middle; in order, disjoint."""
    begins = rng.uniform(
        60.0, max(duration_s - 60.0, 61.0), rng.poisson(settings.gps_outages_per_hour * duration_s / 3600)
    )
    raw = [Outage(0.0, settings.gps_cold_start_s)]
    raw += [Outage(float(b), float(b + rng.uniform(5.0, 40.0))) for b in begins]
    if route == "tunnel":
        middle = 0.5 * duration_s
        raw.append(Outage(max(middle - 90.0, 30.0), middle + 90.0))
    merged: list[Outage] = []
    for outage in sorted(raw, key=lambda o: o.begin_s):
        if merged and outage.begin_s <= merged[-1].end_s + 1.0:
            merged[-1] = Outage(merged[-1].begin_s, max(merged[-1].end_s, outage.end_s))
        else:
            merged.append(outage)
    return tuple(merged)


def wandering(n: int, sd: float, correlation_s: float, rng: np.random.Generator) -> FloatArray:
    """First-order Gauss–Markov sequence every `FIX_STEP_S`, stationary from the start, shape (n,)."""
    keep = np.exp(-FIX_STEP_S / correlation_s)
    white = rng.standard_normal(n)
    white[1:] *= np.sqrt(1.0 - keep**2)
    return sd * np.asarray(lfilter([1.0], [1.0, -keep], white))


def sentences(
    t_s: FloatArray,
    place: Place,
    alt_m: FloatArray,
    speed_mps: FloatArray,
    heading_rad: FloatArray,
    *,
    started_at_utc_s: float,
    outages: tuple[Outage, ...],
    settings: SensorSettings,
    rng: np.random.Generator,
) -> list[TextChunk]:
    """GGA, GSA, RMC and VTG of every fix.

    Parameters
    ----------
    t_s : array, shape (n,)
        Trip time of the fixes; their UTC is ``started_at_utc_s + t_s``.
    place : Place
    alt_m, speed_mps, heading_rad : array, shape (n,)
        Truth at these times.
    """
    n = len(t_s)
    horizontal, vertical = settings.gps_sd_m
    tau_h, tau_v = settings.gps_correlation_s
    white_h, white_v = settings.gps_white_sd_m
    north = wandering(n, horizontal, tau_h, rng) + white_h * rng.standard_normal(n)
    east = wandering(n, horizontal, tau_h, rng) + white_h * rng.standard_normal(n)
    up = wandering(n, vertical, tau_v, rng) + white_v * rng.standard_normal(n)
    lat = place.lat_deg + north / 111_200.0
    lon = place.lon_deg + east / (111_320.0 * np.cos(np.radians(place.lat_deg)))
    hdop = np.clip(1.1 + wandering(n, 0.25, 200.0, rng), 0.7, 3.0)
    satellites = np.clip(np.rint(8.5 - 3.0 * (hdop - 1.1)), 4, 12).astype(int)
    speed = np.abs(speed_mps + 0.08 * rng.standard_normal(n))
    course = np.degrees(heading_rad) + np.degrees(0.15 / np.maximum(speed_mps, 0.5)) * rng.standard_normal(n)
    blind = np.zeros(n, dtype=bool)
    for outage in outages:
        blind |= (t_s >= outage.begin_s) & (t_s < outage.end_s)
    epoch = datetime.fromtimestamp(started_at_utc_s, UTC)
    chunks = []
    for i in range(n):
        moment = epoch + timedelta(seconds=round(float(t_s[i]), 3))
        if blind[i]:
            text = _no_fix(moment, known_time=t_s[i] > 0.3 * settings.gps_cold_start_s)
        else:
            text = _fix(
                moment, lat[i], lon[i], alt_m[i] + up[i], hdop[i], int(satellites[i]), speed[i], course[i] % 360.0
            )
        chunks.append(TextChunk(float(t_s[i]) + settings.gps_latency_s, text))
    return chunks


def chunks_of(fixes: list[TextChunk], chunk_bytes: int) -> list[TextChunk]:
    """Cut the text into chunks of one size, each complete when its last byte has come; an unfilled rest is lost."""
    chunks: list[TextChunk] = []
    buffer = b""
    for fix in fixes:
        taken = 0
        while len(buffer) + len(fix.text) - taken >= chunk_bytes:
            missing = chunk_bytes - len(buffer)
            text = buffer + fix.text[taken : taken + missing]
            taken += missing
            chunks.append(TextChunk(fix.t_s + taken / _BYTES_PER_S, text))
            buffer = b""
        buffer += fix.text[taken:]
    return chunks


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
    used = ",".join(f"{1 + 7 * i % 31:02d}" if i < satellites else "" for i in range(12))
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
