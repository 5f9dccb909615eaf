"""The virtual logger's image, byte for byte."""

from __future__ import annotations

import struct
from collections.abc import Callable
from itertools import pairwise

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from app.science.virtualcar import image
from app.science.virtualcar.simulate import SimulatedTrip, join_images, simulate
from app.science.virtualcar.specification import ImageSettings, Simulation

Read = Callable[[bytes], list[tuple[int, bytes]]]


def test_an_accelerometer_packet_by_hand() -> None:
    encoder = image.Encoder(big_endian=False, clock_start_ms=0)
    packet = image.interleave([encoder.accelerometer(np.array([0x01020304]), np.array([[1000, -1, -32768]]))])
    message = bytes([4, 3, 2, 1, 0xE8, 0x03, 0xFF, 0xFF, 0x00, 0x80])
    assert packet == bytes([0xFF, 0x01, 11]) + message + bytes([(11 + sum(message)) % 256])


def test_the_other_packets_by_hand() -> None:
    encoder = image.Encoder(big_endian=True, clock_start_ms=0)
    assert image.interleave([encoder.ticks(np.array([8 * 5 + 3]))]) == bytes([0xFF, 3, 6, 0, 0, 0, 5, 3, 14])
    assert image.interleave([encoder.pulses(np.array([256]), np.array([513]))]) == bytes(
        [0xFF, 4, 7, 0, 0, 1, 0, 2, 1, 11]
    )
    assert image.interleave([encoder.skews(np.array([1]), np.array([2]))]) == bytes([0xFF, 5, 6, 0, 0, 0, 1, 2, 9])
    assert image.interleave(image.error_packets([0.0], ["no"])) == bytes([0xFF, 0, 4]) + b"no\n" + bytes(
        [(4 + sum(b"no\n")) % 256]
    )
    assert image.interleave(image.gps_packets([0.0], [b"$G"])) == bytes([0xFF, 2, 3, 0x24, 0x47, 0x6E])


@given(st.lists(st.tuples(st.integers(0, 50), st.binary(min_size=1, max_size=90)), min_size=1, max_size=40))
def test_any_texts_come_back_in_the_order_of_their_times(texts: list[tuple[int, bytes]]) -> None:
    blocks = image.gps_packets([float(t) for t, _ in texts], [text for _, text in texts])
    written = image.interleave(blocks)
    at, seen = 0, []
    while at < len(written):
        length = written[at + 2]
        seen.append(written[at + 3 : at + 2 + length])
        assert sum(written[at + 2 : at + 2 + length]) % 256 == written[at + 2 + length]
        at += 3 + length
    assert sorted(seen) == sorted(text for _, text in texts)
    times = {text: [t for t, other in texts if other == text] for text in seen}
    assert all(min(times[a]) <= max(times[b]) for a, b in pairwise(seen))


@pytest.fixture(scope="module")
def short() -> SimulatedTrip:
    settings = ImageSettings(zero_padding_bytes=1000, skew_every_s=10.0, error_every_s=30.0)
    return simulate(Simulation(duration_s=180.0, seed=3, image=settings))


def test_a_trip_reads_back(short: SimulatedTrip, read_packets: Read) -> None:
    packets = read_packets(short.image)
    assert len(short.image) == short.packet_bytes + 1000
    by_type = {kind: [message for k, message in packets if k == kind] for kind in range(6)}
    assert {kind: len(m[0]) for kind, m in by_type.items() if kind in (1, 3, 4, 5)} == {1: 10, 3: 5, 4: 6, 5: 5}
    assert len(by_type[1]) == 180 * 40 + 1
    assert all(m.endswith(b"\n") and m.isascii() for m in by_type[0])
    assert len(by_type[0]) > 0
    assert len(by_type[5]) > 5
    text = b"".join(by_type[2])
    assert text.startswith(b"$GPGGA,")
    assert 898 <= text.count(b"$GPRMC") <= 900
    assert all(m[4] < 8 for m in by_type[3])
    assert packets[0][0] == 1
    assert struct.unpack("<I", packets[0][1][:4]) == (0,)


def test_sources_are_interleaved_in_time(short: SimulatedTrip, read_packets: Read) -> None:
    latest = 0
    for kind, message in read_packets(short.image):
        if kind in (1, 3, 4, 5):
            (ms,) = struct.unpack_from("<I", message)
            assert ms >= latest - 17
            latest = max(latest, ms)


def test_big_endian_differs_only_in_its_numbers(short: SimulatedTrip, read_packets: Read) -> None:
    settings = ImageSettings(big_endian=True, skew_every_s=10.0, error_every_s=30.0)
    other = simulate(Simulation(duration_s=180.0, seed=3, image=settings))
    forms = {1: "I3h", 3: "IB", 4: "IH", 5: "IB"}
    for (kind, little), (same, big) in zip(read_packets(short.image), read_packets(other.image), strict=True):
        assert kind == same
        if kind in forms:
            assert struct.unpack("<" + forms[kind], little) == struct.unpack(">" + forms[kind], big)
        else:
            assert little == big


def test_clock_wraps_at_32_bits(read_packets: Read) -> None:
    start = 2**32 - 90_000
    trip = simulate(Simulation(duration_s=180.0, seed=3, image=ImageSettings(clock_start_ms=start)))
    stamps = [struct.unpack_from("<I", m)[0] for kind, m in read_packets(trip.image) if kind == 1]
    assert stamps[0] == start
    assert stamps[-1] == 90_000
    assert trip.truth["t_s"][0] == 0.0


def test_several_trips_on_one_card(read_packets: Read) -> None:
    first = simulate(Simulation(duration_s=90.0, seed=3))
    second = simulate(Simulation(duration_s=90.0, seed=4, vehicle=first.vehicle, started_at_utc_s=1256640000.0))
    card = join_images([first, second], zero_padding_bytes=512)
    stamps = [struct.unpack_from("<I", m)[0] for kind, m in read_packets(card) if kind == 1]
    assert np.flatnonzero(np.diff(stamps) < 0).tolist() == [90 * 40]
    assert card.endswith(bytes(512))
