"""Sums of cells and moments as bytes and back, for keeping them in a table.

A car's map is made from all its trips' sums, so what counts is how fast they are read: the arrays lie one after the
other as they are in memory, whole numbers in 32 bits.
"""

from __future__ import annotations

import json
from collections.abc import Iterator
from dataclasses import fields
from typing import Any

import numpy as np
from numpy.typing import NDArray

from app.science.engine.efficiency_map import CellSums
from app.science.engine.moments import MomentSums

OF_MOMENTS = "moments_"
"""What the names of the arrays of `MomentSums` begin with."""
HEADER_BYTES = 4
STORED: dict[str, np.dtype[Any]] = {"i": np.dtype("<i4"), "f": np.dtype("<f8")}
IN_MEMORY: dict[str, np.dtype[Any]] = {"i": np.dtype(np.int64), "f": np.dtype(np.float64)}


def pack_sums(sums: CellSums, moments: MomentSums) -> bytes:
    """Return the sums as a header, which names each array and its length, and the arrays."""
    arrays = {field.name: getattr(sums, field.name) for field in fields(CellSums)}
    arrays |= {OF_MOMENTS + field.name: getattr(moments, field.name) for field in fields(MomentSums)}
    header = json.dumps([[name, array.dtype.kind, len(array)] for name, array in arrays.items()]).encode()
    parts = [array.astype(STORED[array.dtype.kind]).tobytes() for array in arrays.values()]
    return b"".join([len(header).to_bytes(HEADER_BYTES, "little"), header, *parts])


def unpack_sums(data: bytes) -> CellSums:
    """Return the cells that `pack_sums` packed."""
    return CellSums(**{name: array for name, array in _arrays(data) if not name.startswith(OF_MOMENTS)})


def unpack_moments(data: bytes) -> MomentSums:
    """Return the moments that `pack_sums` packed."""
    found = {name.removeprefix(OF_MOMENTS): array for name, array in _arrays(data) if name.startswith(OF_MOMENTS)}
    return MomentSums(**found)


def _arrays(data: bytes) -> Iterator[tuple[str, NDArray[Any]]]:
    begin = HEADER_BYTES + int.from_bytes(data[:HEADER_BYTES], "little")
    for name, kind, length in json.loads(data[HEADER_BYTES:begin]):
        stored = STORED[kind]
        yield name, np.frombuffer(data, stored, length, begin).astype(IN_MEMORY[kind])
        begin += length * stored.itemsize
