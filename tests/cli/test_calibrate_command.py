"""``./ponthy calibrate``: proposals for people and machines, and a new file that leaves the old one alone."""

from __future__ import annotations

import json
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from app.cli.main import main
from app.science.vehicle.model import Mounting
from app.science.vehicle.xml import read_vehicle
from app.science.virtualcar.carfile import car_xml
from app.science.virtualcar.simulate import SimulatedTrip, simulate
from app.science.virtualcar.specification import Simulation


@pytest.fixture(scope="module")
def trip() -> SimulatedTrip:
    return simulate(Simulation(duration_s=900.0, seed=361, route="town"))


@pytest.fixture
def call(trip: SimulatedTrip, tmp_path: Path) -> list[str]:
    (tmp_path / "trip.dat").write_bytes(trip.image)
    blind = replace(trip.vehicle, mounting=Mounting(), vss_m_per_tick=0.25)
    (tmp_path / "car.xml").write_bytes(car_xml(blind))
    return ["calibrate", str(tmp_path / "trip.dat"), "--car", str(tmp_path / "car.xml")]


def test_people_are_told_with_evidence(call: list[str], capsys: pytest.CaptureFixture[str]) -> None:
    assert main(call) == 0
    text = capsys.readouterr().out
    assert "vss_m_per_tick: sure" in text
    assert "Mounting yaw" in text
    assert "needs the litres" in text


def test_a_new_file_is_written_and_the_old_one_kept(
    call: list[str], trip: SimulatedTrip, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    before = (tmp_path / "car.xml").read_bytes()
    new = tmp_path / "new.xml"
    assert main([*call, "--write", str(new), "--json"]) == 0
    answer = json.loads(capsys.readouterr().out)
    assert answer["trips"] == 1
    assert {one["name"] for one in answer["proposals"] if one["applicable"]} == {"mounting", "vss_m_per_tick"}
    assert (tmp_path / "car.xml").read_bytes() == before
    written = read_vehicle(new.read_bytes())
    assert written.vss_m_per_tick == pytest.approx(trip.vehicle.vss_m_per_tick, rel=0.001)
    turned = written.mounting.matrix / written.mounting.scale @ trip.vehicle.mounting.matrix.T
    cosine = (np.trace(turned / trip.vehicle.mounting.scale) - 1.0) / 2.0
    assert np.degrees(np.arccos(min(cosine, 1.0))) < 2.0


@pytest.mark.parametrize("litres", ["much", "1,2", "-3", "nan"])
def test_litres_that_fit_no_trip_are_refused(litres: str, call: list[str], capsys: pytest.CaptureFixture[str]) -> None:
    assert main([*call, f"--refuelled-l={litres}"]) == 2
    assert litres in capsys.readouterr().err
