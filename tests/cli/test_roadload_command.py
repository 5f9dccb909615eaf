"""``./ponthy roadload``: the road load for people and machines, of a virtual car whose file is wrong."""

from __future__ import annotations

import json
from dataclasses import replace
from pathlib import Path

import pytest

from app.cli.main import main
from app.science.virtualcar.carfile import car_xml
from app.science.virtualcar.simulate import SimulatedTrip, simulate
from app.science.virtualcar.specification import Simulation


@pytest.fixture(scope="module")
def trip() -> SimulatedTrip:
    return simulate(Simulation(duration_s=1800.0, seed=362))


@pytest.fixture
def call(trip: SimulatedTrip, tmp_path: Path) -> list[str]:
    (tmp_path / "trip.dat").write_bytes(trip.image)
    (tmp_path / "roads.csv").write_bytes(trip.elevation_csv)
    (tmp_path / "car.xml").write_bytes(car_xml(replace(trip.vehicle, cd=1.3 * trip.vehicle.cd)))
    return ["roadload", str(tmp_path / "trip.dat"), "--car", str(tmp_path / "car.xml")]


def test_people_are_told_what_rests_on_what(call: list[str], capsys: pytest.CaptureFixture[str]) -> None:
    assert main(call) == 0
    text = capsys.readouterr().out
    assert "C_d·A" in text
    assert "efficiency of all driving" in text
    assert "The mass rests on the car's file" in text


def test_machines_get_the_same_and_the_elevations_are_used(
    call: list[str], trip: SimulatedTrip, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main([*call, "--elevation", str(tmp_path / "roads.csv"), "--json"]) == 0
    answer = json.loads(capsys.readouterr().out)
    true = trip.vehicle.cd * trip.vehicle.frontal_area_m2
    assert answer["cd_area_m2"]["file"] == pytest.approx(1.3 * true, rel=1e-6)
    assert answer["cd_area_m2"]["value"] == pytest.approx(true, rel=0.08)
    assert answer["mass_kg"]["identified"] is False
    assert answer["levels"]["before"] > answer["levels"]["after"]
    assert {share["source"] for share in answer["crr"]["shares"]} == {
        "prior", "coasting", "gravity", "acceleration", "cruising",
    }  # fmt: skip
