"""``./ponthy observability``: the table of sensor losses for people and for machines."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from app.cli.main import main
from app.science.observer.states import STATE_COLUMNS
from app.science.virtualcar.carfile import car_xml
from app.science.virtualcar.specification import DEFAULT_CAR


def test_it_prints_a_table(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["observability"]) == 0
    text = capsys.readouterr().out
    assert "| no accelerometer " in text
    assert "● told" in text


def test_machines_get_json_of_their_own_car(capsys: pytest.CaptureFixture[str], tmp_path: Path) -> None:
    (tmp_path / "car.xml").write_bytes(car_xml(DEFAULT_CAR))
    assert main(["observability", "--car", str(tmp_path / "car.xml"), "--json"]) == 0
    answer = json.loads(capsys.readouterr().out)
    assert answer["states"] == list(STATE_COLUMNS)
    cases = {case["sensors"]: case for case in answer["cases"]}
    speed, bias = STATE_COLUMNS.index("speed_mps"), STATE_COLUMNS.index("bias_i_mps2")
    assert cases["no accelerometer"]["moving"][bias] == "never"
    assert (cases["all sensors"]["moving"][bias], cases["all sensors"]["standing"][bias]) == ("always", False)
    assert cases["no wheel ticks, no satellites"]["moving"][speed] == "changing"


def test_a_car_that_is_not_there_is_told(capsys: pytest.CaptureFixture[str], tmp_path: Path) -> None:
    assert main(["observability", "--car", str(tmp_path / "none.xml")]) == 2
    assert "none.xml" in capsys.readouterr().err
