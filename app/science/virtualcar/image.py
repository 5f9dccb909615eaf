"""The logger's image, written byte for byte as Sebesta 2010, App. C.1.4–C.1.5 lays it down.

A packet is FF, a type, a length, the message and the sum modulo 256 of everything from the length byte to the last byte
of the message. The length counts the message and the check byte. This encoder knows nothing of the decoder.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from app.science.arrays import FloatArray, IntArray

_ERROR, _ACCELEROMETER, _GPS, _TICK, _PULSE, _SKEW = range(6)
_PREAMBLE = 0xFF

Bytes = NDArray[np.uint8]


@dataclass(frozen=True, slots=True)
class PacketBlock:
    """Packets of one length: when each is written (ms, shape (n,)) and their bytes (shape (n, length))."""

    written_ms: FloatArray
    data: Bytes


def frame(kind: int, written_ms: FloatArray | IntArray, messages: Bytes) -> PacketBlock:
    """Wrap messages of one length, shape (n, m), in packets of one type."""
    n, m = messages.shape
    data = np.empty((n, m + 4), dtype=np.uint8)
    data[:, 0] = _PREAMBLE
    data[:, 1] = kind
    data[:, 2] = m + 1
    data[:, 3:-1] = messages
    data[:, -1] = data[:, 2:-1].sum(axis=1, dtype=np.int64) % 256
    return PacketBlock(np.asarray(written_ms, dtype=np.float64), data)


class Encoder:
    """Build packets with one byte order and one clock offset.

    Parameters
    ----------
    big_endian : bool
    clock_start_ms : int
        Shown by the 32-bit clock at trip time zero.
    """

    def __init__(self, *, big_endian: bool, clock_start_ms: int) -> None:
        self._order: Literal[">", "<"] = ">" if big_endian else "<"
        self._clock_start_ms = clock_start_ms

    def _integers(self, values: IntArray, kind: str) -> Bytes:
        array = np.asarray(values).astype(np.dtype(kind).newbyteorder(self._order))
        return array.view(np.uint8).reshape(len(array), array.itemsize)

    def _stamp(self, ms: IntArray) -> Bytes:
        return self._integers((ms + self._clock_start_ms) % 2**32, "u4")

    def accelerometer(self, ms: IntArray, counts: IntArray) -> PacketBlock:
        """Samples: stamp and three signed 16-bit counts."""
        axes = [self._integers(counts[:, axis], "i2") for axis in range(3)]
        return frame(_ACCELEROMETER, ms, np.hstack([self._stamp(ms), *axes]))

    def ticks(self, eighths_ms: IntArray) -> PacketBlock:
        """Wheel ticks: stamp and 0–7 units of 125 µs."""
        ms, rest = np.divmod(eighths_ms, 8)
        return frame(_TICK, eighths_ms / 8.0, np.hstack([self._stamp(ms), self._integers(rest, "u1")]))

    def pulses(self, ms: IntArray, counts: IntArray) -> PacketBlock:
        """Injector pulses: stamp and length in 250 ns; written when the injector has closed."""
        written = ms + counts * 250e-6
        return frame(_PULSE, written, np.hstack([self._stamp(ms), self._integers(counts, "u2")]))

    def skews(self, ms: IntArray, skew_ms: IntArray) -> PacketBlock:
        """Time skew: stamp and one byte of milliseconds."""
        return frame(_SKEW, ms, np.hstack([self._stamp(ms), self._integers(skew_ms, "u1")]))


def text_packets(kind: int, written_ms: list[float], texts: list[bytes]) -> list[PacketBlock]:
    """Packets of raw text, one block per length of text."""
    blocks = []
    lengths = np.array([len(text) for text in texts])
    for length in np.unique(lengths):
        chosen = np.flatnonzero(lengths == length)
        joined = np.frombuffer(b"".join(texts[i] for i in chosen), dtype=np.uint8).reshape(len(chosen), -1)
        blocks.append(frame(kind, np.array(written_ms)[chosen], joined))
    return blocks


def gps_packets(written_ms: list[float], texts: list[bytes]) -> list[PacketBlock]:
    """NMEA text as it came."""
    return text_packets(_GPS, written_ms, texts)


def error_packets(written_ms: list[float], messages: list[str]) -> list[PacketBlock]:
    """Human-readable messages, each ended by a newline."""
    return text_packets(_ERROR, written_ms, [f"{message}\n".encode("ascii") for message in messages])


def interleave(blocks: list[PacketBlock]) -> bytes:
    """Write all packets in the order of their times; of those at one time, in the order of the blocks."""
    lengths = np.concatenate([np.full(len(b.data), b.data.shape[1]) for b in blocks])
    order = np.argsort(np.concatenate([b.written_ms for b in blocks]), kind="stable")
    offsets = np.empty(len(order), dtype=np.int64)
    ends = np.cumsum(lengths[order])
    offsets[order] = ends - lengths[order]
    out = np.empty(int(ends[-1]), dtype=np.uint8)
    at = 0
    for block in blocks:
        n, length = block.data.shape
        out[offsets[at : at + n, None] + np.arange(length)] = block.data
        at += n
    return out.tobytes()
