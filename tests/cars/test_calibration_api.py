"""A car's calibration over REST: what its trips propose, applied when asked, and taken back."""

from __future__ import annotations

import json
from datetime import UTC, datetime
from typing import Any

import pytest
from fastapi.testclient import TestClient
from sqlalchemy.orm import Session

from app.cars import calibration as calibrations
from app.cars import service as cars
from app.science.calibration.evidence import TripEvidence
from app.science.calibration.proposal import Change, Proposal
from app.science.vehicle.model import Vehicle
from app.storage.keys import stage_key
from app.trips.calibrating import NOT_OBSERVED, NOTHING_KEPT, OTHER_FILE, TripSays
from app.trips.keys import EVIDENCE, result_file
from app.trips.models import Trip
from tests.yards import Yard

XML = b"""<?xml version="1.0" encoding="UTF-8"?>
<ponthy_config>
  <!-- mine -->
  <vss><calibration metersPerTick="0.27"/></vss>
  <radio volume="11"/>
</ponthy_config>
"""
TICK = "vss/calibration@metersPerTick"


def propose(evidences: list[TripEvidence], vehicle: Vehicle, refuelled_l: list[float | None]) -> tuple[Proposal, ...]:
    """What stands in for the science: the tick's length is 0.28 m, of the lag too little is known."""
    assert len(refuelled_l) == len(evidences) > 0
    seen = Change(TICK, "Distance per tick", "m", vehicle.vss_m_per_tick, 0.28, 0.0001)
    lag = Change("inj/lag@lag", "Injector lag", "ms", None, 0.8, 0.5)
    weak = Proposal("injector_lag", (lag,), ("Too few short pulses.",), "weak", 1)
    if vehicle.vss_m_per_tick == 0.28:
        return (weak,)
    return (Proposal("vss_m_per_tick", (seen,), ("64 km against positions.",), "sure", len(evidences)), weak)


@pytest.fixture
def yard(client: TestClient, monkeypatch: pytest.MonkeyPatch) -> Yard:
    """Return a fleet with a car, two trips that were observed with its file, and one that was not."""
    monkeypatch.setattr(calibrations, "proposals", propose)
    yard = Yard(client.app.state.resources)  # type: ignore[attr-defined]  # the application is FastAPI's
    yard.write(lambda session: cars.replace_config(session, yard.car_id, XML))
    for number, name in enumerate(("second", "first")):
        observe(yard, yard.new_trip(name), datetime(2009, 10, 27 - number, tzinfo=UTC))
    return yard


def observe(yard: Yard, trip_id: str, began: datetime, evidence: bytes | None = None) -> None:
    plain = json.dumps(TripEvidence(missing={"injector_lag": "Only long pulses."}).to_dict()).encode()

    def describe(session: Session) -> None:
        trip = session.get_one(Trip, trip_id)
        trip.started_at, trip.observe_key = began, stage_key("observe", trip=trip_id)
        config = cars.config(session, yard.car_id)
        trip.provenance = {"config_sha256": config.sha256}
        yard.resources.blobs.put(result_file(trip, trip.observe_key, EVIDENCE), evidence or plain)

    yard.write(describe)


def ask(client: TestClient, yard: Yard) -> dict[str, Any]:
    answer = client.get(f"/api/v1/cars/{yard.car_id}/calibration")
    assert answer.status_code == 200, answer.text
    found: dict[str, Any] = answer.json()
    return found


def apply(client: TestClient, yard: Yard, status: int = 202, **body: Any) -> dict[str, Any]:
    answer = client.post(f"/api/v1/cars/{yard.car_id}/calibration/apply", json=body)
    assert answer.status_code == status, answer.text
    done: dict[str, Any] = answer.json()
    return done


def test_the_trips_observed_with_the_file_in_force_propose(client: TestClient, yard: Yard) -> None:
    found = ask(client, yard)
    sure, weak = found["proposals"]
    assert (sure["name"], sure["title"], sure["applicable"]) == ("vss_m_per_tick", "Metres per wheel tick", True)
    change = {"field": TICK, "label": "Distance per tick", "unit": "m", "before": 0.27, "after": 0.28, "sd": 0.0001}
    assert sure["changes"] == [change]
    assert (sure["confidence"], sure["evidence"], sure["trips"]) == ("sure", ["64 km against positions."], 2)
    assert (weak["confidence"], weak["applicable"], weak["changes"][0]["before"]) == ("weak", False, None)
    said = [(trip["name"], trip["counts"], trip["why"]) for trip in found["trips"]]
    assert said == [("first", True, ""), ("second", True, ""), ("trip", False, NOT_OBSERVED)]
    assert found["trips"][0]["missing"] == {"injector_lag": "Only long pulses."}
    assert client.get(f"/api/v1/cars/{yard.car_id}/config").content == XML


