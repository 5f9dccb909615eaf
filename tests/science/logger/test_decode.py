"""The whole decoder: what goes in as packets comes out as signals, however the image is cut or damaged."""

from __future__ import annotations

import itertools
import json
from collections.abc import Callable, Iterable
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from app.science.errors import DecodeError
from app.science.logger.decode import BLOCK_BYTES, DecodedImage, ImageDecoder, blocks, decode_image
from app.science.logger.nmea import parse_nmea
from app.science.logger.recording import SIGNAL_UNITS, Recording
from tests.science.logger import packet_writer as write

MINUTE = 60_000


def joined(packets: Iterable[bytes]) -> bytes:
    return b"".join(packets)


def decode_chunks(image: bytes, cuts: list[int]) -> DecodedImage:
    edges = [0, *sorted(min(cut, len(image)) for cut in cuts), len(image)]
    decoder = ImageDecoder()
    return DecodedImage(tuple(decoder.trips(image[a:b] for a, b in itertools.pairwise(edges))), decoder.report)


def assert_same(first: Recording, second: Recording) -> None:
    assert list(first) == list(second)
    for name in first:
        np.testing.assert_array_equal(first[name].t_s, second[name].t_s)
        np.testing.assert_array_equal(first[name].value, second[name].value)
    assert first.texts == second.texts
    assert first.warnings == second.warnings
    assert first.started_at_utc_s == second.started_at_utc_s


def assert_sound(recording: Recording) -> None:
    """What every recording promises."""
    for name in recording:
        series = recording[name]
        assert name in SIGNAL_UNITS
        assert len(series) > 0
        assert np.isfinite(series.t_s).all()
        assert np.isfinite(series.value).all()
        assert np.all(np.diff(series.t_s) > 0)


@pytest.mark.parametrize("order", ["<", ">"])
def test_signals_are_what_was_written(order: str) -> None:
    image = decode_image(joined(write.drive(0, 2 * MINUTE, order)))
    (recording,) = image.recordings
    assert image.report.byte_order == ("little" if order == "<" else "big")
    assert_sound(recording)
    ms = np.arange(0, 2 * MINUTE, 25)
    np.testing.assert_array_equal(recording["ax_mps2"].t_s, ms / 1e3)
    np.testing.assert_allclose(recording["ax_mps2"].value, (ms % 50) * 9.80665e-3)
    np.testing.assert_allclose(recording["az_mps2"].value, (-1000 + ms % 7) * 9.80665e-3)
    assert recording["ay_mps2"].t_s is recording["ax_mps2"].t_s
    ms = np.arange(3, 2 * MINUTE, 15)
    np.testing.assert_allclose(recording["vss_tick"].t_s, ms / 1e3 + (ms % 8) * 125e-6, rtol=0, atol=1e-12)
    ms = np.arange(9, 2 * MINUTE, 40)
    np.testing.assert_allclose(recording["injector_pulse_s"].value, (10_000 + ms % 1000) * 250e-9)


def test_fixes_are_put_on_the_loggers_clock() -> None:
    (recording,) = decode_image(joined(write.drive(0, 2 * MINUTE))).recordings
    fixed_ms = np.arange(200, 2 * MINUTE - 100, 200)
    assert len(recording["lat_deg"]) == len(fixed_ms)
    latency = recording["lat_deg"].t_s - fixed_ms / 1e3
    assert np.ptp(latency) < 0.002
    assert 0.060 <= latency.mean() < 0.075  # the constant part can't be told from the image
    np.testing.assert_allclose(recording["lat_deg"].value, 48 + (7 + fixed_ms / 1e6) / 60, atol=1e-7)
    assert recording["lon_deg"].t_s is recording["lat_deg"].t_s
    np.testing.assert_allclose(recording["gnss_speed_mps"].value, 30 * 1852 / 3600)
    noon = 1_276_603_200.0
    np.testing.assert_allclose(recording["utc_s"].value, noon + fixed_ms / 1e3, atol=1e-5)
    assert recording.started_at_utc_s == pytest.approx(noon - latency[0], abs=1e-3)
    assert recording.texts["nmea"].startswith("$GPGGA,120000.20,4807.00020,N")


