"""Tables as CSV."""

from __future__ import annotations

from collections.abc import Mapping

import pyarrow as pa
import pyarrow.csv as arrow_csv

from app.exports.parquet import states_table
from app.science.arrays import FloatArray
from app.science.observer.result import Observation


def states_csv(observation: Observation) -> bytes:
    """Write the states table with one header line; what is not known is empty, numbers keep their full precision."""
    return table_csv(observation.columns)


def table_csv(columns: Mapping[str, FloatArray]) -> bytes:
    """Write columns of equal length in the same way."""
    sink = pa.BufferOutputStream()
    arrow_csv.write_csv(states_table(columns), sink, arrow_csv.WriteOptions(quoting_style="none"))
    return bytes(sink.getvalue())
