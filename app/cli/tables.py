"""Columns as Parquet files."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path

import pyarrow as pa
import pyarrow.parquet as pq

from app.science.arrays import FloatArray


def write_columns(path: Path, columns: Mapping[str, FloatArray]) -> None:
    """Write columns of equal length; NaN becomes null, which every reader of Parquet understands as missing."""
    arrays = [pa.array(values, from_pandas=True) for values in columns.values()]
    pq.write_table(pa.table(arrays, names=list(columns)), path)
