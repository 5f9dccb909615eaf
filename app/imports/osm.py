"""OpenStreetMap extracts (.osm.pbf): the ways that cars drive on, with their speed limits.

The format is https://wiki.openstreetmap.org/wiki/PBF_Format: compressed blocks of Protocol Buffers, of which only the
fields that tell nodes and ways are read.
"""

from __future__ import annotations

import re
import zlib
from collections.abc import Iterator

import numpy as np

from app.science.arrays import FloatArray, IntArray
from app.science.errors import SignalsError
from app.science.optimal.posing.highways import Highway, Highways

LARGEST_BYTES, LARGEST_BLOCK = 200_000_000, 64_000_000
MAIN = ("motorway", "trunk", "primary", "secondary", "tertiary")
DRIVEN = {*MAIN, *(f"{kind}_link" for kind in MAIN), "unclassified", "residential", "living_street"}
LIMIT = re.compile(r"(\d{1,3})(?:\s*(km/h|mph))?")
MPH = 0.44704
Fields = list[tuple[int, int | bytes]]


def looks_like_osm(data: bytes) -> bool:
    """Tell whether a file begins like an extract."""
    return b"OSMHeader" in data[:64]


def read_osm(data: bytes) -> Highways:
    """Read the roads of an extract.

    Raises
    ------
    SignalsError
        When it is no such file, or is damaged.
    """
    if len(data) > LARGEST_BYTES:
        raise SignalsError(f"The extract has more than {LARGEST_BYTES // 1_000_000} MB; cut out the area of the road.")
    nodes: list[tuple[IntArray, FloatArray, FloatArray]] = []
    ways: list[tuple[dict[str, str], IntArray]] = []
    try:
        for block in _blocks(data):
            _read_block(block, nodes, ways)
    except (LookupError, ValueError, zlib.error) as error:
        raise SignalsError("The file is no OpenStreetMap extract (.osm.pbf), or it is damaged.") from error
    if not ways or not nodes:
        raise SignalsError("The extract holds no road that cars drive on.")
    known, lat, lon = (np.concatenate(column) for column in zip(*nodes, strict=True))
    order = np.argsort(known, kind="stable")
    known, lat, lon = known[order], lat[order], lon[order]
    return Highways(tuple(_highway(tags, refs, known, lat, lon) for tags, refs in ways))


def _highway(tags: dict[str, str], refs: IntArray, known: IntArray, lat: FloatArray, lon: FloatArray) -> Highway:
    at = np.minimum(np.searchsorted(known, refs), known.size - 1)
    there = known[at] == refs
    rows = at[there]
    names = tuple(tags[name] for name in ("ref", "name") if name in tags)
    return Highway(names, _limit_mps(tags.get("maxspeed", "")), refs[there], lat[rows], lon[rows])


def _limit_mps(text: str) -> float | None:
    """Return a limit in m/s; None where it is a word, such as ``none`` or ``signals``."""
    found = LIMIT.fullmatch(text.strip())
    if found is None or int(found[1]) == 0:
        return None
    return int(found[1]) * (MPH if found[2] == "mph" else 1.0 / 3.6)


def _blocks(data: bytes) -> Iterator[bytes]:
    """Give the data blocks one by one, unpacked."""
    at = 0
    while at < len(data):
        size = int.from_bytes(data[at : at + 4], "big")
        if size > LARGEST_BLOCK:
            raise ValueError(size)
        head = dict(_fields(data[at + 4 : at + 4 + size]))
        at += 4 + size
        length = _whole(head[3])
        if at + length > len(data):
            raise ValueError(length)
        if head[1] == b"OSMData":
            blob = dict(_fields(data[at : at + length]))
            yield _bytes(blob[1]) if 1 in blob else zlib.decompressobj().decompress(_bytes(blob[3]), LARGEST_BLOCK)
        at += length


def _read_block(
    block: bytes,
    nodes: list[tuple[IntArray, FloatArray, FloatArray]],
    ways: list[tuple[dict[str, str], IntArray]],
) -> None:
    """Add the nodes and the driven ways of a block."""
    fields = _fields(block)
    plain = {number: _whole(value) for number, value in fields if number in (17, 19, 20)}
    step, south, west = plain.get(17, 100), plain.get(19, 0), plain.get(20, 0)
    words = next(([_bytes(text) for _, text in _fields(_bytes(value))] for number, value in fields if number == 1), [])
    for number, group in fields:
        if number != 2:
            continue
        for kind, value in _fields(_bytes(group)):
            if kind == 2:
                dense = dict(_fields(_bytes(value)))
                ids, lat, lon = (np.cumsum(_signed(_varints(_bytes(dense[k])))) for k in (1, 8, 9))
                nodes.append((ids, _degrees(south, step, lat), _degrees(west, step, lon)))
            elif kind == 3:
                way = dict(_fields(_bytes(value)))
                keys, texts = (_varints(_bytes(way.get(k, b""))).tolist() for k in (2, 3))
                tags = {words[k].decode(): words[v].decode() for k, v in zip(keys, texts, strict=True)}
                if tags.get("highway") in DRIVEN:
                    ways.append((tags, np.cumsum(_signed(_varints(_bytes(way[8]))))))


def _degrees(edge: int, step: int, count: IntArray) -> FloatArray:
    return np.asarray(1e-9 * (edge + step * count), dtype=np.float64)


def _fields(message: bytes) -> Fields:
    """Return the numbered fields of a message; numbers and packed bytes are all that occurs here."""
    found: Fields = []
    at = 0
    while at < len(message):
        key, at = _varint(message, at)
        if key & 7 == 0:
            value, at = _varint(message, at)
            found.append((key >> 3, value))
        elif key & 7 == 2:
            size, at = _varint(message, at)
            if at + size > len(message):
                raise ValueError(size)
            found.append((key >> 3, message[at : at + size]))
            at += size
        else:
            raise ValueError(key)
    return found


def _varint(message: bytes, at: int) -> tuple[int, int]:
    value = shift = 0
    while True:
        byte = message[at]
        value |= (byte & 127) << shift
        at, shift = at + 1, shift + 7
        if byte < 128:
            return value, at


def _varints(packed: bytes) -> IntArray:
    """Return packed numbers; each byte gives seven bits, the last of a number is below 128."""
    raw = np.frombuffer(packed, dtype=np.uint8)
    if not raw.size:
        return np.zeros(0, dtype=np.int64)
    ends = np.flatnonzero(raw < 128)
    starts = np.concatenate(([0], ends[:-1] + 1))
    place = np.arange(ends[-1] + 1) - np.repeat(starts, ends - starts + 1)
    if place.max() > 9:
        raise ValueError(place.max())
    bits = (raw[: ends[-1] + 1].astype(np.uint64) & np.uint64(127)) << (np.uint64(7) * place.astype(np.uint64))
    return np.add.reduceat(bits, starts).astype(np.int64)


def _signed(numbers: IntArray) -> IntArray:
    """Undo the zigzag that keeps small negative numbers small."""
    return (numbers >> 1) ^ -(numbers & 1)


def _whole(value: int | bytes) -> int:
    if not isinstance(value, int):
        raise ValueError("bytes where a number is expected")
    return value


def _bytes(value: int | bytes) -> bytes:
    if not isinstance(value, bytes):
        raise ValueError("a number where bytes are expected")
    return value
