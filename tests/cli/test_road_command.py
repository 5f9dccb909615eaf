"""``./ponthy road`` and ``./ponthy pose``: files in, a problem out that ``./ponthy drive`` takes."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from app.cli.main import main
from app.science.optimal.problem import Route
from app.science.optimal.reading import read_problem
from app.science.vehicle.xml import new_car_xml
from tests.science.optimal.posing.test_car import map_of_table_4_1

TABLE = "distance_m,elevation_m,speed_limit_kmh\n0,100,50\n600,112,80\n2000,90,80\n"
GEARS = {f"transmission/{name}@gear": ratio for name, ratio in (("first", 13.25), ("second", 7.37), ("third", 4.208))}


def test_a_table_a_car_and_its_map_become_a_route(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    (tmp_path / "table.csv").write_text(TABLE)
    (tmp_path / "car.xml").write_bytes(new_car_xml(GEARS))
    (tmp_path / "map.json").write_text(json.dumps(map_of_table_4_1()))
    assert main(["road", str(tmp_path / "table.csv"), "--out", str(tmp_path / "road.json"), "--json"]) == 0
    told = json.loads(capsys.readouterr().out)
    assert told["length_m"] == 2000.0
    assert json.loads((tmp_path / "road.json").read_text()) == told["road"]
    call = ["pose", str(tmp_path / "car.xml"), str(tmp_path / "map.json"), "--road", str(tmp_path / "road.json")]
    assert main([*call, "--from", "40", "--max-time", "140", "--out", str(tmp_path / "problem.json")]) == 0
    assert "one accelerated mass" in capsys.readouterr().err
    problem = read_problem(json.loads((tmp_path / "problem.json").read_text()))
    assert isinstance(problem, Route)
    assert problem.transmission.ratios == (13.25, 7.37, 4.208)
    assert problem.from_speed_mps == pytest.approx(40.0 / 3.6)
    assert problem.max_time_s == 140.0


def test_a_cycle_is_offered_by_its_parts(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    speeds = [0, 5, 10, 10, 5, 0, 0, 5, 8, 8, 8, 5, 0]
    (tmp_path / "cycle.csv").write_text("time_s,speed_mps\n" + "\n".join(f"{k},{v}" for k, v in enumerate(speeds)))
    assert main(["road", str(tmp_path / "cycle.csv")]) == 0
    assert "of 2" in capsys.readouterr().out
    assert main(["road", str(tmp_path / "cycle.csv"), "--part", "3"]) == 2
    assert "the cycle has 2 parts between its stops" in capsys.readouterr().err


def test_a_cycle_is_posed_as_it_was_driven(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    (tmp_path / "cycle.csv").write_text(
        "time_s,speed_mps\n" + "\n".join(f"{k},{min(k, 20, 60 - k)}" for k in range(61))
    )
    (tmp_path / "car.xml").write_bytes(new_car_xml(GEARS))
    (tmp_path / "map.json").write_text(json.dumps(map_of_table_4_1()))
    assert main(["road", str(tmp_path / "cycle.csv"), "--json"]) == 0
    (tmp_path / "road.json").write_text(capsys.readouterr().out)
    call = ["pose", str(tmp_path / "car.xml"), str(tmp_path / "map.json"), "--road", str(tmp_path / "road.json")]
    assert main(call) == 0
    problem = read_problem(json.loads(capsys.readouterr().out))
    assert isinstance(problem, Route)
    assert (problem.from_speed_mps, problem.to_speed_mps, problem.max_time_s) == (3.0, 3.0, 54.0)


def test_what_is_no_road_is_said_in_one_line(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    (tmp_path / "gap.csv").write_text(TABLE.replace("2000", "9000"))
    assert main(["road", str(tmp_path / "gap.csv")]) == 1
    told = capsys.readouterr()
    assert told.out == ""
    assert "From 600 m to 9000 m the road has no points for 8400 m" in told.err
