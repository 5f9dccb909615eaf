"""``./ponthy drive``: answers as JSON and in words, and its exit status."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from app.cli.main import main
from tests.science.optimal.documents import TABLE_4_1, thesis

NAMES = {
    "fuel_energy_j", "time_s", "distance_m", "gears", "switch_speeds_mps", "multiplier_w", "trajectory", "costates",
    "advice", "warnings", "certificate",
}  # fmt: skip
COLUMNS = {
    "t_s", "distance_m", "speed_mps", "gear", "engine_speed_radps", "torque_nm", "fuel_power_w", "brake_n",
}  # fmt: skip


def run(tmp_path: Path, problem: Any, *options: str) -> int:
    path = tmp_path / "problem.json"
    path.write_text(problem if isinstance(problem, str) else json.dumps(problem))
    return main(["drive", str(path), *options])


def test_the_answer_has_the_names_others_rely_on(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert run(tmp_path, thesis(), "--json") == 0
    answer = json.loads(capsys.readouterr().out)
    assert set(answer) >= NAMES
    assert set(answer["trajectory"]) == COLUMNS
    assert answer["gears"] == [1, 2, 3, 4, 5]
    assert len(answer["switch_speeds_mps"]) == 4
    assert answer["certificate"]["verdict"] == "optimal"


def test_people_get_a_table_and_advice(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert run(tmp_path, thesis()) == 0
    out = capsys.readouterr().out
    assert "shift up at" in out
    assert "optimal: H drifts by" in out


def test_the_engine_of_a_map_is_taken_from_its_file(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    cells = []
    for rpm in np.arange(1525.0, 5000.0, 50.0):
        for nm in np.arange(21.0, 101.0, 2.0):
            w = rpm * np.pi / 30.0
            phi = float(np.dot(TABLE_4_1["phi"], [1.0, w, nm, w * nm, w * w, nm * nm]))
            cells.append({"rpm": rpm, "nm": nm, "n": 400, "efficiency": 1.0 / phi, "sd": 0.01, "bsfc_gpkwh": None})
    document = {"cell": {"rpm": 50, "nm": 2}, "cells": cells, "full_load": []}
    (tmp_path / "map.json").write_text(json.dumps(document))
    assert run(tmp_path, thesis(engine={"map": "map.json", "fit": "phi"}, from_speed_mps=12.0), "--json") == 0
    from_map = json.loads(capsys.readouterr().out)
    box = {"phi": TABLE_4_1["phi"], "speed_rpm": [1525, 4975], "torque_nm": [21, 99]}
    assert run(tmp_path, thesis(engine=box, from_speed_mps=12.0), "--json") == 0
    direct = json.loads(capsys.readouterr().out)
    assert from_map["fuel_energy_j"] == pytest.approx(direct["fuel_energy_j"], rel=1e-6)
    assert run(tmp_path, thesis(engine={"map": "map.json"}, from_speed_mps=12.0), "--json") == 0
    convex = json.loads(capsys.readouterr().out)
    assert not any("concave" in warning for warning in convex["warnings"])


def test_a_front_is_a_table_of_drives(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert run(tmp_path, thesis(), "--front", "time", "--points", "3") == 0
    lines = capsys.readouterr().out.splitlines()
    assert lines[0].split() == ["fuel", "kJ", "time", "s", "gears", "verdict"]
    assert lines[1].startswith("989.225")
    assert run(tmp_path, thesis(), "--front", "time", "--points", "2", "--json") == 0
    front = json.loads(capsys.readouterr().out)
    assert [set(point) >= {"x", "y", "weights", "fuel_energy_j", "verdict"} for point in front["points"]] == [
        True,
        True,
    ]
    assert run(tmp_path, thesis(), "--front", "nox") == 1
    assert "There is no map of nox among cost.emissions" in capsys.readouterr().err


def test_emissions_stand_below_the_fuel(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert run(tmp_path, thesis(cost={"weights": {"fuel": 1.0, "co2": 0.0}})) == 0
    assert "co2" in capsys.readouterr().out


@pytest.mark.parametrize(
    ("problem", "status", "words"),
    [
        (thesis(time_s=5.0), 1, "time_s: 5 s are too short by 1.669"),
        (thesis(engine={"map": "nowhere.json"}), 1, "engine.map: 'nowhere.json' is not the path of a map.json"),
        ({"kind": "fly"}, 1, "kind: 'fly' is none of"),
        ("{", 2, "is not JSON"),
    ],
)
def test_failures_are_one_line(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], problem: Any, status: int, words: str
) -> None:
    assert run(tmp_path, problem, "--json") == status
    told = capsys.readouterr()
    assert told.out == ""
    assert words in told.err
    assert told.err.count("\n") == 1


def test_a_method_by_name_and_methods_side_by_side(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert run(tmp_path, thesis(), "--method", "single_shooting", "--json") == 0
    answer = json.loads(capsys.readouterr().out)
    assert set(answer) >= NAMES
    assert answer["method"] == "single_shooting"
    assert abs(answer["certificate"]["independent"]["relative_gap"]) < 1e-9
    assert run(tmp_path, thesis(), "--compare", "--method", "pontryagin", "--method", "dp_speed") == 0
    out = capsys.readouterr().out.splitlines()
    assert out[0].split() == ["method", "fuel", "J", "time", "s", "error", "ms", "says"]
    assert [line.split()[0] for line in out[1:]] == ["pontryagin", "dp_speed"]


def test_a_method_nobody_knows_is_an_error_of_the_call(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert run(tmp_path, thesis(), "--method", "single_shotting") == 2
    assert "did you mean single_shooting?" in capsys.readouterr().err
    assert run(tmp_path, thesis(), "--method", "dp_speed", "--penalty", "1") == 1
    assert "takes no penalty" in capsys.readouterr().err
