"""A tiny writer of logger packets for tests: plain struct, one function per packet type."""

from __future__ import annotations

import struct
from functools import reduce


def packet(kind: int, message: bytes) -> bytes:
    """FF, type, length (message and checksum), message, sum modulo 256 from the length on."""
    summed = bytes([len(message) + 1]) + message
    return b"\xff" + bytes([kind]) + summed + bytes([sum(summed) % 256])


def error(text: str) -> bytes:
    return packet(0, text.encode("ascii"))


def acc(ms: int, x: int = 0, y: int = 0, z: int = -1000, order: str = "<") -> bytes:
    return packet(1, struct.pack(order + "Ihhh", ms % 2**32, x, y, z))


def gps(text: bytes) -> bytes:
    return packet(2, text)


def vss(ms: int, eighths: int = 0, order: str = "<") -> bytes:
    return packet(3, struct.pack(order + "IB", ms % 2**32, eighths))


def injector(ms: int, counts: int = 12_000, order: str = "<") -> bytes:
    return packet(4, struct.pack(order + "IH", ms % 2**32, counts))


def skew(ms: int, late_ms: int, order: str = "<") -> bytes:
    return packet(5, struct.pack(order + "IB", ms % 2**32, late_ms))


def sentence(body: str) -> bytes:
    """A receiver's sentence with its checksum and line end."""
    checksum = reduce(lambda a, b: a ^ b, body.encode("ascii"), 0)
    return f"${body}*{checksum:02X}\r\n".encode("ascii")


def clock_text(utc_s: float) -> str:
    return f"{int(utc_s // 3600) % 24:02d}{int(utc_s // 60) % 60:02d}{utc_s % 60:05.2f}"


def gga(utc_s: float, lat_min: float, lon_min: float, quality: int = 1, alt_m: float = 545.4) -> bytes:
    """48 degrees north and 11 degrees east, and so many minutes."""
    place = f"48{lat_min:08.5f},N,011{lon_min:08.5f},E"
    return sentence(f"GPGGA,{clock_text(utc_s)},{place},{quality},08,0.9,{alt_m:.1f},M,46.9,M,,")


def rmc(
    utc_s: float, lat_min: float, lon_min: float, knots: float = 30.0, date: str = "150610", ok: str = "A"
) -> bytes:
    place = f"48{lat_min:08.5f},N,011{lon_min:08.5f},E"
    return sentence(f"GPRMC,{clock_text(utc_s)},{ok},{place},{knots:.2f},84.40,{date},,,A")


def drive(begin_ms: int, end_ms: int, order: str = "<", utc_from_ms: int = 0) -> list[bytes]:
    """Packets of an even drive: 40 Hz accelerometer, a tick each 15 ms, a pulse each 40 ms, five fixes a second.

    UTC is noon plus the logger's milliseconds less ``utc_from_ms``; each fix arrives 60 ms after its moment, cut into
    pieces of 48 bytes.
    """
    packets: list[tuple[int, bytes]] = []
    packets += [(ms, acc(ms, ms % 50, -3, -1000 + ms % 7, order)) for ms in range(begin_ms, end_ms, 25)]
    packets += [(ms, vss(ms, ms % 8, order)) for ms in range(begin_ms + 3, end_ms, 15)]
    packets += [(ms, injector(ms, 10_000 + ms % 1000, order)) for ms in range(begin_ms + 9, end_ms, 40)]
    for ms in range(begin_ms - begin_ms % 200 + 200, end_ms - 100, 200):
        utc_s = 43_200 + (ms - utc_from_ms) / 1e3
        minutes = 7.0 + (ms - begin_ms) / 1e6
        text = gga(utc_s, minutes, 31.0) + rmc(utc_s, minutes, 31.0)
        packets += [(ms + 60, gps(text[i : i + 48])) for i in range(0, len(text), 48)]
    return [data for _, data in sorted(packets, key=lambda timed: timed[0])]
