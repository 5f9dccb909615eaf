"""The road load as a proposal: made when it differs, with the efficiency before and after, and never by itself."""

from __future__ import annotations

from dataclasses import replace

import pytest

from app.science.roadload.evidence import trip_evidence
from app.science.roadload.identify import identify
from app.science.roadload.propose import road_load_proposal
from app.science.vehicle.fields import apply_form
from app.science.vehicle.xml import read_vehicle
from app.science.virtualcar.carfile import car_xml
from tests.science.roadload.made_up import CAR, made_up, told


def test_a_wrong_file_is_to_be_changed_and_the_frontal_area_kept() -> None:
    file = told(1.3, 0.7)
    evidence = trip_evidence(made_up(noise_mps2=0.02), file, "fuel")
    assert evidence is not None
    proposal = road_load_proposal(identify([evidence], file), file)
    assert proposal is not None
    assert proposal.confidence == "likely"
    assert [one.field for one in proposal.changes] == ["drag/aero@Cd", "drag/rolling@Crr"]
    changed = read_vehicle(apply_form(car_xml(file), proposal.form_values()))
    assert changed.cd == pytest.approx(CAR.cd, rel=0.02)
    assert changed.crr == pytest.approx(CAR.crr, rel=0.05)
    assert changed.frontal_area_m2 == CAR.frontal_area_m2
    text = " ".join(proposal.evidence)
    assert "efficiency over all that was driven goes from" in text
    assert "best point" in text


def test_a_right_file_is_left_alone() -> None:
    evidence = trip_evidence(made_up(noise_mps2=0.02), CAR, "fuel")
    assert evidence is not None
    assert road_load_proposal(identify([evidence], CAR), CAR) is None


def test_what_cannot_be_told_is_not_proposed() -> None:
    assert road_load_proposal(identify([], CAR), CAR) is None


def test_a_resistance_that_pushes_is_not_proposed() -> None:
    file = told(1.3, 0.7)
    evidence = trip_evidence(made_up(), file, "fuel")
    assert evidence is not None
    found = identify([evidence], file)
    assert road_load_proposal(found, file) is not None
    assert road_load_proposal(replace(found, crr=replace(found.crr, value=-0.002)), file) is None
