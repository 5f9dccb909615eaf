"""Scores over REST: of a trip, its figures, of a car, and the fleet's ranking."""

from __future__ import annotations

from typing import Any

import pytest
from fastapi.testclient import TestClient

from app.accounts.models import DEFAULT_FLEET_ID as FLEET
from app.eco import service
from app.science.eco.result import Along
from app.storage.database import Database
from tests.eco.conftest import BEGINS_S, ROWS, Ledger

FIGURES = ("along", "parts", "cells", "accelerations", "place")


def of(trip_id: str, rest: str = "/score") -> str:
    return f"/api/v1/trips/{trip_id}{rest}"


def test_a_trip_tells_its_score_with_all_that_led_to_it(client: TestClient, ledger: Ledger) -> None:
    trip_id = ledger.drive("86")
    ledger.score(trip_id)
    ledger.new_map(2)
    said = client.get(of(trip_id)).json()
    assert said["score"] == {"value": 86.0, "sd": 2.0}
    assert said["saved_l"]["value"] == pytest.approx(0.28)
    assert [part["name"] for part in said["parts"]] == ["braking", "working_points", "rest"]
    assert (said["map_version"], said["newest_map_version"]) == (1, 2)
    assert said["table"][1] == {"style": "Best in the same time", "energy_kj": 350.0, "percent": -12.5}
    assert said["provenance"]["map_version"] == 1
    assert said["scored_at"].endswith("Z")


def test_a_trip_without_a_score_says_why(client: TestClient, ledger: Ledger) -> None:
    waiting, failed = ledger.drive("86"), ledger.drive("70", verdict="failed")
    ledger.score(failed)
    answers = [client.get(of(trip_id)) for trip_id in (waiting, failed)]
    assert [(answer.status_code, answer.json()["code"]) for answer in answers] == [
        (409, "not-scored"),
        (409, "no-score"),
    ]
    assert answers[0].json()["detail"] == service.NOT_YET
    assert "observer failed" in answers[1].json()["detail"]
    assert client.get(of("0" * 32)).status_code == 404


def test_every_figure_is_drawn_once_there_is_a_score(client: TestClient, ledger: Ledger) -> None:
    trip_id = ledger.drive("86")
    assert client.get(of(trip_id, "/figures/score-along")).json()["code"] == "not-scored"
    ledger.score(trip_id)
    for name in FIGURES:
        drawn = client.get(of(trip_id, f"/figures/score-{name}"), params={"theme": "dark"}).json()
        assert drawn["data"] or "could be compared" in drawn["layout"]["annotations"][0]["text"], name
    assert client.get(of(trip_id, "/figures/score-nothing")).status_code == 422


def test_the_way_is_drawn_where_the_car_was(client: TestClient, ledger: Ledger) -> None:
    trip_id = ledger.drive("86")
    ledger.score(trip_id)
    (way,) = client.get(of(trip_id, "/figures/score-place")).json()["data"]
    assert (len(way["lat"]), way["customdata"][0]) == (ROWS, BEGINS_S)
    assert way["lat"][0] == pytest.approx(49.0 + 0.1 * BEGINS_S / 110.0, abs=1e-6)
    plan = client.get(of(trip_id, "/figures/score-place"), params={"variant": "plan"}).json()
    assert plan["layout"]["annotations"][0]["text"] == "No position is known for this trip."


def test_both_drives_along_the_road_come_column_by_column(client: TestClient, ledger: Ledger) -> None:
    trip_id = ledger.drive("86")
    ledger.score(trip_id)
    some = client.get(of(trip_id, "/score/along"), params={"columns": "best_speed_mps, best_costate"}).json()
    assert some == {"best_speed_mps": [9.0] * ROWS, "best_costate": [None] * ROWS}
    assert len(client.get(of(trip_id, "/score/along")).json()) == len(Along.__dataclass_fields__)
    wrong = client.get(of(trip_id, "/score/along"), params={"columns": "speed"})
    assert (wrong.status_code, wrong.json()["code"]) == (422, "unknown-column")


def test_a_trip_is_played_with_a_target_where_it_has_one(client: TestClient, ledger: Ledger) -> None:
    trip_id = ledger.drive("86")
    assert "thrust_n" in client.get(of(trip_id, "/dashboard")).json()["detail"]
    told = ledger.measured(trip_id)
    before = client.get(of(trip_id, "/dashboard")).json()
    assert before["reason"] == service.NOT_YET
    assert set(before["columns"]["target_mps"]) == {None}
    ledger.score(trip_id)
    played = client.get(of(trip_id, "/dashboard")).json()
    at = played["columns"]["t_s"].index(2.0 * BEGINS_S)
    assert (played["reason"], played["map_version"]) == ("", 1)
    assert (played["columns"]["speed_mps"][at], played["columns"]["target_mps"][at]) == (10.0, 9.0)
    assert played["columns"]["efficiency"][at] == pytest.approx(told["thrust_n"][0] * 10.0 / told["fuel_power_w"][0])


