"""Tables written by Ponthy, read by others."""

from __future__ import annotations

import csv
import io
import json
import zlib
from base64 import b64decode
from dataclasses import fields, replace

import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq
import pytest
from hypothesis import given
from hypothesis import strategies as st

from app.exports.csv import states_csv
from app.exports.map_table import map_csv, map_json
from app.exports.parquet import innovations_parquet, operating_points_parquet, recording_parquet, states_parquet
from app.imports.results import read_innovations, read_operating_points, read_states
from app.imports.signals import read_signals
from app.science.engine.cells import accumulate, build_map
from app.science.engine.efficiency_map import CellGrid
from app.science.engine.points import OperatingPoints
from app.science.logger.recording import SIGNAL_UNITS, Recording, series
from app.science.observer.result import Innovations
from app.science.vehicle.model import Vehicle
from tests.synthetic import drive, random_points, sensors_of

OBSERVATION = drive(seconds=200.0)
RECORDING = sensors_of(OBSERVATION)
MAP = build_map(accumulate(random_points(5000), CellGrid()), CellGrid(), Vehicle())


def test_a_recording_comes_back_as_it_was() -> None:
    back = read_signals(recording_parquet(RECORDING), filename="recording.parquet")
    assert sorted(back.signals) == sorted(RECORDING.signals)
    for name in RECORDING:
        np.testing.assert_array_equal(back[name].t_s, RECORDING[name].t_s)
        np.testing.assert_array_equal(back[name].value, RECORDING[name].value)
    assert back.started_at_utc_s == RECORDING.started_at_utc_s
    assert back.texts == RECORDING.texts
    assert back.warnings == RECORDING.warnings


SAMPLES = st.lists(
    st.tuples(st.floats(0, 1e6), st.floats(allow_nan=False, allow_infinity=False)), min_size=1, max_size=8
)


@given(
    st.dictionaries(st.sampled_from(sorted(SIGNAL_UNITS)), SAMPLES, min_size=1, max_size=4),
    st.none() | st.floats(0, 2e9),
    st.dictionaries(st.text(max_size=5), st.text(max_size=20), max_size=2),
    st.lists(st.text(max_size=20), max_size=2),
)
def test_any_recording_lies_in_the_table_row_by_row(
    samples: dict[str, list[tuple[float, float]]],
    started: float | None,
    texts: dict[str, str],
    warnings: list[str],
) -> None:
    signals = {name: series(*zip(*rows, strict=True)) for name, rows in samples.items()}
    recording = Recording(signals, started, texts, tuple(warnings))
    table = pq.read_table(pa.BufferReader(recording_parquet(recording)))
    assert table.column_names == ["t_s", "signal", "value"]
    rows = [(name, t, v) for name in signals for t, v in zip(signals[name].t_s, signals[name].value, strict=True)]
    assert table["signal"].to_pylist() == [row[0] for row in rows]
    assert table["t_s"].to_pylist() == [row[1] for row in rows]
    assert table["value"].to_pylist() == [row[2] for row in rows]
    about = json.loads(zlib.decompress(b64decode(table.schema.metadata[b"ponthy"])))
    assert about == {"started_at_utc_s": started, "texts": texts, "warnings": warnings}


def test_sentences_of_a_receiver_take_little_room() -> None:
    sentence = "".join(
        f"$GPGGA,0741{n % 60:02d}.00,4851.{n:04d},N,00221.0000,E,1,08,1.1,60.0,M,,M,,*5D\r\n" for n in range(9999)
    )
    long = Recording(RECORDING.signals, None, {"nmea": sentence})
    packed = recording_parquet(long)
    assert len(packed) - len(recording_parquet(replace(long, texts={}))) < len(sentence) / 4
    assert read_signals(packed, filename="recording.parquet").texts == {"nmea": sentence}


def test_states_have_the_columns_of_the_contract_and_null_where_unknown() -> None:
    data = states_parquet(OBSERVATION)
    table = pq.read_table(pa.BufferReader(data))
    assert table.column_names == list(OBSERVATION.columns)
    assert table.column_names[0] == "t_s"
    assert {"speed_mps", "speed_mps_sd", "bias_k_mps2_sd", "lat_deg", "efficiency", "gear"} <= set(table.column_names)
    unknown = np.isnan(OBSERVATION.columns["efficiency"])
    assert table["efficiency"].null_count == unknown.sum() > 0
    assert table["gear"].type == pa.int8()
    back = read_states(data)
    for name, values in OBSERVATION.columns.items():
        np.testing.assert_array_equal(back[name], values, err_msg=name)


def test_only_the_wanted_states_are_read() -> None:
    back = read_states(states_parquet(OBSERVATION), ["speed_mps", "t_s", "nothing"])
    assert list(back) == ["t_s", "speed_mps"]


def test_operating_points_come_back() -> None:
    points = random_points(100)
    back = read_operating_points(operating_points_parquet(points))
    assert back.torque_source == "observer"
    for field in fields(OperatingPoints):
        np.testing.assert_array_equal(getattr(back, field.name), getattr(points, field.name))


def test_no_operating_points_come_back_as_none() -> None:
    nothing = np.empty(0)
    empty = OperatingPoints(nothing, nothing, nothing, nothing, nothing, nothing, nothing, "ecu")
    back = read_operating_points(operating_points_parquet(empty))
    assert len(back) == 0
    assert back.torque_source == "ecu"


def test_innovations_come_back_with_sensors_in_their_order() -> None:
    data = innovations_parquet(OBSERVATION)
    back = read_innovations(data)
    for field in fields(Innovations):
        np.testing.assert_array_equal(getattr(back, field.name), getattr(OBSERVATION.innovations, field.name))
    assert pq.read_table(pa.BufferReader(data))["sensor"][1].as_py() == "acc_i"


def test_states_as_csv_are_the_same_numbers() -> None:
    rows = list(csv.DictReader(io.StringIO(states_csv(OBSERVATION).decode())))
    assert len(rows) == len(OBSERVATION.columns["t_s"])
    for name, values in OBSERVATION.columns.items():
        read = np.array([float(row[name]) if row[name] else np.nan for row in rows])
        np.testing.assert_array_equal(read, values, err_msg=name)


def test_the_map_as_csv_and_as_json_say_the_same() -> None:
    rows = list(csv.DictReader(io.StringIO(map_csv(MAP).decode())))
    cells = json.loads(map_json(MAP, {"car": "x"}))["cells"]
    assert len(rows) == len(cells) == len(MAP.n)
    for row, cell in zip(rows, cells, strict=True):
        assert {k: float(v) if v else None for k, v in row.items()} == cell


@pytest.mark.parametrize("write", [states_parquet, innovations_parquet, states_csv])
def test_the_same_observation_gives_the_same_bytes(write: object) -> None:
    assert callable(write)
    assert write(OBSERVATION) == write(OBSERVATION)
