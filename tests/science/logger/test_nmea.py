"""Receiver text: real receivers' logs against a regular expression, and sentences against plain float arithmetic."""

from __future__ import annotations

import itertools
import math
from collections import Counter
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from app.science.logger import nmea_kernels as k
from app.science.logger.nmea import NmeaReader, Sentences, parse_nmea
from tests.science.logger import packet_writer as write
from tests.science.logger import references

LOGS = (
    "haicom-305N.log",
    "meinberg-gps164.log",
    "nmea-rtk.log",
    "quectel-l76k-nmea.log",
    "rx210.log",
    "sirf2.log",
    "skytraq-dgps.log",
    "telit-he910.log",
    "ublox-8.log",
    "ublox-neo-m9n-nmea.log",
    "ublox-zed-f9p-nmea.log",
    "ublox-zed-f9r.log",
)
KINDS = {"GGA": k.GGA, "RMC": k.RMC, "GSA": k.GSA, "VTG": k.VTG}


def without_comments(log: bytes) -> bytes:
    """Drop the lines with which the collection describes each log."""
    return b"\n".join(line for line in log.split(b"\n") if not line.startswith(b"#"))


def name_of(address: str) -> str:
    if address[0] == "P":
        return address[:4] if address[1:4].isalpha() and len(address) >= 4 else "other"
    return address[2:] if len(address) == 5 and address[2:].isalpha() else "other"


def expected_row(kind: str, f: list[str]) -> dict[int, float]:
    """What a sentence says, column by column, from its fields (the address is field 0)."""

    def value(index: int) -> float:
        return float(f[index]) if len(f) > index and f[index] else math.nan

    def place(index: int) -> dict[int, float]:
        if not f[index]:
            return {}
        return {
            k.LAT: references.degrees(f[index], f[index + 1], 2),
            k.LON: references.degrees(f[index + 2], f[index + 3], 3),
        }

    if kind == "GSA":
        return {k.HDOP: value(16)}
    if kind == "VTG":
        return {k.COURSE: value(1), k.SPEED: value(5) * 1852 / 3600}
    time = {k.TIME_OF_DAY: references.seconds_of_day(f[1])} if f[1] else {}
    if kind == "GGA":
        return time | place(2) | {k.QUALITY: value(6), k.SATELLITES: value(7), k.HDOP: value(8), k.ALT: value(9)}
    day = {k.DAY: float(references.days_since_1970(f[9]))} if f[9] else {}
    ok = f[2] == "A" and not (len(f) > 12 and f[12] == "N")
    return time | place(3) | day | {k.QUALITY: float(ok), k.SPEED: value(7) * 1852 / 3600, k.COURSE: value(8)}


@pytest.mark.parametrize("log", LOGS)
def test_real_receivers(log: str, shared_data: Callable[[str], Path]) -> None:
    text = without_comments((shared_data("gpsd-receiver-logs") / log).read_bytes())
    parsed = parse_nmea(text)
    found = references.sentences(text)
    assert parsed.counts.sentences == dict(Counter(name_of(address) for address, _ in found))
    used = [
        (address[2:], fields)
        for address, fields in found
        if address[0] != "P" and address[2:] in KINDS and not (address[2:] == "VTG" and fields[9:10] == ["N"])
    ]
    assert parsed.sentences.kind.tolist() == [KINDS[kind] for kind, _ in used]
    for row, (kind, fields) in zip(parsed.sentences.values, used, strict=True):
        expected = np.full(k.VALUES, np.nan)
        for column, value in expected_row(kind, fields).items():
            expected[column] = value
        np.testing.assert_allclose(row, expected, rtol=1e-12, atol=0)


def test_the_logs_hold_what_their_makers_say(shared_data: Callable[[str], Path]) -> None:
    """Counts taken by hand from the files: loss of fix, a log of RMC only, binary with NMEA in between, binary only."""
    folder = shared_data("gpsd-receiver-logs")
    parsed = {log: parse_nmea(without_comments((folder / log).read_bytes())).counts for log in LOGS}
    assert parsed["haicom-305N.log"].sentences == {"GGA": 73, "GSA": 26, "GSV": 79, "RMC": 74, "VTG": 73}
    assert parsed["meinberg-gps164.log"].sentences == {"RMC": 90}
    assert parsed["ublox-8.log"].sentences["GGA"] == 72
    assert parsed["sirf2.log"].sentences == {}
    assert parsed["rx210.log"].no_fix > 0
    assert parsed["ublox-neo-m9n-nmea.log"].no_fix == 0


