"""The accelerometer's mounting from driving alone, on cars whose sensor lies anyhow."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from app.science.calibration.calibrate import Proposal, TripEvidence, proposals, trip_evidence
from app.science.calibration.mounting import angle_between
from app.science.calibration.propose import found_mounting
from app.science.calibration.question import Question
from app.science.observer.observe import observe
from app.science.vehicle.fields import apply_form
from app.science.vehicle.model import Mounting, Vehicle
from app.science.vehicle.xml import read_vehicle
from tests.science.calibration.virtual_trips import Virtual, drive, until

UPSIDE_DOWN = Mounting(np.pi, 0.05, 2.0, 1.0)
X_UP_Y_BACK = Mounting(-np.pi / 2.0, np.pi / 2.0, 0.0, 1.0)


def error_deg(virtual: Virtual, *evidences: TripEvidence) -> float:
    found = found_mounting(Question(evidences, virtual.vehicle, None))
    assert found is not None
    return float(np.degrees(np.linalg.norm(angle_between(found[0].mounting, virtual.vehicle.mounting))))


def proposed(evidences: list[TripEvidence], vehicle: Vehicle, name: str) -> Proposal | None:
    return next((one for one in proposals(evidences, vehicle) if one.name == name), None)


@pytest.mark.parametrize(("seed", "mounting"), [(311, None), (312, None), (313, UPSIDE_DOWN), (314, X_UP_Y_BACK)])
def test_an_hour_tells_the_mounting_within_half_a_degree(seed: int, mounting: Mounting | None) -> None:
    virtual = drive(seed, 3600.0, mounting=mounting)
    blind = replace(virtual.vehicle, mounting=Mounting())
    evidence = trip_evidence(virtual.recording, blind)
    assert error_deg(virtual, evidence) < 0.5
    found = proposed([evidence], blind, "mounting")
    assert found is not None
    assert found.confidence == "sure"
    back = read_vehicle(apply_form(b"<ponthy_config/>", found.form_values())).mounting
    assert np.degrees(np.linalg.norm(angle_between(back, virtual.vehicle.mounting))) < 0.5


@pytest.mark.parametrize("seed", [321, 322, 323])
def test_ten_minutes_tell_it_as_well_as_they_say(seed: int) -> None:
    virtual = drive(seed, 600.0)
    blind = replace(virtual.vehicle, mounting=Mounting())
    evidence = trip_evidence(virtual.recording, blind)
    found = found_mounting(Question((evidence,), blind, None))
    assert found is not None
    turn = angle_between(found[0].mounting, virtual.vehicle.mounting)
    assert np.degrees(np.linalg.norm(turn)) < 2.0
    assert float(turn @ np.linalg.solve(found[0].covariance_rad2, turn)) < 16.3  # 99.9 % of χ² with three


def test_trips_together_know_more_than_each_alone() -> None:
    mounting = Mounting(0.4, -0.2, 2.5, 1.0)
    trips = [drive(seed, 600.0, "town", mounting) for seed in (331, 332, 333)]
    evidences = [trip_evidence(trip.recording, trip.vehicle) for trip in trips]
    sds = []
    for some in (evidences[:1], evidences):
        found = found_mounting(Question(tuple(some), trips[0].vehicle, None))
        assert found is not None
        sds.append(found[0].sd_rad)
    assert sds[1] < 0.8 * sds[0]
    assert error_deg(trips[0], *evidences) < 0.6


def test_a_right_file_is_left_alone() -> None:
    virtual = drive(311, 3600.0)
    evidence = trip_evidence(virtual.recording, virtual.vehicle)
    assert [one.name for one in proposals([evidence], virtual.vehicle) if one.is_applicable] == []


def test_a_wrong_scale_is_found() -> None:
    virtual = drive(311, 3600.0)
    wrong = replace(virtual.vehicle, mounting=replace(virtual.vehicle.mounting, scale=1.1))
    found = proposed([trip_evidence(virtual.recording, wrong)], wrong, "accelerometer_scale")
    assert found is not None
    (change,) = found.changes
    assert change.after == pytest.approx(1.0, abs=3.0 * change.sd)
    assert change.sd < 0.02


def test_a_receiver_is_not_needed() -> None:
    """Without bends the right axis follows from forward, down and the level."""
    virtual = drive(311, 3600.0)
    deaf = virtual.recording.without({"lat_deg", "lon_deg", "alt_m", "heading_deg", "gnss_speed_mps", "utc_s"})
    evidence = trip_evidence(deaf, virtual.vehicle)
    assert "right" not in evidence.estimates
    assert error_deg(virtual, evidence) < 1.0


def test_evidence_survives_storage() -> None:
    evidence = trip_evidence(drive(321, 600.0).recording, Vehicle())
    assert TripEvidence.from_dict(evidence.to_dict()) == evidence


@pytest.mark.parametrize(
    ("without", "end_s", "said"),
    [
        ({"ax_mps2", "ay_mps2", "az_mps2"}, 600.0, "needs an accelerometer"),
        ({"az_mps2"}, 600.0, "three axes, this one has 2"),
        ({"vss_tick", "gnss_speed_mps"}, 600.0, "needs a speed"),
        (set(), 100.0, "needs two minutes"),
    ],
)
def test_what_is_missing_is_said(without: set[str], end_s: float, said: str) -> None:
    virtual = drive(321, 600.0)
    blind = replace(virtual.vehicle, mounting=Mounting())
    evidence = trip_evidence(until(virtual.recording, end_s).without(without), blind)
    found = proposed([evidence], blind, "mounting")
    assert found is not None
    assert (found.confidence, found.changes, found.is_applicable) == ("weak", (), False)
    assert said in found.evidence[0]


def test_three_minutes_never_say_something_wrong() -> None:
    virtual = drive(322, 600.0)
    blind = replace(virtual.vehicle, mounting=Mounting())
    evidence = trip_evidence(until(virtual.recording, 180.0), blind)
    found = proposed([evidence], blind, "mounting")
    assert found is not None
    if found.is_applicable:
        assert error_deg(virtual, evidence) < 6.0


def test_biases_are_told_once_the_mounting_is_right() -> None:
    virtual = drive(321, 600.0)
    seen = observe(virtual.recording, virtual.vehicle)
    right = [trip_evidence(virtual.recording, virtual.vehicle, seen)] * 3
    found = proposed(right, virtual.vehicle, "accelerometer_bias")
    assert found is not None
    assert [change.field for change in found.changes] == ["", "", ""]
    last = [float(seen.columns[f"bias_{axis}_mps2"][-1]) for axis in "ijk"]
    assert [change.after for change in found.changes] == pytest.approx(last, abs=1e-3)
    turned = replace(virtual.vehicle, mounting=Mounting())
    assert proposed(right, turned, "accelerometer_bias") is None
