"""Elevation tables (CSV, packed CSV or Parquet with ``lat_deg,lon_deg,alt_m[,way]``) as roads."""

from __future__ import annotations

import numpy as np

from app.imports.table import Table, read_table
from app.science.arrays import FloatArray, IntArray
from app.science.errors import SignalsError
from app.science.roads.elevation import COLUMNS, RoadElevation


def read_elevation(data: bytes) -> RoadElevation:
    """Read an elevation table; neighbouring rows of one way are joined, and without ``way`` all rows are one way.

    Parameters
    ----------
    data : bytes
        A table with a header. ``way`` may be numbers or words.

    Raises
    ------
    SignalsError
        When a column is missing or a row can't be used: with row and column. A table of roads is refused as a whole,
        because a missing node would join its neighbours wrongly.
    """
    table = read_table(data)
    required = COLUMNS[:3]
    missing = [name for name in required if name not in table]
    if missing:
        raise SignalsError(
            f"The column {missing[0]} is missing; an elevation table has {', '.join(COLUMNS)} (way is optional), and "
            f"this one {', '.join(table.names[:12])}.",
            1,
            missing[0],
        )
    lat, lon, alt = (_complete(table, name) for name in required)
    if table.warnings:
        raise SignalsError(f"{table.warnings[0]} An elevation table must be whole; mend or delete that row.")
    try:
        return RoadElevation(lat, lon, alt, _ways(table))
    except SignalsError as error:
        if not error.row:
            raise
        row = int(table.row[error.row - 2])  # rows that are blank are not counted there
        raise SignalsError(str(error).replace(f"Row {error.row}:", f"Row {row}:"), row, error.field) from error


def _complete(table: Table, name: str) -> FloatArray:
    values = table.numbers(name)
    empty = np.flatnonzero(np.isnan(values))
    if len(empty):
        row = int(table.row[empty[0]])
        words = "isn't a number" if table.first_bad_row(name) == row else "is empty"
        raise SignalsError(f"Row {row}: {name} {words}.", row, name)
    return values


def _ways(table: Table) -> IntArray:
    if "way" not in table:
        return np.zeros(len(table.row), dtype=np.int64)
    index, _ = table.texts("way")
    return index
