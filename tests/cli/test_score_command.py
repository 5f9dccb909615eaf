"""``./ponthy score``: a folder as process writes it, in words, as JSON, and what is missing."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pyarrow.parquet as pq
import pytest

from app.cli.main import main
from app.cli.tables import write_columns
from app.science.virtualcar.carfile import car_xml
from tests.science.eco.trips import CAR, driven, map_document


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    write_columns(tmp_path / "states.parquet", driven(4800.0, seconds=45.0, top_mps=15.0))
    (tmp_path / "map.json").write_text(json.dumps(map_document()))
    (tmp_path / "car.xml").write_bytes(car_xml(CAR))
    return tmp_path


def test_a_folder_is_scored(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    car, along = str(folder / "car.xml"), folder / "along.parquet"
    assert main(["score", str(folder), "--car", car, "--along", str(along), "--json"]) == 0
    captured = capsys.readouterr()
    document = json.loads(captured.out)
    assert document["score"]["value"] < 95.0
    assert document["saved_l"]["value"] == pytest.approx(sum(part["litres"] for part in document["parts"]))
    assert "100 %" in captured.err
    table = pq.read_table(along)
    assert {"distance_m", "speed_mps", "best_speed_mps", "best_gear", "lost_lpkm"} <= set(table.column_names)
    assert main(["score", str(folder), "--car", car]) == 0
    said = capsys.readouterr().out
    assert "could have taken" in said
    assert "Pontryagin, in any time" in said


def test_a_trip_that_is_not_there_is_an_error_of_the_call(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["score", str(folder), "--car", str(folder / "car.xml"), "--trip", "2"]) == 2
    assert "states-2.parquet is missing" in capsys.readouterr().err


def test_litres_that_nobody_measured_are_told_as_such(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    states = driven(4800.0, seconds=45.0, top_mps=15.0)
    write_columns(folder / "states.parquet", states | {"fuel_power_w": np.full_like(states["t_s"], np.nan)})
    (folder / "map.json").write_text(json.dumps({"cell": {"rpm": 50, "nm": 2}, "cells": []}))
    assert main(["score", str(folder), "--car", str(folder / "car.xml")]) == 0
    said = capsys.readouterr().out
    assert "litres by an ordinary engine, none were measured" in said.splitlines()[0]
    assert "warning: This trip measured no fuel" in said
