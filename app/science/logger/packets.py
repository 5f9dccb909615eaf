"""Packets of a logger image: where they are and what they hold, whatever lies between them."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from app.science.arrays import AnyArray, IntArray
from app.science.logger import kernels as k

TYPE_NAMES = ("error", "accelerometer", "gps", "vss", "injector", "skew")
"""Names of the packet types, by their number in the image (Sebesta 2010, App. C.1.4)."""

SHORTEST_STAMPED = 9
SHORTEST_PACKET = 5


@dataclass(frozen=True, slots=True)
class Packets:
    """Packets that hold measurements, in the order of the image.

    Attributes
    ----------
    kind, raw_ms, words, offset : arrays, shapes (n,), (n,), (n, 3), (n,)
        Packets with a time stamp: type, 32-bit time stamp, up to three 16-bit values, offset in the image. Numbers are
        read as little-endian; `in_byte_order` gives them the other order.
    text, text_end, text_row : arrays, shapes (b,), (g,), (g,)
        GPS packets: their messages one after the other, where each ends, how many stamped packets stand before it.
    """

    kind: AnyArray
    raw_ms: AnyArray
    words: AnyArray
    offset: IntArray
    text: AnyArray
    text_end: IntArray
    text_row: IntArray

    def __len__(self) -> int:
        return len(self.kind)

    def behind(self, rows: int, texts: int) -> Packets:
        """Return copies of all but the first so many stamped and GPS packets."""
        cut = int(self.text_end[texts - 1]) if texts else 0
        return Packets(
            self.kind[rows:].copy(), self.raw_ms[rows:].copy(), self.words[rows:].copy(), self.offset[rows:].copy(),
            self.text[cut:].copy(), self.text_end[texts:] - cut, self.text_row[texts:] - rows,
        )  # fmt: skip


def join(first: Packets, second: Packets) -> Packets:
    """Return the packets of both, one after the other."""
    return Packets(
        np.concatenate((first.kind, second.kind)),
        np.concatenate((first.raw_ms, second.raw_ms)),
        np.concatenate((first.words, second.words)),
        np.concatenate((first.offset, second.offset)),
        np.concatenate((first.text, second.text)),
        np.concatenate((first.text_end, second.text_end + len(first.text))),
        np.concatenate((first.text_row, second.text_row + len(first))),
    )


def no_packets() -> Packets:
    """Return the beginning of every join."""
    none = np.empty(0, np.int64)
    return Packets(
        np.empty(0, np.uint8),
        np.empty(0, np.uint32),
        np.empty((0, 3), np.uint16),
        none,
        np.empty(0, np.uint8),
        none,
        none,
    )


def in_byte_order(packets: Packets, *, big_endian: bool) -> Packets:
    """Return the packets with their numbers read in the given byte order; single bytes have none."""
    if not big_endian:
        return packets
    wide = (packets.kind == k.ACCELEROMETER) | (packets.kind == k.INJECTOR)
    words = np.where(wide[:, None], packets.words.byteswap(), packets.words)
    return replace(packets, raw_ms=packets.raw_ms.byteswap(), words=words)


@dataclass(frozen=True, slots=True)
class Scan:
    """What one block of the image held.

    Attributes
    ----------
    packets : Packets
    errors : tuple of str
        Messages of the error packets.
    resyncs : array, shape (r, 2)
        Places where packets stopped: offset in the image and bytes skipped until they went on.
    counts : array
        Packets by type and the other counts of `app.science.logger.kernels`.
    """

    packets: Packets
    errors: tuple[str, ...]
    resyncs: IntArray
    counts: IntArray


class PacketScanner:
    """Finds the packets of an image that comes in blocks.

    A packet is ``FF``, type, length, message, checksum; the checksum is the sum modulo 256 from the length to the last
    message byte (Sebesta 2010, App. C.1.4). After anything else the scanner goes on one byte behind the false start, so
    that damage never costs a packet it didn't touch.
    """

    def __init__(self) -> None:
        self._rest = b""
        self._state = np.array([-1, 0], np.int64)
        self._base = 0

    def scan(self, block: bytes | memoryview, *, final: bool = False) -> Scan:
        """Return the packets that are complete with this block.

        Parameters
        ----------
        block : bytes
            The next bytes of the image.
        final : bool
            The image ends here.

        Returns
        -------
        Scan
        """
        buffer = np.frombuffer(b"".join((self._rest, block)), np.uint8)
        size = len(buffer)
        stamped, most = size // SHORTEST_STAMPED + 1, size // SHORTEST_PACKET + 1
        counts = np.zeros(k.COUNTS, np.int64)
        kind, raw_ms = np.empty(stamped, np.uint8), np.empty(stamped, np.uint32)
        words, offset = np.zeros((stamped, 3), np.uint16), np.empty(stamped, np.int64)
        text = np.empty(size, np.uint8)
        text_end, text_row = np.empty(most, np.int64), np.empty(most, np.int64)
        spans, resyncs = np.empty((most, 2), np.int64), np.empty((most, 2), np.int64)
        done = k.scan_packets(
            buffer, self._base, final, self._state, counts,
            kind, raw_ms, words, offset, text, text_end, text_row, spans, resyncs,
        )  # fmt: skip
        rows, texts = counts[k.ROWS], counts[k.TEXTS]
        scan = Scan(
            Packets(
                kind[:rows], raw_ms[:rows], words[:rows], offset[:rows],
                text[: counts[k.TEXT_BYTES]], text_end[:texts], text_row[:texts],
            ),
            tuple(bytes(buffer[a:b]).decode("ascii").strip() for a, b in spans[: counts[k.ERRORS]]),
            resyncs[: counts[k.RESYNCS]], counts,
        )  # fmt: skip
        self._rest = buffer[done:].tobytes()
        self._base += done
        return scan

    @property
    def lost_at(self) -> int | None:
        """Offset behind the last packet at which something other than zeros stands, None when nothing does."""
        lost, solid = self._state
        return int(lost) if 0 <= lost < solid else None

    @property
    def solid_end(self) -> int:
        """Offset behind the last byte that belongs to a packet or isn't zero."""
        return int(self._state[k.SOLID_END])
