"""Injector lag and flow against litres."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from app.science.calibration.calibrate import TripEvidence, proposals, trip_evidence
from app.science.calibration.fuel import fills_of
from app.science.calibration.proposal import Proposal
from app.science.errors import TooLittleData
from app.science.vehicle.model import Injection, Vehicle
from app.science.virtualcar.specification import RouteName
from tests.science.calibration.virtual_trips import drive

ROUTES: tuple[RouteName, ...] = ("town", "motorway", "mixed", "full-load", "town", "motorway")
TRIPS = [drive(350 + number, 600.0, route) for number, route in enumerate(ROUTES)]
TRUE = TRIPS[0].vehicle.injection
WRONG = replace(TRIPS[0].vehicle, injection=Injection(0.0080, -0.0007))
LITRES = [trip.fuel_l for trip in TRIPS]


@pytest.fixture(scope="module")
def evidences() -> list[TripEvidence]:
    return [trip_evidence(trip.recording, WRONG) for trip in TRIPS]


def by_name(found: tuple[Proposal, ...]) -> dict[str, Proposal]:
    return {proposal.name: proposal for proposal in found}


def test_litres_of_unlike_trips_tell_lag_and_flow(evidences: list[TripEvidence]) -> None:
    found = by_name(proposals(evidences, WRONG, LITRES))
    lag, flow = found["injector_lag"].changes
    assert (lag.field, flow.field) == ("inj/calibration@lag", "inj/calibration@fuelPerSecond")
    assert lag.after == pytest.approx(TRUE.lag_s, abs=20e-6)
    assert flow.after == pytest.approx(TRUE.litres_per_second, rel=0.002)
    assert "injector_flow" not in found


def test_noisy_litres_widen_the_uncertainty(evidences: list[TripEvidence]) -> None:
    rng = np.random.default_rng(3)
    noisy = [litres * (1.0 + 0.01 * rng.standard_normal()) for litres in LITRES]
    found = by_name(proposals(evidences, WRONG, noisy))["injector_lag"]
    if found.changes:
        assert found.changes[0].sd > 20e-6
        assert found.changes[0].after == pytest.approx(TRUE.lag_s, abs=4.0 * found.changes[0].sd)
    else:
        assert found.confidence == "weak"


def test_a_drive_alone_does_not_tell_and_that_is_said(evidences: list[TripEvidence]) -> None:
    found = by_name(proposals(evidences, WRONG))
    assert found["injector_lag"].confidence == found["injector_flow"].confidence == "weak"
    assert not found["injector_lag"].changes
    assert "needs the litres" in found["injector_lag"].evidence[0]


def test_a_tankful_tells_the_flow_with_the_lag_of_the_file(evidences: list[TripEvidence]) -> None:
    """As many trips as a tank lasts: the same ones over and over."""
    half = replace(WRONG, injection=replace(TRUE, litres_per_second=0.5 * TRUE.litres_per_second))
    found = by_name(proposals(evidences * 12, half, 12.0 * sum(LITRES)))
    (change,) = found["injector_flow"].changes
    assert change.after == pytest.approx(TRUE.litres_per_second, rel=0.01)
    assert found["injector_lag"].confidence == "weak"


def test_a_right_file_is_left_alone(evidences: list[TripEvidence]) -> None:
    right = replace(WRONG, injection=TRUE)
    assert not {"injector_lag", "injector_flow"} & by_name(proposals(evidences, right, LITRES)).keys()


def test_a_fill_pays_for_the_trips_since_the_one_before(evidences: list[TripEvidence]) -> None:
    fills = fills_of(evidences, [None, 3.0, None, None, 4.0, None])
    counts = [evidence.numbers["pulse_count"] for evidence in evidences]
    assert fills.litres.tolist() == [3.0, 4.0]
    assert fills.pulses.tolist() == [sum(counts[:2]), sum(counts[2:5])]
    assert fills.trips == 5


def test_grouped_injectors_count_per_group(evidences: list[TripEvidence]) -> None:
    grouped = replace(WRONG, injection=replace(WRONG.injection, pattern="grouped", groups=2))
    lag, flow = by_name(proposals(evidences, grouped, LITRES))["injector_lag"].changes
    assert lag.after == pytest.approx(TRUE.lag_s, abs=20e-6)
    assert flow.after == pytest.approx(2.0 * TRUE.litres_per_second, rel=0.002)


def test_without_pulses_that_is_said() -> None:
    bare = trip_evidence(TRIPS[0].recording.without({"injector_pulse_s"}), Vehicle())
    found = by_name(proposals([bare], Vehicle(), 40.0))
    assert "needs injector pulses" in found["injector_lag"].evidence[0]


def test_litres_for_other_trips_are_refused(evidences: list[TripEvidence]) -> None:
    with pytest.raises(TooLittleData, match="6 trips and litres for 2"):
        proposals(evidences, WRONG, [1.0, 2.0])
