"""Unpacking gzip without trusting it: never more than a given size, and what is good of a torn file."""

from __future__ import annotations

import zlib
from dataclasses import dataclass

from app.science.errors import SignalsError

MAGIC = b"\x1f\x8b"
_STEP = 1 << 20
_GZIP = 16 + zlib.MAX_WBITS


@dataclass(frozen=True, slots=True)
class Unpacked:
    """The content, and whether the packed file ended before it should."""

    content: bytes
    torn: bool


def unpack(data: bytes, limit: int) -> Unpacked:
    """Unpack gzip, also when several packed files follow each other.

    Parameters
    ----------
    data : bytes
        Packed bytes.
    limit : int
        Most bytes to unpack.

    Raises
    ------
    SignalsError
        When more than `limit` bytes would come out, or nothing does.
    """
    pieces: list[bytes] = []
    size = 0
    rest, torn = data, False
    while rest.startswith(MAGIC) and not torn:
        engine = zlib.decompressobj(_GZIP)
        while not engine.eof:
            try:
                piece = engine.decompress(rest, min(_STEP, limit - size + 1))
            except zlib.error:
                torn = True
                break
            size += len(piece)
            pieces.append(piece)
            if size > limit:
                raise SignalsError(
                    f"Unpacked, this file has more than {limit // 1_000_000} MB, more than a table of signals takes. "
                    f"Split it by trip."
                )
            rest = engine.unconsumed_tail
            if not piece and not rest and not engine.eof:
                torn = True
                break
        if engine.eof:
            rest = engine.unused_data.lstrip(b"\x00")
    if not size:
        raise SignalsError("The packed file is damaged from its beginning; nothing could be unpacked. Copy it again.")
    return Unpacked(b"".join(pieces), torn)


def peek(head: bytes, size: int) -> bytes:
    """Return the first unpacked bytes of a packed file's beginning; empty when it can't be unpacked."""
    try:
        return zlib.decompressobj(_GZIP).decompress(head, size)
    except zlib.error:
        return b""
