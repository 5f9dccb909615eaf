"""The virtual GPS receiver speaks NMEA 0183 and errs as stated."""

from __future__ import annotations

import re
from datetime import UTC, datetime
from itertools import pairwise

import numpy as np
import pytest

from app.science.virtualcar import receiver
from app.science.virtualcar.geography import Place
from app.science.virtualcar.receiver import Outage, TextChunk
from app.science.virtualcar.specification import SensorSettings

SENTENCE = re.compile(rb"\$([^*$]+)\*([0-9A-F]{2})\r\n")


def fixes(n: int, lat: float = 49.6, lon: float = 6.1, **options: object) -> list[TextChunk]:
    """``n`` fixes of a car that drives east at 20 m/s, with other circumstances where given."""
    flat = np.ones(n)
    defaults: dict[str, object] = {
        "started_at_utc_s": 1256629260.0,
        "outages": (),
        "settings": SensorSettings(),
        "rng": np.random.default_rng(1),
    }
    return receiver.sentences(
        np.arange(n) * 0.2,
        Place(lat * flat, lon * flat),
        300.0 * flat,
        20.0 * flat,
        np.pi / 2 * flat,
        **(defaults | options),
    )


def bodies(chunks: list[TextChunk], name: str) -> list[list[str]]:
    """Fields of all sentences of one name, each checked against its checksum."""
    text = b"".join(chunk.text for chunk in chunks)
    found = SENTENCE.findall(text)
    assert sum(len(body) + 6 for body, _ in found) == len(text)
    for body, check in found:
        value = 0
        for byte in body:
            value ^= byte
        assert int(check, 16) == value
    return [body.decode().split(",") for body, _ in found if body.startswith(name.encode())]


def degrees(value: str, letter: str) -> float:
    whole, minutes = divmod(float(value), 100.0)
    return (whole + minutes / 60.0) * (1 if letter in "NE" else -1)


def test_framing_of_a_known_sentence() -> None:
    body = "GPGGA,123519,4807.038,N,01131.000,E,1,08,0.9,545.4,M,46.9,M,,"
    assert receiver.sentence(body) == f"${body}*47\r\n".encode()


def test_four_sentences_per_fix() -> None:
    chunks = fixes(50)
    for name in ("GPGGA", "GPGSA", "GPRMC", "GPVTG"):
        assert len(bodies(chunks, name)) == 50
    assert max(len(line) for c in chunks for line in c.text.splitlines()) <= 80


def test_time_and_date_are_utc_and_pass_midnight() -> None:
    start = datetime(2009, 12, 31, 23, 59, 59, tzinfo=UTC).timestamp()
    rmc = bodies(fixes(11, started_at_utc_s=start), "GPRMC")
    assert (rmc[0][1], rmc[0][9]) == ("235959.00", "311209")
    assert (rmc[4][1], rmc[4][9]) == ("235959.80", "311209")
    assert (rmc[5][1], rmc[5][9]) == ("000000.00", "010110")


def test_southern_and_western_places() -> None:
    quiet = SensorSettings(gps_sd_m=(0.0, 0.0), gps_white_sd_m=(0.0, 0.0))
    gga = bodies(fixes(3, lat=-33.999999, lon=-0.5, settings=quiet), "GPGGA")
    assert degrees(gga[1][2], gga[1][3]) == pytest.approx(-33.999999, abs=1e-6)
    assert degrees(gga[1][4], gga[1][5]) == pytest.approx(-0.5, abs=1e-6)
    assert float(gga[1][9]) == pytest.approx(300.0)


def test_speed_and_course_agree_between_sentences() -> None:
    chunks = fixes(400)
    rmc, vtg = bodies(chunks, "GPRMC"), bodies(chunks, "GPVTG")
    knots = np.array([float(fields[7]) for fields in rmc])
    kmph = np.array([float(fields[7]) for fields in vtg])
    assert knots * 1852 / 3600 == pytest.approx(kmph / 3.6, abs=0.01)
    assert kmph.mean() / 3.6 == pytest.approx(20.0, abs=0.03)
    assert np.mean([float(fields[8]) for fields in rmc]) == pytest.approx(90.0, abs=0.1)


def test_position_wanders_as_stated() -> None:
    n = 400_000
    horizontal = receiver.wandering(n, 2.5, 120.0, np.random.default_rng(5))
    assert horizontal.std() == pytest.approx(2.5, rel=0.1)
    lag = round(120.0 / 0.2)
    correlation = np.mean(horizontal[lag:] * horizontal[:-lag]) / horizontal.var()
    assert correlation == pytest.approx(np.exp(-1), abs=0.1)
    start = [receiver.wandering(2, 5.0, 150.0, np.random.default_rng(seed))[0] for seed in range(400)]
    assert np.std(start) == pytest.approx(5.0, rel=0.1)


def test_fix_errors_are_metres() -> None:
    gga = bodies(fixes(5000), "GPGGA")
    north = np.array([(degrees(f[2], f[3]) - 49.6) * 111_230.0 for f in gga])
    assert 0.5 < north.std() < 6.0
    assert np.diff(north).std() == pytest.approx(0.3 * np.sqrt(2), rel=0.25)
    assert {f[6] for f in gga} == {"1"}
    assert all(4 <= int(f[7]) <= 12 and 0.5 < float(f[8]) < 4.0 for f in gga)


def test_outages_have_no_position() -> None:
    gga = bodies(fixes(100, outages=(Outage(4.0, 10.0),)), "GPGGA")
    lost = [i for i, fields in enumerate(gga) if fields[6] == "0"]
    assert lost == list(range(20, 50))
    assert all(gga[i][2] == "" and gga[i][1] != "" for i in lost)
    rmc = bodies(fixes(100, outages=(Outage(4.0, 10.0),)), "GPRMC")
    assert [fields[2] for fields in rmc[19:21]] == ["A", "V"]


def test_outages_are_in_order_and_the_tunnel_is_long() -> None:
    busy = SensorSettings(gps_outages_per_hour=60.0)
    for seed in range(20):
        outages = receiver.draw_outages(3600.0, busy, "tunnel", np.random.default_rng(seed))
        assert outages[0].begin_s == 0.0
        assert all(a.end_s < b.begin_s for a, b in pairwise(outages))
        assert max(o.end_s - o.begin_s for o in outages) >= 180.0
    plain = receiver.draw_outages(3600.0, SensorSettings(gps_outages_per_hour=0.0), "mixed", np.random.default_rng(0))
    assert plain == (Outage(0.0, 8.0),)


def test_chunks_cut_the_text_anywhere_and_lose_only_its_end() -> None:
    text = fixes(40)
    chunks = receiver.chunks_of(text, 64)
    assert {len(chunk.text) for chunk in chunks} == {64}
    whole = b"".join(chunk.text for chunk in text)
    joined = b"".join(chunk.text for chunk in chunks)
    assert whole.startswith(joined)
    assert len(whole) - len(joined) < 64
    times = [chunk.t_s for chunk in chunks]
    assert times == sorted(times)
    at = 0
    for chunk in chunks:
        at += 64
        fix = np.searchsorted(np.cumsum([len(c.text) for c in text]), at)
        assert 0.05 <= chunk.t_s - 0.2 * fix < 0.2
