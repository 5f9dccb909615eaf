"""The states as CSV."""

from __future__ import annotations

import pyarrow as pa
import pyarrow.csv as arrow_csv

from app.exports.parquet import states_table
from app.science.observer.result import Observation


def states_csv(observation: Observation) -> bytes:
    """Write the states table with one header line; what is not known is empty, numbers keep their full precision."""
    sink = pa.BufferOutputStream()
    arrow_csv.write_csv(states_table(observation.columns), sink, arrow_csv.WriteOptions(quoting_style="none"))
    return bytes(sink.getvalue())
