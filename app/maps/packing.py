"""Sums of cells as bytes and back, for keeping them in a table."""

from __future__ import annotations

from dataclasses import fields
from io import BytesIO

import numpy as np

from app.science.engine.efficiency_map import CellSums


def pack_sums(sums: CellSums) -> bytes:
    """Return the sums as a compressed NumPy archive with one array per field of `CellSums`."""
    buffer = BytesIO()
    np.savez_compressed(buffer, **{field.name: getattr(sums, field.name) for field in fields(CellSums)})
    return buffer.getvalue()


def unpack_sums(data: bytes) -> CellSums:
    """Return the sums that `pack_sums` packed."""
    with np.load(BytesIO(data), allow_pickle=False) as archive:
        return CellSums(**{field.name: archive[field.name] for field in fields(CellSums)})
