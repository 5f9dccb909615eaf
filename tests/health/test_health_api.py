"""A car's health over REST: its state, its figures, what was told and who has seen it."""

from __future__ import annotations

from typing import Any

import pytest
from fastapi.testclient import TestClient

from app.accounts.models import DEFAULT_FLEET_ID as FLEET
from app.cars import service as cars
from app.health.models import Assessment
from app.jobs import service as jobs
from app.science.engine.idle import IdleSums
from app.trips.keys import IDLE
from app.trips.models import Trip
from tests.health.conftest import SOFT, Garage


@pytest.fixture
def changed(garage: Garage) -> Garage:
    """Return a car whose last two trips had a soft tyre."""
    for name in ("one", "two", "soft", "soft, too"):
        garage.drive(name)
    garage.assess()
    return garage


def of(garage: Garage, rest: str = "") -> str:
    return f"/api/v1/cars/{garage.car_id}/health{rest}"


def the_alert(client: TestClient, **query: Any) -> dict[str, Any]:
    (alert,) = client.get("/api/v1/alerts", params=query).json()["items"]
    return dict(alert)


def test_a_car_that_was_never_assessed_says_what_is_needed(client: TestClient, garage: Garage) -> None:
    said = client.get(of(garage)).json()
    assert (said["state"], said["alerts"], said["trends"], said["assessed_at"]) == ("unknown", [], [], None)
    assert "run again" in said["reason"]
    figure = client.get(of(garage, "/figures/mass")).json()
    assert figure["layout"]["annotations"][0]["text"] == "Too few trips yet to say what is usual."


def test_a_changed_car_tells_what_since_when_and_what_to_look_at(client: TestClient, changed: Garage) -> None:
    said = client.get(of(changed)).json()
    assert (said["state"], said["false_alarms_per_200_trips"], said["baseline_trips"]) == ("alert", 0.1, 2)
    (alert,) = said["alerts"]
    assert alert["words"] == "Rolling resistance 20 % above its usual, since 2 trips"
    assert (alert["advice"], alert["car_name"], alert["since_at"]) == ("Check tyres.", "car", "2026-03-03T08:00:00Z")
    (trend,) = said["trends"]
    assert trend["estimate"] == [0.0, 0.0, SOFT, SOFT]
    assert [trip["role"] for trip in said["trips"]] == ["watched"] * 4
    assert said["trips"][0]["started_at"] == "2026-03-01T08:00:00Z"


def test_the_trend_is_drawn_with_its_change_marked(client: TestClient, changed: Garage) -> None:
    figure = client.get(of(changed, "/figures/rolling_resistance"), params={"theme": "dark"}).json()
    trips = figure["data"][-1]
    assert trips["y"] == [0, 0, SOFT, SOFT]
    assert trips["marker"]["symbol"] == ["circle", "circle", "square", "square"]
    assert [row[0] for row in trips["customdata"]] == client.get(of(changed)).json()["trends"][0]["trip_ids"]
    assert [note["x"] for note in figure["layout"]["annotations"]] == [2.5]
    assert client.get(of(changed, "/figures/colour")).status_code == 422


def test_idling_is_told_trip_by_trip_and_drawn(client: TestClient, changed: Garage) -> None:
    watts, seconds = 8000.0, 40.0
    sums = IdleSums(seconds, 850 * seconds, 850**2 * seconds, watts * seconds, (watts**2 + 400.0**2) * seconds)
    trip_id = changed.drive("standing")
    changed.write(lambda session: setattr(session.get_one(Trip, trip_id), "summary", {IDLE: sums.to_dict()}))
    with changed.resources.database.transaction(FLEET, read_only=True) as session:
        litres = 3600.0 * watts / cars.config(session, changed.car_id).vehicle.fuel_energy_j_per_l
    (idle,) = client.get(of(changed)).json()["idle"]
    assert idle == {"trip_id": trip_id, "name": "standing", "litres_per_hour": litres, "rpm": 850.0, "seconds": 40.0}
    (trace,) = client.get(of(changed, "/figures/idle")).json()["data"]
    assert trace["y"] == [pytest.approx(litres, abs=1e-3)]
    assert trace["error_y"]["array"] == [pytest.approx(litres * 400.0 / watts, abs=1e-3)]
    assert trace["customdata"][0][1:] == ["standing, 5 Mar 2026", "40", "850"]


def test_alerts_of_the_fleet_are_listed_by_state_and_car(client: TestClient, changed: Garage) -> None:
    alert = the_alert(client)
    assert the_alert(client, car_id=changed.car_id, state="open") == alert
    assert client.get("/api/v1/alerts", params={"state": "cleared"}).json()["items"] == []
    assert client.get("/api/v1/alerts", params={"car_id": "0" * 32}).json()["items"] == []
    seen = client.post(of(changed, f"/alerts/{alert['id']}/seen"))
    assert (seen.status_code, seen.json()["state"], seen.json()["seen_by"]) == (200, "seen", None)
    assert client.post(of(changed, f"/alerts/{alert['id']}/seen")).json() == seen.json()
    assert the_alert(client)["state"] == "seen"
    changed.drive("soft again")
    changed.assess()
    assert (the_alert(client)["state"], the_alert(client)["trips"]) == ("seen", 3)
    assert client.post(of(changed, f"/alerts/{'0' * 32}/seen")).status_code == 404


def test_a_new_usual_has_the_car_assessed_anew(client: TestClient, changed: Garage) -> None:
    began = the_alert(client)["since_at"]
    set_anew = client.post(of(changed, "/usual"), json={})
    assert (set_anew.status_code, set_anew.json()["usual_since"]) == (202, began)
    assert changed.job(set_anew.json()["job_id"]).title == "New usual of car"
    assert client.get("/api/v1/alerts").json()["items"] == []
    assert client.get(of(changed)).json()["usual_since"] == began
    back = client.delete(of(changed, "/usual"))
    assert (back.status_code, back.json()["usual_since"]) == (202, None)
    with changed.resources.database.transaction(FLEET, read_only=True) as session:
        stages = [stage.name for stage in jobs.get(session, back.json()["job_id"]).stages]
    assert stages == ["map", "health"]


@pytest.mark.parametrize(
    ("body", "code"),
    [
        ({"since_trip_id": "0" * 32}, "not-a-trip-of-the-car"),
        ({"since": "2999-01-01T00:00:00Z"}, "impossible-time"),
        ({"since": "0001-01-01T00:00:00+23:00"}, "impossible-time"),
        ({"since": "2026-01-01T00:00:00"}, None),
    ],
)
def test_a_usual_that_can_not_be_is_refused(
    client: TestClient, changed: Garage, body: dict[str, str], code: str | None
) -> None:
    refused = client.post(of(changed, "/usual"), json=body)
    assert refused.status_code == 422
    assert code is None or refused.json()["code"] == code
    assert the_alert(client)["state"] == "open"


def test_an_assessment_of_another_version_is_not_guessed_at(client: TestClient, changed: Garage) -> None:
    def older(session: Any) -> None:
        session.get_one(Assessment, changed.car_id).document = {"trips": [], "verdict": "fine"}

    changed.write(older)
    said = client.get(of(changed)).json()
    assert (said["trends"], said["assessed_at"]) == ([], None)
    assert said["state"] == "alert"
