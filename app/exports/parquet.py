"""Tables as Parquet bytes; `app.imports` reads them back."""

from __future__ import annotations

import json
import zlib
from base64 import b64encode
from collections.abc import Mapping
from dataclasses import fields
from io import BytesIO
from typing import Any

import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq

from app.science.arrays import AnyArray, FloatArray
from app.science.engine.points import OperatingPoints
from app.science.logger.recording import Recording
from app.science.observer.result import Observation
from app.science.roadload.windows import WINDOW_COLUMNS, WINDOW_SCALARS, RoadLoadWindows

RECORDING_KEY = b"ponthy"
RESULT_KEY = b"ponthy_result"
FAST = 1


def recording_parquet(recording: Recording) -> bytes:
    """Write a recording as a long signals table ``t_s, signal, value``.

    What else the recording holds (start, texts, warnings) lies in the file's metadata, so that the signals reader
    gives back an equal recording.
    """
    streams = list(recording.signals.values())
    lengths = [len(stream) for stream in streams]
    names = pa.DictionaryArray.from_arrays(
        pa.array(np.repeat(np.arange(len(streams), dtype=np.int16), lengths)), pa.array(list(recording), pa.string())
    )
    table = pa.table(
        {
            "t_s": np.concatenate([np.empty(0), *(stream.t_s for stream in streams)]),
            "signal": names,
            "value": np.concatenate([np.empty(0), *(stream.value for stream in streams)]),
        }
    )
    about = {
        "started_at_utc_s": recording.started_at_utc_s,
        "texts": dict(recording.texts),
        "warnings": list(recording.warnings),
    }
    # packed, because the receiver's sentences would outweigh the numbers, and as text, which every reader can skip
    packed = b64encode(zlib.compress(json.dumps(about).encode(), FAST))
    return _parquet(table, {RECORDING_KEY: packed}, dictionary=["signal"])


def states_table(columns: Mapping[str, FloatArray]) -> Any:
    """Return the states as an Arrow table: what is not known is null, the gear is a whole number."""
    arrays = {name: _nullable(values) for name, values in columns.items()}
    if "gear" in arrays:
        arrays["gear"] = arrays["gear"].cast(pa.int8())
    return pa.table(arrays)


def states_parquet(observation: Observation) -> bytes:
    """Write the observer's states, their deviations and what follows from them."""
    about = {"filter": observation.filter, "tuning": observation.tuning, "smoothed": observation.smoothed}
    return table_parquet(observation.columns, about)


def table_parquet(columns: Mapping[str, FloatArray], about: Mapping[str, Any]) -> bytes:
    """Write columns of equal length as the states are written, with what else is to be told in the metadata."""
    return _parquet(states_table(columns), _told(about))


def rows_parquet(table: Any, about: Mapping[str, Any]) -> bytes:
    """Write an Arrow table of any columns, with what else is to be told in the metadata."""
    return _parquet(table, _told(about))


def operating_points_parquet(points: OperatingPoints) -> bytes:
    """Write operating points, one row each."""
    names = [field.name for field in fields(points) if field.name != "torque_source"]
    table = pa.table({name: _nullable(getattr(points, name)) for name in names})
    return _parquet(table, _told({"torque_source": points.torque_source}))


def columns_parquet(columns: Mapping[str, FloatArray]) -> bytes:
    """Write columns of one length; what is not known is null."""
    return _parquet(pa.table({name: _nullable(values) for name, values in columns.items()}), {})


def road_load_parquet(windows: RoadLoadWindows) -> bytes:
    """Write road-load windows, one row each; what the observer assumed lies in the file's metadata."""
    table = pa.table({name: _nullable(getattr(windows, name)) for name in WINDOW_COLUMNS})
    return _parquet(table, _told({name: getattr(windows, name) for name in WINDOW_SCALARS}))


def innovations_parquet(observation: Observation) -> bytes:
    """Write the innovation of every measurement, in the order they were processed."""
    i = observation.innovations
    table = pa.table(
        {
            "t_s": i.t_s,
            "sensor": pa.DictionaryArray.from_arrays(
                pa.array(i.sensor.astype(np.int8)), pa.array(i.sensors, pa.string())
            ),
            "innovation": _nullable(i.innovation),
            "sd": _nullable(i.sd),
            "accepted": i.accepted.astype(np.int8),
        }
    )
    return _parquet(table, _told({"sensors": list(i.sensors)}), dictionary=["sensor"])


def _nullable(values: AnyArray) -> Any:
    return pa.array(values, from_pandas=True)


def _told(about: Mapping[str, Any]) -> dict[bytes, bytes]:
    return {RESULT_KEY: json.dumps(about).encode()}


def _parquet(table: Any, metadata: dict[bytes, bytes], dictionary: list[str] | None = None) -> bytes:
    """Write a table. Arrow's own copy of the schema is left out, since it would repeat the metadata.

    Python's buffer hands out its bytes without a copy, and grows by an eighth where Arrow's doubles.
    """
    sink = BytesIO()
    how = {"compression": "zstd", "use_dictionary": dictionary or False, "store_schema": False}
    with pq.ParquetWriter(sink, table.schema, **how) as writer:
        writer.write_table(table)
        writer.add_key_value_metadata(metadata)
    return sink.getvalue()
