"""Reading back the tables of results that `app.exports.parquet` wrote."""

from __future__ import annotations

import json
from collections.abc import Sequence
from typing import Any, BinaryIO

import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq

from app.science.arrays import FloatArray, IntArray
from app.science.engine.points import OperatingPoints
from app.science.logger.recording import Recording, Series
from app.science.observer.result import Innovations
from app.science.roadload.windows import WINDOW_COLUMNS, WINDOW_SCALARS, RoadLoadWindows

RESULT_KEY = b"ponthy_result"


def read_states(data: bytes, columns: Sequence[str] | None = None) -> dict[str, FloatArray]:
    """Read ``states.parquet``; see `read_columns`."""
    return read_columns(data, columns)


def read_columns(data: bytes, columns: Sequence[str] | None = None) -> dict[str, FloatArray]:
    """Read a table of numbers: columns by name, NaN where a value is not known.

    Parameters
    ----------
    data : bytes
    columns : sequence of str, optional
        Read only these; names the table lacks are left out.
    """
    file = pq.ParquetFile(pa.BufferReader(data))
    names = file.schema_arrow.names
    table = file.read(columns=[name for name in names if columns is None or name in columns])
    return {name: _floats(table[name]) for name in table.column_names}


def read_some_signals(file: BinaryIO, names: Sequence[str]) -> Recording:
    """Read those of some signals that a trip recorded; see `app.exports.parquet.recording_parquet`."""
    wanted = [("signal", "in", list(names))]
    table = pq.read_table(file, columns=["t_s", "signal", "value"], filters=wanted, read_dictionary=["signal"])
    t_s, value = _floats(table["t_s"]), _floats(table["value"])
    signal = np.asarray(table["signal"].cast(pa.string()).to_numpy(zero_copy_only=False))
    found = {name: signal == name for name in names}
    return Recording({name: Series(t_s[rows], value[rows]) for name, rows in found.items() if rows.any()})


def read_operating_points(data: bytes) -> OperatingPoints:
    """Read ``operating_points.parquet`` of one trip."""
    table = pq.read_table(pa.BufferReader(data))
    return OperatingPoints(
        **{name: _floats(table[name]) for name in OperatingPoints.__dataclass_fields__ if name != "torque_source"},
        torque_source=str(_about(table)["torque_source"]),
    )


def read_road_load(data: bytes) -> RoadLoadWindows:
    """Read ``road_load.parquet`` of one trip."""
    table = pq.read_table(pa.BufferReader(data))
    about = _about(table)
    values: dict[str, Any] = {name: _floats(table[name]) for name in WINDOW_COLUMNS}
    values |= {name: values[name].astype(np.int8) for name in ("kind", "gear")}
    return RoadLoadWindows(**values | {name: float(about[name]) for name in WINDOW_SCALARS})


def read_innovations(data: bytes) -> Innovations:
    """Read the innovations of one trip."""
    table = pq.read_table(pa.BufferReader(data), read_dictionary=["sensor"])
    sensors = tuple(str(name) for name in _about(table)["sensors"])
    return Innovations(
        t_s=_floats(table["t_s"]),
        sensor=_numbers_of(table["sensor"], sensors),
        innovation=_floats(table["innovation"]),
        sd=_floats(table["sd"]),
        accepted=np.asarray(table["accepted"].to_numpy(zero_copy_only=False)).astype(np.int64),
        sensors=sensors,
    )


def _numbers_of(column: Any, names: Sequence[str]) -> IntArray:
    """Return where each value of a dictionary-encoded column stands among the names, without making text of each."""
    number = {name: index for index, name in enumerate(names)}
    pieces = [
        np.array([number[name] for name in piece.dictionary.to_pylist()], dtype=np.int64)[
            piece.indices.to_numpy(zero_copy_only=False)
        ]
        for piece in column.chunks
    ]
    return np.concatenate(pieces) if pieces else np.empty(0, dtype=np.int64)


def _about(table: Any) -> dict[str, Any]:
    about: dict[str, Any] = json.loads(table.schema.metadata[RESULT_KEY])
    return about


def _floats(column: Any) -> FloatArray:
    return np.asarray(column.cast(pa.float64()).to_numpy(zero_copy_only=False), dtype=np.float64)
