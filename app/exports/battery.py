"""A battery's history, and what one estimate says over time, as tables."""

from __future__ import annotations

import csv
import io
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
import pyarrow as pa

from app.exports.csv import table_csv
from app.exports.parquet import rows_parquet, table_parquet
from app.science.arrays import FloatArray

FORMULA = ("=", "+", "-", "@", "\t", "\r")
"""A text that begins so is a formula to a spreadsheet."""


def history_csv(rows: Sequence[Mapping[str, Any]]) -> bytes:
    """Write one row for each estimate; what is not known is empty, and no name is run by a spreadsheet."""
    sink = io.StringIO()
    writer = csv.DictWriter(sink, list(rows[0]) if rows else [], lineterminator="\n")
    writer.writeheader()
    writer.writerows({name: _cell(value) for name, value in row.items()} for row in rows)
    return sink.getvalue().encode()


def history_parquet(rows: Sequence[Mapping[str, Any]], about: Mapping[str, Any]) -> bytes:
    """Write the same as Parquet; which battery it is lies in the file's metadata."""
    return rows_parquet(pa.Table.from_pylist([dict(row) for row in rows]), about)


def answer_csv(answer: Mapping[str, Any]) -> bytes:
    """Write what an estimate says over time, one row for each kept time."""
    return table_csv(_columns(answer))


def answer_parquet(answer: Mapping[str, Any]) -> bytes:
    """Write the same as Parquet; where it came from lies in the file's metadata."""
    return table_parquet(_columns(answer), {"provenance": answer.get("provenance")})


def _columns(answer: Mapping[str, Any]) -> dict[str, FloatArray]:
    return {
        name: np.array([np.nan if value is None else value for value in values], dtype=np.float64)
        for name, values in answer["history"].items()
    }


def _cell(value: object) -> object:
    return f"'{value}" if isinstance(value, str) and value.startswith(FORMULA) else value
