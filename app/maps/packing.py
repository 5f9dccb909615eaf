"""Sums of cells and moments as bytes and back, for keeping them in a table."""

from __future__ import annotations

from dataclasses import fields
from io import BytesIO

import numpy as np

from app.science.engine.efficiency_map import CellSums
from app.science.engine.moments import MomentSums

OF_MOMENTS = "moments_"
"""What the names of the arrays of `MomentSums` begin with."""


def pack_sums(sums: CellSums, moments: MomentSums) -> bytes:
    """Return the sums as a compressed NumPy archive with one array per field of `CellSums` and `MomentSums`."""
    buffer = BytesIO()
    cells = {field.name: getattr(sums, field.name) for field in fields(CellSums)}
    beside = {OF_MOMENTS + field.name: getattr(moments, field.name) for field in fields(MomentSums)}
    np.savez_compressed(buffer, **cells, **beside)
    return buffer.getvalue()


def unpack_sums(data: bytes) -> CellSums:
    """Return the cells that `pack_sums` packed."""
    with np.load(BytesIO(data), allow_pickle=False) as archive:
        return CellSums(**{field.name: archive[field.name] for field in fields(CellSums)})


def unpack_moments(data: bytes) -> MomentSums:
    """Return the moments that `pack_sums` packed."""
    with np.load(BytesIO(data), allow_pickle=False) as archive:
        return MomentSums(**{field.name: archive[OF_MOMENTS + field.name] for field in fields(MomentSums)})