@given(
    st.floats(0, 89.99999), st.floats(0, 179.99999), st.sampled_from("NS"), st.sampled_from("EW"), st.floats(0, 86399.9)
)
def test_positions_and_times_are_read_exactly(lat: float, lon: float, ns: str, ew: str, time_s: float) -> None:
    lat_text = f"{int(lat):02d}{(lat % 1) * 59.99:08.5f}"
    lon_text = f"{int(lon):03d}{(lon % 1) * 59.99:08.5f}"
    clock = f"{int(time_s // 3600):02d}{int(time_s // 60) % 60:02d}{min(time_s % 60, 59.99):05.2f}"
    text = write.sentence(f"GNGGA,{clock},{lat_text},{ns},{lon_text},{ew},1,11,0.72,-12.3,M,46.9,M,,")
    (row,) = parse_nmea(text).sentences.values
    assert row[k.LAT] == references.degrees(lat_text, ns, 2)
    assert row[k.LON] == references.degrees(lon_text, ew, 3)
    assert row[k.TIME_OF_DAY] == references.seconds_of_day(clock)
    assert (row[k.SATELLITES], row[k.HDOP], row[k.ALT]) == (11, 0.72, -12.3)


@given(st.integers(1, 31), st.integers(1, 12), st.integers(0, 99))
def test_dates_follow_the_calendar(day: int, month: int, year: int) -> None:
    date = f"{min(day, 28):02d}{month:02d}{year:02d}"
    (row,) = parse_nmea(write.rmc(0.0, 1.0, 1.0, date=date)).sentences.values
    assert row[k.DAY] == references.days_since_1970(date)


@given(st.lists(st.integers(0, 1500), max_size=8))
def test_text_may_be_cut_anywhere(cuts: list[int]) -> None:
    text = b"".join(write.gga(t, 1.0 + t, 2.0) + write.rmc(t, 1.0 + t, 2.0) for t in range(8))
    whole = parse_nmea(text)
    reader, rows = NmeaReader(), list[Sentences]()
    edges = [0, *sorted(min(cut, len(text)) for cut in cuts), len(text)]
    starts = []
    for begin, end in itertools.pairwise(edges):
        rows.append(reader.read(np.frombuffer(text[begin:end], np.uint8)))
        starts += [int(start) + begin for start in rows[-1].start]
    assert starts == whole.sentences.start.tolist()
    np.testing.assert_array_equal(np.concatenate([r.values for r in rows]), whole.sentences.values)
    assert reader.counts == whole.counts


@given(st.binary(max_size=400))
def test_any_bytes_are_survived(text: bytes) -> None:
    parsed = parse_nmea(text)
    assert sum(parsed.counts.sentences.values()) == len(references.sentences(text))


@given(st.integers(0, 10_000), st.binary(min_size=1, max_size=6))
def test_damage_costs_only_the_sentences_it_touches(at: int, junk: bytes) -> None:
    sentences = [write.gga(t, 1.0, 2.0) for t in range(20)]
    text = b"".join(sentences)
    at %= len(text)
    damaged = text[:at] + junk + text[at + len(junk) :]
    counts = parse_nmea(damaged).counts
    touched = {position // len(sentences[0]) for position in range(at, at + len(junk))}
    assert counts.sentences.get("GGA", 0) >= 20 - len(touched)
    assert counts.bad_checksum + counts.malformed <= 2 * len(touched)


@pytest.mark.parametrize(
    ("text", "bad_checksum", "malformed"),
    [
        (b"$GPGGA,1*00\r\n", 1, 0),
        (b"$GPGGA,123519,4807.038,N\r\n", 0, 1),  # no checksum
        (b"$GPGGA,123519,48\xff07.038,N*47\r\n", 0, 1),
        (b"$GPGGA,123519,4807$GPGGA,1*00", 1, 1),
        (b"$GPGGA,123519*zz\r\n", 0, 1),
        (b"$" + b"G" * 40 + b"*00", 0, 0),  # no address
        (b"$GPGGA," + b"1" * 300, 0, 1),
        (write.sentence("GPGGA,120000.00,9107.03,N,01131.0,E,1,08,0.9,5.4,M,46.9,M,,"), 0, 1),
        (write.sentence("GPGGA,120000.00,4867.03,N,01131.0,E,1,08,0.9,5.4,M,46.9,M,,"), 0, 1),
        (write.sentence("GPGGA,120000.00,4807.03,X,01131.0,E,1,08,0.9,5.4,M,46.9,M,,"), 0, 1),
        (write.sentence("GPRMC,120000.00,A"), 0, 1),
        (b"a $ b $1,2 $$ ", 0, 0),
    ],
)
def test_what_is_wrong_is_counted(text: bytes, bad_checksum: int, malformed: int) -> None:
    parsed = parse_nmea(text)
    assert (parsed.counts.bad_checksum, parsed.counts.malformed) == (bad_checksum, malformed)
    assert len(parsed.sentences) == 0


def test_proprietary_and_odd_sentences_are_counted_by_name() -> None:
    bodies = ["PMTK001,314,3", "PUBX,00,1", "GLGSV,1,1,00", "GQ", "P1234,5", "GPTXT,01"]
    counts = parse_nmea(b"".join(write.sentence(body) for body in bodies)).counts
    assert counts.sentences == {"GSV": 1, "TXT": 1, "PMTK": 1, "PUBX": 1, "other": 1}
