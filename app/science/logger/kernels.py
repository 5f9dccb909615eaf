"""Compiled loop over a logger image: finding packets."""

from __future__ import annotations

import numpy as np

from app.science.arrays import AnyArray, IntArray
from app.science.jit import kernel

START = 0xFF
ERROR, ACCELEROMETER, GPS, VSS, INJECTOR, SKEW = range(6)
LONGEST_PACKET = 3 + 255
LOOKAHEAD_BYTES = 2 * LONGEST_PACKET + 2
"""What a decision about one start byte may look at: the packet, one that begins inside it, and what follows."""

NO_HEADER, WRONG_SUM = -1, -2
STRIDE = 256  # bytes tested at a time where nothing is expected; wide enough to run at memory speed

LOST_AT, SOLID_END = range(2)
"""Entries of the scanner's state: offset where the packets stopped (-1: in step), end of the last non-zero byte."""

BAD_SUMS, BAD_HEADERS, PACKET_BYTES, ROWS, TEXTS, TEXT_BYTES, ERRORS, RESYNCS = range(6, 14)
COUNTS = 14
"""Entries of `scan_packets`' counts; the first six are packets by type."""


@kernel
def next_start(buffer: AnyArray, begin: int, stop: int) -> int:
    """Return the index of the first start byte in ``[begin, stop)``, or ``stop``."""
    i = begin
    while i + STRIDE <= stop:
        found = np.uint8(0)
        for byte in buffer[i : i + STRIDE]:
            found |= np.uint8(byte == START)
        if found:
            break
        i += STRIDE
    while i < stop and buffer[i] != START:
        i += 1
    return i


@kernel
def solid_end(buffer: AnyArray, begin: int, stop: int) -> int:
    """Return the index behind the last non-zero byte of ``[begin, stop)``, or ``begin``."""
    i = stop
    while i - STRIDE >= begin:
        bits = np.uint8(0)
        for byte in buffer[i - STRIDE : i]:
            bits |= byte
        if bits:
            break
        i -= STRIDE
    while i > begin and buffer[i - 1] == 0:
        i -= 1
    return i


@kernel
def packet_end(buffer: AnyArray, i: int, stop: int) -> int:
    """Return the index behind the packet at ``i`` when its header and sum are right, else why not."""
    if stop - i < 5 or buffer[i] != START:
        return NO_HEADER
    kind = buffer[i + 1]
    length = int(buffer[i + 2])
    if kind == ACCELEROMETER:
        wrong = length != 11
    elif kind in (VSS, SKEW):
        wrong = length != 6
    elif kind == INJECTOR:
        wrong = length != 7
    else:
        wrong = kind > SKEW or length < 2
    end = i + 3 + length
    if wrong or end > stop:
        return NO_HEADER
    total = length
    for byte in buffer[i + 3 : end - 1]:
        total += byte
    if total & 0xFF != buffer[end - 1]:
        return WRONG_SUM
    if kind == ERROR:  # the sum doesn't cover the type: one flipped bit would make readings into an error message
        for byte in buffer[i + 3 : end - 1]:
            if (byte < 32 or byte > 126) and byte != 9 and byte != 10 and byte != 13:
                return NO_HEADER
    return end


@kernel
def is_followed(buffer: AnyArray, end: int, stop: int) -> bool:
    """Tell whether the next packet, or the end of the image, stands at ``end``."""
    return end >= stop or (buffer[end] == START and (end + 1 >= stop or buffer[end + 1] <= SKEW))


@kernel
def uncontested_end(buffer: AnyArray, i: int, end: int, stop: int) -> int:
    """Return ``end`` of the packet at ``i``, or refuse it as an accident of the 8-bit sum.

    A packet that isn't followed by another one gives way to a packet that starts inside it, ends beyond it and is.
    """
    if not is_followed(buffer, end, stop):
        for inner in range(i + 1, end):
            if buffer[inner] == START:
                other = packet_end(buffer, inner, stop)
                if other > end and is_followed(buffer, other, stop):
                    return WRONG_SUM
    return end


