"""Decoding of logger images, against a parser in plain Python."""

from __future__ import annotations

import struct
from collections import deque
from collections.abc import Iterator

from app.cli.bench.figure import Figure, best_seconds, timed
from app.cli.bench.virtual_hour import virtual_hour
from app.cli.inputs import CHUNK_BYTES
from app.science.logger.decode import ImageDecoder

COPIES = 12
LAYOUTS = {1: "<Ihhh", 3: "<IB", 4: "<IH", 5: "<IB"}
"""Message of each packet type that has fields (Sebesta 2010, App. C.1.5)."""


def measure() -> list[Figure]:
    """Return the decoder's and the plain parser's speed on the same image."""
    image = virtual_hour().image
    long_image = image * COPIES
    ours = best_seconds(lambda: deque(ImageDecoder().trips(pieces(long_image)), maxlen=0))
    plain = timed(lambda: parse(image))
    return [
        Figure(
            name="decoding a logger image",
            value=len(long_image) / ours / 1e6,
            reference=len(image) / plain / 1e6,
            unit="MB/s",
            reference_name="plain Python",
            better="higher",
            goal="at least 100 MB/s",
        )
    ]


def pieces(image: bytes) -> Iterator[bytes]:
    """Give an image as a file would be read."""
    for begin in range(0, len(image), CHUNK_BYTES):
        yield image[begin : begin + CHUNK_BYTES]


def parse(image: bytes) -> dict[int, list[tuple[int, ...] | bytes]]:
    """Parse an image packet by packet, the way one would write it down first."""
    packets: dict[int, list[tuple[int, ...] | bytes]] = {kind: [] for kind in range(6)}
    at = 0
    while at + 4 <= len(image):
        kind, length = image[at + 1], image[at + 2]
        end = at + 3 + length
        if image[at] != 0xFF or kind not in packets or length < 1 or end > len(image):
            at += 1
            continue
        if sum(image[at + 2 : end - 1]) % 256 != image[end - 1]:
            at += 1
            continue
        message = image[at + 3 : end - 1]
        layout = LAYOUTS.get(kind)
        packets[kind].append(struct.unpack(layout, message) if layout else message)
        at = end
    return packets