def test_a_car_without_trips_that_count_gets_no_proposals(client: TestClient, yard: Yard) -> None:
    yard.write(lambda session: cars.replace_config(session, yard.car_id, XML.replace(b"0.27", b"0.3")))
    found = ask(client, yard)
    assert found["proposals"] == []
    assert [trip["why"] for trip in found["trips"]] == [OTHER_FILE, OTHER_FILE, NOT_OBSERVED]


def test_evidence_of_an_earlier_version_is_not_believed(client: TestClient, yard: Yard) -> None:
    trip_id = yard.new_trip("old")
    observe(yard, trip_id, datetime(2009, 10, 1, tzinfo=UTC), b'{"something": "else"}')
    found = ask(client, yard)["trips"][0]
    assert (found["name"], found["counts"], found["why"]) == ("old", False, NOTHING_KEPT)


def test_applying_writes_a_revision_with_its_origin_and_runs_all_trips_again(client: TestClient, yard: Yard) -> None:
    done = apply(client, yard, names=["vss_m_per_tick"], key=ask(client, yard)["key"])
    assert done["revision"] == 3
    assert len(done["jobs"]) == 3
    assert [job["trip_id"] for job in done["jobs"]][:2] == [trip["trip_id"] for trip in ask(client, yard)["trips"]][:2]
    url = f"/api/v1/cars/{yard.car_id}/config"
    assert client.get(url).content == XML.replace(b"0.27", b"0.28")
    newest = client.get(f"{url}/revisions").json()["items"][0]
    assert newest["note"] == done["note"]
    assert newest["note"] == "Calibrated from 2 trips: Distance per tick 0.27000 → 0.28000 ± 0.00010 m"


@pytest.mark.parametrize("names", [["injector_lag"], ["mounting"], ["vss_m_per_tick", "nonsense"], []])
def test_only_what_is_proposed_and_sure_enough_is_applied(client: TestClient, yard: Yard, names: list[str]) -> None:
    apply(client, yard, 422, names=names)
    assert client.get(f"/api/v1/cars/{yard.car_id}/config").content == XML
    assert client.get("/api/v1/jobs").json()["items"] == []


def test_what_has_changed_since_it_was_looked_at_is_not_applied(client: TestClient, yard: Yard) -> None:
    key = ask(client, yard)["key"]
    client.patch(f"/api/v1/cars/{yard.car_id}", json={"load_kg": 300})
    assert apply(client, yard, 409, names=["vss_m_per_tick"], key=key)["code"] == "calibration-changed"
    assert client.get(f"/api/v1/cars/{yard.car_id}/config").content == XML


def test_an_older_file_is_put_in_force_again(client: TestClient, yard: Yard) -> None:
    apply(client, yard, names=["vss_m_per_tick"])
    url = f"/api/v1/cars/{yard.car_id}/config"
    assert client.post(f"{url}/revisions/2/restore").json()["config_revision"] == 4
    assert client.get(url).content == XML
    assert client.get(f"{url}/revisions").json()["items"][0]["note"] == "Revision 2 again"
    assert client.post(f"{url}/revisions/9/restore").status_code == 404


def test_a_filling_is_noted_with_its_trip(client: TestClient, yard: Yard) -> None:
    url = f"/api/v1/trips/{yard.trip_id}"
    assert client.patch(url, json={"refuelled_l": 31.4}).json()["refuelled_l"] == 31.4
    assert client.patch(url, json={"notes": "x"}).json()["refuelled_l"] == 31.4
    assert ask(client, yard)["trips"][-1]["refuelled_l"] == 31.4
    assert client.patch(url, json={"refuelled_l": -1}).status_code == 422
    assert client.patch(url, json={"refuelled_l": 0}).json()["refuelled_l"] is None


def says(refuelled_l: float | None = None, *, known: bool = True) -> TripSays:
    return TripSays("1", "a", None, refuelled_l, TripEvidence(numbers={"pulse_count": 9.0}) if known else None, "")


@pytest.mark.parametrize(
    ("driven", "litres", "counted"),
    [
        ([says(), says(20.0)], [None, None], [False, False]),  # nobody knows how full the tank was before
        ([says(20.0), says(), says(30.0), says()], [None, None, 30.0, None], [False, True, True, True]),
        ([says(20.0), says(known=False), says(30.0), says(10.0)], [None, None, 10.0], [False, False, True]),
        ([says(20.0), says(9.0, known=False), says(), says(8.0)], [None, None, 8.0], [False, True, True]),
        ([says(), says()], [None, None], [True, True]),
    ],
    ids=["first filling", "second filling", "unknown trip", "filling after an unknown trip", "no filling"],
)
def test_a_filling_pays_for_the_trips_since_the_one_before(
    driven: list[TripSays], litres: list[float | None], counted: list[bool]
) -> None:
    evidences, given = calibrations.tanks(driven)
    assert given == litres
    assert ["pulse_count" in evidence.numbers for evidence in evidences] == counted