@pytest.mark.parametrize("log", ["ublox-zed-f9r.log", "ublox-8.log", "telit-he910.log", "nmea-rtk.log"])
def test_real_receivers_text_comes_through_the_image_whole(log: str, shared_data: Callable[[str], Path]) -> None:
    """Binary messages between the sentences too: they hold start bytes, even whole false packets."""
    text = (shared_data("gpsd-receiver-logs") / log).read_bytes()
    pieces = [text[i : i + 100] for i in range(0, len(text), 100)]
    packets = [
        p for i, piece in enumerate(pieces) for p in (write.vss(20 * i), write.gps(piece), write.acc(20 * i + 10))
    ]
    image = decode_image(joined(packets))
    (recording,) = image.recordings
    assert recording.texts["nmea"] == text.decode("latin-1")
    assert image.report.packets["gps"] == len(pieces)
    assert image.report.nmea == parse_nmea(text).counts
    assert image.report.resyncs == ()


def test_a_drive_over_midnight_goes_on() -> None:
    noon_to_midnight_ms = 12 * 3_600_000
    packets = list(write.drive(0, 2 * MINUTE, utc_from_ms=MINUTE - noon_to_midnight_ms))
    (recording,) = decode_image(joined(packets)).recordings
    np.testing.assert_allclose(np.diff(recording["utc_s"].value), 0.2, atol=1e-5)
    np.testing.assert_allclose(np.diff(recording["lat_deg"].t_s), 0.2, atol=0.002)


def test_the_course_counts_only_while_moving() -> None:
    text = [write.gps(write.rmc(43_200 + i / 5, 7.0, 31.0, knots=0.5 if i < 50 else 20.0)) for i in range(100)]
    packets = [p for i, t in enumerate(text) for p in (write.vss(200 * i), write.vss(200 * i + 100), t)]
    (recording,) = decode_image(joined(packets)).recordings
    assert len(recording["gnss_speed_mps"]) == 100
    assert len(recording["heading_deg"]) == 50


def test_duplicates_at_one_time_are_dropped() -> None:
    packets = write.drive(0, MINUTE)
    once, twice = decode_image(joined(packets)), decode_image(joined(p for p in packets for _ in range(2) if p[1] != 2))
    assert len(once.recordings[0]["vss_tick"]) == len(twice.recordings[0]["vss_tick"])


@settings(max_examples=25)
@given(st.lists(st.integers(0, 90_000), max_size=8))
def test_chunks_make_no_difference(cuts: list[int]) -> None:
    image = joined([*write.drive(0, 20_000), *write.drive(40, 10_000)]) + bytes(3000)
    whole, cut = decode_image(image), decode_chunks(image, cuts)
    assert cut.report == whole.report
    assert len(cut.recordings) == len(whole.recordings) == 2
    for first, second in zip(whole.recordings, cut.recordings, strict=True):
        assert_same(first, second)


@given(st.lists(st.integers(0, 3 * BLOCK_BYTES), max_size=6))
def test_blocks_join_to_the_image(sizes: list[int]) -> None:
    chunks = [bytes([i + 1]) * size for i, size in enumerate(sizes)]
    cut = list(blocks(chunks))
    assert b"".join(cut) == b"".join(chunks)
    assert all(len(block) == BLOCK_BYTES for block in cut[:-1])


def test_image_larger_than_a_block_has_no_seams() -> None:
    image = decode_image(joined(write.drive(0, 40 * MINUTE)))
    assert image.report.bytes > 2 * BLOCK_BYTES
    (recording,) = image.recordings
    assert len(recording["ax_mps2"]) == 40 * 60 * 40
    assert image.report.nmea.sentences == {"GGA": 11_999, "RMC": 11_999}
    assert image.report.warnings == ()