def test_scoring_again_is_a_job_that_leaves_the_trip_as_it_is(client: TestClient, ledger: Ledger) -> None:
    trip_id = ledger.drive("86")
    job = client.post(of(trip_id)).json()
    assert (job["kind"], [stage["name"] for stage in job["stages"]]) == ("score", ["score"])
    assert client.post(of(trip_id)).json()["id"] == job["id"]
    trip = client.get(of(trip_id, "")).json()
    assert (trip["state"], trip["job_id"]) == ("ready", None)
    assert client.post(of(ledger.new_trip("raw"))).json()["code"] == "not-observed"


def test_a_trip_that_is_worked_on_is_scored_in_the_end_anyway(client: TestClient, ledger: Ledger) -> None:
    trip_id = ledger.drive("86")
    ledger.new_job(trip_id)
    answer = client.post(of(trip_id))
    assert (answer.status_code, answer.json()["code"]) == (409, "trip-busy")


def test_the_trips_of_a_car_that_rest_on_an_older_map_are_scored_anew(client: TestClient, ledger: Ledger) -> None:
    ledger.score(ledger.drive("86"))
    ledger.new_map(2)
    ledger.score(ledger.drive("87"))
    ledger.drive("88")
    ledger.new_job(ledger.drive("89"))
    asked = client.post(f"/api/v1/cars/{ledger.car_id}/score").json()["items"]
    assert [job["title"] for job in asked] == ["Score of 86", "Score of 88"]


def test_a_cars_score_weighs_its_trips_by_their_fuel(client: TestClient, ledger: Ledger) -> None:
    for name in ("86", "90", "70 failed"):
        ledger.score(ledger.drive(name, verdict="failed" if "failed" in name else "healthy"))
    waiting = ledger.drive("80")
    said = client.get(f"/api/v1/cars/{ledger.car_id}/score").json()
    assert said["score"] == pytest.approx(88.0)
    assert said["score_sd"] == pytest.approx(2.0)
    assert (said["fuel_l"], said["saved_l"]) == (pytest.approx(4.0), pytest.approx(0.48))
    assert [trip["score"] for trip in said["trips"]] == [86.0, 90.0, None, None]
    assert [bool(trip["reason"]) for trip in said["trips"]] == [False, False, True, True]
    assert said["trips"][3]["trip_id"] == waiting
    assert said["advice_trip_id"] == said["trips"][1]["trip_id"]
    assert said["advice"] == ["Shift up at 2500 rpm instead of 3400: 0.12 L"]


def test_a_car_without_scores_says_what_to_do(client: TestClient, ledger: Ledger) -> None:
    said = client.get(f"/api/v1/cars/{ledger.car_id}/score").json()
    assert (said["score"], said["trips"]) == (None, [])
    assert "has been scored yet" in said["reason"]
    ledger.score(ledger.drive("70", verdict="failed"))
    assert "could be scored" in client.get(f"/api/v1/cars/{ledger.car_id}/score").json()["reason"]


@pytest.fixture
def fleet(ledger: Ledger) -> Ledger:
    """Three cars, the second the best."""
    for car, scores in (("first", ("80", "82")), ("second", ("95",)), ("third", ("70", "95", "95"))):
        ledger.another_car(car)
        ledger.new_map(1)
        for score in scores:
            ledger.score(ledger.drive(f"{score} {car}"))
    ledger.score(ledger.drive("50 failed", verdict="failed"))
    return ledger


def pages(client: TestClient, **wanted: Any) -> list[dict[str, Any]]:
    found: list[dict[str, Any]] = []
    cursor = None
    while True:
        page = client.get("/api/v1/scores", params=wanted | ({"cursor": cursor} if cursor else {})).json()
        found += page["items"]
        cursor = page["next_cursor"]
        if cursor is None:
            return found


def test_cars_are_ranked_the_best_driven_first(client: TestClient, fleet: Ledger) -> None:
    ranked = pages(client, limit=2)
    assert [(one["car_name"], round(one["score"], 3), one["trips"]) for one in ranked] == [
        ("second", 95.0, 1),
        ("third", 86.667, 3),
        ("first", 81.0, 2),
    ]
    assert ranked[0]["trip_id"] is None


def test_trips_are_ranked_and_paged_even_where_they_are_equal(client: TestClient, fleet: Ledger) -> None:
    ranked = pages(client, by="trip", limit=2)
    assert [round(one["score"], 3) for one in ranked] == [95.0, 95.0, 95.0, 82.0, 80.0, 70.0]
    assert len({one["trip_id"] for one in ranked}) == 6
    assert ranked[-1]["trip_name"] == "70 third"
    assert ranked[-1]["car_name"] == "third"


def test_a_cursor_of_another_list_is_refused(client: TestClient, fleet: Ledger) -> None:
    assert client.get("/api/v1/scores", params={"cursor": "bm9wZQ"}).status_code == 422


def test_a_deleted_trip_takes_its_score_with_it(client: TestClient, fleet: Ledger) -> None:
    best = pages(client, by="trip")[0]["trip_id"]
    assert client.delete(of(best, "")).status_code == 204
    assert best not in [one["trip_id"] for one in pages(client, by="trip")]
    database: Database = fleet.resources.database
    with database.transaction(FLEET, read_only=True) as session:
        assert service.repository.row(session, best) is None
