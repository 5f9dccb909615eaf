"""A card's whole file: two gigabytes, nearly all of it never written."""

from __future__ import annotations

import resource
import tracemalloc
from collections.abc import Iterator
from pathlib import Path

import pytest

from app.science.logger.decode import ImageDecoder, decode_image
from tests.science.logger import packet_writer as write

GIGABYTE = 1 << 30
MEGABYTE = 1 << 20


def read(path: Path) -> Iterator[bytes]:
    with path.open("rb") as file:
        while chunk := file.read(MEGABYTE):
            yield chunk


@pytest.mark.slow
def test_two_gigabytes_that_end_in_zeros(tmp_path: Path) -> None:
    drives = b"".join([*write.drive(0, 120_000), *write.drive(20, 60_000)])
    path = tmp_path / "trip.dat"
    with path.open("wb") as file:
        file.write(drives)
        file.truncate(2 * GIGABYTE)
    decode_image(drives)  # the compiler's memory is not the decoder's
    before = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
    decoder = ImageDecoder()
    recordings = list(decoder.trips(read(path)))
    grown_mb = (resource.getrusage(resource.RUSAGE_SELF).ru_maxrss - before) / 1024
    assert len(recordings) == 2
    assert decoder.report.bytes == 2 * GIGABYTE
    assert decoder.report.zero_tail_bytes == 2 * GIGABYTE - len(drives)
    assert decoder.report.packet_bytes == len(drives)
    assert decoder.report.warnings == ()
    assert grown_mb < 100


@pytest.mark.slow
def test_months_of_trips_need_the_memory_of_one() -> None:
    hour = b"".join(write.drive(0, 3_600_000))
    decode_image(hour[:100_000])
    tracemalloc.start()
    try:
        decoder = ImageDecoder()
        count = sum(1 for _ in decoder.trips(hour for _ in range(20)))
        _, peak = tracemalloc.get_traced_memory()
    finally:
        tracemalloc.stop()
    assert count == 20
    assert peak < 160 * MEGABYTE