def test_report_is_json() -> None:
    packets = [*write.drive(0, MINUTE), write.error("SD: retry\n"), write.skew(MINUTE + 10, 80)]
    image = decode_image(joined(packets) + b"\xff\x01\x0b garbage")
    plain = json.loads(json.dumps(image.report.to_dict()))
    assert plain["bytes"] == image.report.bytes
    assert plain["clock"] == {"restarts": 0, "wraps": 0, "jumps_rejected": 0, "backward_steps": 0}
    assert plain["skew"]["listed"] == [{"t_s": 60.01, "late_ms": 80}]
    assert plain["trips"][0]["samples"]["vss_tick"] == 4000
    assert plain["error_messages"] == ["SD: retry"]
    assert plain["resyncs"] == [{"offset": image.report.packet_bytes, "skipped_bytes": 11}]
    assert plain["warnings"] == [
        f"The image is damaged in 1 place, the first at byte {image.report.packet_bytes:,}: 11 bytes skipped, "
        "all packets around kept.",
        "The last packet is cut off after 11 bytes.",
        "The logger came late to its work by up to 80 ms, as it noted itself.",
        "The logger noted 1 error, the first one: 'SD: retry'.",
    ]


def test_an_image_that_breaks_off_is_said_with_the_drive_it_breaks() -> None:
    morning, evening = write.drive(0, MINUTE), write.drive(120, MINUTE)
    whole = joined([*morning, *evening])
    said = "The image breaks off within a packet: the end of this drive may be missing."
    assert all(said not in trip.warnings for trip in decode_image(whole + bytes(4000)).recordings)
    cut = decode_image(whole[:-3]).recordings
    assert [said in trip.warnings for trip in cut] == [False, True]


def test_damage_is_said_with_the_trip_it_lies_in() -> None:
    first, second = write.drive(0, MINUTE), write.drive(40, MINUTE)
    second.insert(1000, b"\x00\x01\x02 hole \xff\xff")
    whole, hurt = decode_image(joined(first)).recordings[0], decode_image(joined([*first, *second]))
    assert_same(hurt.recordings[0], whole)
    assert hurt.recordings[1].warnings[0].startswith("The image is damaged in 1 place of this trip, the first at byte ")


@pytest.mark.parametrize(
    ("data", "words"),
    [
        (b"", "empty"),
        (bytes(10_000_000), "All 10,000,000 bytes are zero"),
        (b"\xff\xd8\xff\xe0\x00\x10JFIF" + np.random.default_rng(3).bytes(200_000), "looks like a JPEG picture"),
        (b"PK\x03\x04" + np.random.default_rng(4).bytes(3000), "ZIP archive"),
        (b"t_s,signal,value\n0.0,speed_mps,3.0\n" * 50, "text beginning with 't_s,signal,value'"),
        (b"<?xml version='1.0'?><ponthy_config/>", "an XML text"),
        ("Straße\n".encode() * 300, "text beginning with 'Straße'"),
        (np.random.default_rng(5).bytes(50_000), "This is no logger image"),
        (write.gga(1.0, 7.0, 31.0), "receiver text"),
        (joined(write.gps(write.rmc(i, 7.0, 31.0)) for i in range(50)), "no drive in this image"),
        (joined(write.acc(ms) for ms in range(0, 5000, 25)), "no drive in this image: it holds packets (200 acc"),
        (write.vss(5), "no drive in this image"),
    ],
)
def test_nothing_usable_is_said_clearly(data: bytes, words: str) -> None:
    decoder = ImageDecoder()
    with pytest.raises(DecodeError) as caught:
        list(decoder.trips([data]))
    assert words in str(caught.value)
    assert decoder.report.bytes == len(data)
    assert 0 <= caught.value.offset <= len(data)
