"""Columns as Parquet files."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path

import pyarrow as pa
import pyarrow.csv as pa_csv
import pyarrow.parquet as pq

from app.science.arrays import FloatArray


def write_columns(path: Path, columns: Mapping[str, FloatArray]) -> None:
    """Write columns of equal length; NaN becomes null, which every reader of Parquet understands as missing."""
    arrays = [pa.array(values, from_pandas=True) for values in columns.values()]
    pq.write_table(pa.table(arrays, names=list(columns)), path)


def write_csv(path: Path, columns: Mapping[str, FloatArray]) -> None:
    """Write columns of equal length as text; NaN becomes an empty cell."""
    arrays = [pa.array(values, from_pandas=True) for values in columns.values()]
    pa_csv.write_csv(
        pa.table(arrays, names=list(columns)), path, pa_csv.WriteOptions(quoting_style="none", quoting_header="none")
    )
