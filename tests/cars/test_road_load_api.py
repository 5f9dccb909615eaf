"""The road load over REST: told with what it rests on, and applied only by name."""

from __future__ import annotations

import json
from datetime import UTC, datetime
from typing import Any

import pytest
from fastapi.testclient import TestClient
from sqlalchemy.orm import Session

from app.cars import service as cars
from app.science.calibration.evidence import TripEvidence
from app.storage.keys import stage_key
from app.trips.keys import EVIDENCE, ROAD_LOAD_EVIDENCE, result_file
from app.trips.models import Trip
from app.trips.road_loads import road_load_json
from tests.science.roadload.made_up import CAR, made_up
from tests.yards import Yard


@pytest.fixture
def yard(client: TestClient) -> Yard:
    """Return a fleet with a car whose file has C_rr 25 % too high, and two trips that show it."""
    yard = Yard(client.app.state.resources)  # type: ignore[attr-defined]  # the application is FastAPI's
    for number, name in enumerate(("second", "first")):
        observe(yard, yard.new_trip(name), number)
    return yard


def observe(yard: Yard, trip_id: str, number: int, verdict: str = "healthy") -> None:
    def describe(session: Session) -> None:
        trip = session.get_one(Trip, trip_id)
        config = cars.config(session, yard.car_id)
        trip.started_at = datetime(2009, 10, 27 - number, tzinfo=UTC)
        trip.observe_key, trip.verdict = stage_key("observe", trip=trip_id), verdict
        trip.provenance = {"config_sha256": config.sha256}
        steady = made_up(600, seed=number, noise_mps2=0.01)
        for name, data in (
            (EVIDENCE, json.dumps(TripEvidence().to_dict()).encode()),
            (ROAD_LOAD_EVIDENCE, road_load_json(steady, config.vehicle)),
        ):
            yard.resources.blobs.put(result_file(trip, trip.observe_key, name), data)

    yard.write(describe)


def ask(client: TestClient, yard: Yard) -> dict[str, Any]:
    answer = client.get(f"/api/v1/cars/{yard.car_id}/calibration")
    assert answer.status_code == 200, answer.text
    found: dict[str, Any] = answer.json()
    return found


def test_it_is_told_and_applied_when_asked(client: TestClient, yard: Yard) -> None:
    found = ask(client, yard)
    road = found["road_load"]
    assert road["trips"] == 2
    assert road["crr"]["file"] == 0.0125
    assert road["crr"]["value"] == pytest.approx(CAR.crr, rel=0.06)
    assert sum(share["share"] for share in road["cd_area_m2"]["shares"]) == pytest.approx(1.0)
    assert road["levels"]["after"] < road["levels"]["before"]
    (proposal,) = [one for one in found["proposals"] if one["name"] == "road_load"]
    assert proposal["confidence"] == "likely"
    body = {"names": ["road_load"], "key": found["key"]}
    done = client.post(f"/api/v1/cars/{yard.car_id}/calibration/apply", json=body)
    assert done.status_code == 202, done.text
    assert "Rolling resistance 0.0125" in done.json()["note"]
    car = client.get(f"/api/v1/cars/{yard.car_id}").json()
    assert car["vehicle"]["crr"] == pytest.approx(road["crr"]["value"], abs=1e-5)
    assert ask(client, yard)["road_load"] is None


def test_a_trip_on_which_the_observer_failed_does_not_count(client: TestClient, yard: Yard) -> None:
    observe(yard, yard.new_trip("wild"), 2, verdict="failed")
    assert ask(client, yard)["road_load"]["trips"] == 2