@kernel
def scan_packets(
    buffer: AnyArray,
    base: int,
    final: bool,
    state: IntArray,
    counts: IntArray,
    kind: AnyArray,
    raw_ms: AnyArray,
    words: AnyArray,
    offset: IntArray,
    text: AnyArray,
    text_end: IntArray,
    text_row: IntArray,
    spans: IntArray,
    resyncs: IntArray,
) -> int:
    """Read all packets of a buffer into columns; 16- and 32-bit numbers are read as little-endian.

    Parameters
    ----------
    buffer : array of uint8, shape (n,)
        Bytes of the image; the first one is byte ``base`` of the image.
    final : bool
        No further bytes will come, so the last packets are judged by what is there.
    state : array, shape (2,)
        ``LOST_AT`` and ``SOLID_END``, carried from buffer to buffer; updated.
    counts : array, shape (COUNTS,)
        Zeros on entry; filled with what was found.
    kind, raw_ms, words, offset : arrays, shapes (m,), (m,), (m, 3), (m,)
        Filled per stamped packet: type, time stamp, up to three 16-bit values, offset in the image.
    text, text_end, text_row : arrays
        Filled per GPS packet: messages one after the other, where each ends, number of stamped packets before it.
    spans : array, shape (m, 2)
        Filled per error packet: begin and end of its message in ``buffer``.
    resyncs : array, shape (m, 2)
        Filled per loss of step: offset in the image and number of bytes skipped, zeros at its end not counted.

    Returns
    -------
    int
        Number of bytes dealt with; the rest belongs in front of the next buffer.
    """
    stop = len(buffer)
    i = 0
    while i < stop:
        if not final and stop - i < LOOKAHEAD_BYTES:
            break
        end = packet_end(buffer, i, stop)
        if end > 0 and not (end + 1 < stop and buffer[end] == START and buffer[end + 1] <= SKEW):
            end = uncontested_end(buffer, i, end, stop)
        if end < 0:
            if state[LOST_AT] < 0:
                state[LOST_AT] = base + i
                counts[BAD_SUMS] += end == WRONG_SUM
                counts[BAD_HEADERS] += end == NO_HEADER and buffer[i] == START
            begin = i
            i = next_start(buffer, begin + 1, stop)
            solid = solid_end(buffer, begin, i)
            if solid > begin:
                state[SOLID_END] = base + solid
            continue
        if state[LOST_AT] >= 0:
            if state[SOLID_END] > state[LOST_AT]:
                resyncs[counts[RESYNCS], 0] = state[LOST_AT]
                resyncs[counts[RESYNCS], 1] = state[SOLID_END] - state[LOST_AT]
                counts[RESYNCS] += 1
            state[LOST_AT] = -1
        state[SOLID_END] = base + end
        packet_kind = buffer[i + 1]
        counts[packet_kind] += 1
        counts[PACKET_BYTES] += end - i
        if packet_kind == GPS:
            size = end - 1 - (i + 3)
            at = counts[TEXT_BYTES]
            text[at : at + size] = buffer[i + 3 : end - 1]
            text_end[counts[TEXTS]] = at + size
            text_row[counts[TEXTS]] = counts[ROWS]
            counts[TEXT_BYTES] += size
            counts[TEXTS] += 1
        elif packet_kind == ERROR:
            spans[counts[ERRORS], 0] = i + 3
            spans[counts[ERRORS], 1] = end - 1
            counts[ERRORS] += 1
        else:
            row = counts[ROWS]
            kind[row] = packet_kind
            offset[row] = base + i
            raw_ms[row] = (
                np.uint32(buffer[i + 3])
                | np.uint32(buffer[i + 4]) << np.uint32(8)
                | np.uint32(buffer[i + 5]) << np.uint32(16)
                | np.uint32(buffer[i + 6]) << np.uint32(24)
            )
            if packet_kind in (VSS, SKEW):
                words[row, 0] = buffer[i + 7]
            else:
                for word in range((end - i - 8) // 2):
                    words[row, word] = buffer[i + 7 + 2 * word] | np.uint16(buffer[i + 8 + 2 * word]) << np.uint16(8)
            counts[ROWS] += 1
        i = end
    return i
