"""Images hurt at random: no exception but `DecodeError`, little lost, time never backwards."""

from __future__ import annotations

import contextlib
import json

import numpy as np
import pytest

from app.science.errors import DecodeError
from app.science.logger.decode import ImageDecoder, decode_image
from app.science.logger.recording import Recording
from tests.science.logger import packet_writer as write

MINUTE = 60_000


def hurt(image: bytes, rng: np.random.Generator, places: int) -> bytes:
    """Flip bits, overwrite, cut out, insert, repeat and truncate."""
    data = bytearray(image)
    for _ in range(places):
        at, size = int(rng.integers(len(data))), int(rng.integers(1, 60))
        match int(rng.integers(6)):
            case 0:
                data[at] ^= 1 << int(rng.integers(8))
            case 1:
                data[at : at + size] = rng.integers(0, 256, size, dtype=np.uint8).tobytes()
            case 2:
                del data[at : at + size]
            case 3:
                data[at:at] = rng.integers(0, 256, size, dtype=np.uint8).tobytes()
            case 4:
                data[at:at] = data[max(at - size, 0) : at]
            case _:
                data[at : at + 512] = bytes(512)
    return bytes(data[: int(rng.integers(len(data) // 2, len(data)))] if rng.random() < 0.3 else data)


def check(recording: Recording) -> None:
    for name in recording:
        series = recording[name]
        assert np.isfinite(series.value).all()
        assert np.all(np.diff(series.t_s) > 0), name


@pytest.fixture(scope="module")
def image() -> bytes:
    drives = [*write.drive(0, 2 * MINUTE), *write.drive(33, MINUTE), *write.drive(2**32 - MINUTE, 2**32 + MINUTE)]
    return b"".join(drives) + bytes(5000)


@pytest.mark.parametrize("seed", range(40))
def test_hurt_images_never_break_the_decoder(image: bytes, seed: int) -> None:
    rng = np.random.default_rng(seed)
    places = int(rng.integers(1, 200))
    damaged = hurt(image, rng, places)
    decoded = decode_image(damaged)
    json.dumps(decoded.report.to_dict())
    for recording in decoded.recordings:
        check(recording)
    kept = sum(decoded.report.packets.values())
    whole = sum(decode_image(image[: len(damaged)]).report.packets.values())
    assert kept >= whole - 50 * places  # a block of zeros, the worst of the six, covers fewer than 50 packets
    assert len(decoded.recordings) <= 3 + places


@pytest.mark.parametrize("seed", range(40))
def test_noise_never_breaks_the_decoder(seed: int) -> None:
    """Bytes that look like headers more often than chance would have it."""
    rng = np.random.default_rng(seed)
    size = int(rng.integers(1, 20_000))
    data = rng.choice(np.array([0xFF, 0, 1, 2, 3, 4, 5, 6, 7, 11, 0x24, 0x2A], np.uint8), size)
    data[rng.random(size) < 0.1] = rng.integers(0, 256)
    decoder = ImageDecoder()
    with contextlib.suppress(DecodeError):
        for recording in decoder.trips([data.tobytes()]):
            check(recording)
    report = decoder.report
    assert report.bytes == size
    assert report.packet_bytes + report.skipped_bytes + report.zero_tail_bytes <= size


@pytest.mark.parametrize("seed", range(20))
def test_corrupt_time_stamps_never_turn_time_back(seed: int) -> None:
    """Sums are right, but the logger's clock goes mad now and then."""
    rng = np.random.default_rng(seed)
    packets = []
    for ms in range(0, 3 * MINUTE, 20):
        mad = rng.random() < 0.05
        stamp = int(rng.integers(0, 2**32)) if mad else ms + int(rng.integers(-30, 30)) % 2**32
        packets.append(write.vss(max(stamp, 0)) if ms % 40 else write.injector(max(stamp, 0)))
    decoded = decode_image(b"".join(packets))
    for recording in decoded.recordings:
        check(recording)
    (trip,) = decoded.report.trips
    assert trip.end_s < 181.0
    total = sum(trip.samples.values())
    assert total + decoded.report.clock.jumps_rejected >= 0.98 * len(packets)
    assert decoded.report.clock.jumps_rejected < 0.12 * len(packets)
