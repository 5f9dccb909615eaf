"""Versions, cars and periods beside each other, and what each version says of the one before."""

from __future__ import annotations

from dataclasses import replace
from datetime import UTC, datetime
from typing import Any

import pytest
from fastapi.testclient import TestClient

from app.accounts.models import DEFAULT_FLEET_ID as FLEET
from app.maps.updating import update
from app.science.engine.points import OperatingPoints
from app.storage.base import new_id
from app.trips import repository as trip_rows
from tests.synthetic import drive, random_points
from tests.yards import Yard, silent

OBSERVATION = drive(seconds=60.0)


def worked(seed: int, factor: float = 1.0) -> OperatingPoints:
    """Points of an engine that does so much more work with its fuel."""
    points = random_points(30_000, seed)
    return replace(points, power_w=factor * points.power_w, efficiency=factor * points.efficiency)


def driven(yard: Yard, name: str, points: OperatingPoints, month: int = 1, verdict: str = "healthy") -> str:
    """Add a trip and bring the map up to date."""
    trip_id = yard.observed(name, OBSERVATION, points)

    def describe(session: Any) -> None:
        trip = trip_rows.trip(session, trip_id)
        assert trip is not None
        trip.started_at = datetime(2026, month, 15, tzinfo=UTC)
        trip.verdict = verdict

    yard.write(describe)
    renewed(yard)
    return trip_id


def renewed(yard: Yard) -> None:
    yard.write(update(yard.resources, FLEET, yard.car_id, silent))


def compared(client: TestClient, yard: Yard, first: str, second: str = "latest") -> dict[str, Any]:
    answer = client.get(f"/api/v1/cars/{yard.car_id}/maps/compare", params={"first": first, "second": second})
    assert answer.status_code == 200, answer.text
    document: dict[str, Any] = answer.json()
    return document


def versions(client: TestClient, yard: Yard) -> list[dict[str, Any]]:
    listed: list[dict[str, Any]] = client.get(f"/api/v1/cars/{yard.car_id}/maps").json()["items"]
    return listed


def test_two_versions_tell_what_a_trip_changed(client: TestClient, yard: Yard) -> None:
    driven(yard, "one", worked(1))
    driven(yard, "two", worked(2))
    driven(yard, "worse", worked(3, 0.9))
    same = compared(client, yard, "1", "2")
    assert same["changed_cells"] == 0
    assert same["trips_in_both"] == 1
    assert "same as far as can be told" in same["words"][0]
    worse = compared(client, yard, "2")
    assert worse["level"] == pytest.approx(1.0 - 0.1 / 3.0, abs=0.003)
    assert (worse["first"]["title"], worse["second"]["version"]) == ("version 2", 3)
    assert {"rpm", "nm", "first", "second", "difference", "sd", "significant"} == worse["cells"][0].keys()


def test_two_periods_and_two_cars_are_compared(client: TestClient, yard: Yard) -> None:
    for month in (1, 2):
        driven(yard, f"winter {month}", worked(month), month)
    for month in (7, 8):
        driven(yard, f"summer {month}", worked(month, 1.06), month)
    found = compared(client, yard, "..2026-03-31", "2026-04-01..")
    assert found["level"] == pytest.approx(1.06, abs=0.003)
    assert found["level_changed"]
    assert found["changed_cells"] == found["better_cells"] > 0.9 * found["common_cells"]
    assert found["first"]["title"] == "until 31 Mar 2026"
    other = Yard(yard.resources)
    driven(other, "another car", worked(9))
    between = compared(client, yard, f"{other.car_id}:latest", "2026-07-01..2026-08-31")
    assert between["level"] == pytest.approx(1.06, abs=0.003)
    assert (between["first"]["car_id"], between["second"]["trips"]) == (other.car_id, 2)


def test_the_figure_shows_what_is_more_than_chance(client: TestClient, yard: Yard) -> None:
    driven(yard, "one", worked(1), 1)
    driven(yard, "two", worked(2, 0.8), 2)
    query = {"first": "..2026-01-31", "second": "2026-02-01..", "theme": "dark"}
    figure = client.get(f"/api/v1/cars/{yard.car_id}/maps/compare/figures/difference", params=query).json()
    assert figure["layout"]["meta"]["changed_cells"] > 300
    sure = next(trace for trace in figure["data"] if trace["name"] == "more than chance")
    values = [z for row in sure["z"] for z in row if z is not None]
    assert len(values) == figure["layout"]["meta"]["changed_cells"]
    assert max(values) < 0.0


def test_trips_that_ran_again_are_compared_by_the_maps_alone(client: TestClient, yard: Yard) -> None:
    trip_id = driven(yard, "one", worked(1))
    driven(yard, "two", worked(2))
    again = yard.trip(driven(yard, "again", worked(3)))

    def take_over(session: Any) -> None:
        session.delete(trip_rows.trip(session, again.id))
        trip = trip_rows.trip(session, trip_id)
        assert trip is not None
        trip.observe_key = again.observe_key

    blobs = yard.resources.blobs
    place = f"fleets/{FLEET}/trips/{{}}/{again.observe_key}/operating_points.parquet"
    blobs.put(place.format(trip_id), blobs.get(place.format(again.id)))
    yard.write(take_over)
    renewed(yard)
    found = compared(client, yard, "2", "latest")
    assert found["trip_sd"] is None
    assert any("run again or removed" in text for text in found["words"])
    changes = versions(client, yard)[0]["changes"]
    assert [trip["name"] for trip in changes["observed_anew"]] == ["one"]
    assert [trip["name"] for trip in changes["removed"]] == ["again"]
    assert changes["level"] == pytest.approx(1.0, abs=0.01)


def test_each_version_tells_what_changed(client: TestClient, yard: Yard) -> None:
    driven(yard, "one", worked(1))
    trip_id = driven(yard, "two", worked(2, 0.9))
    client.patch(f"/api/v1/trips/{trip_id}", json={"in_map": False})
    renewed(yard)
    third, second, first = versions(client, yard)
    assert first["changes"] is None
    assert [trip["name"] for trip in second["changes"]["added"]] == ["two"]
    assert second["changes"]["level"] == pytest.approx(0.95, abs=0.008)
    assert [trip["trip_id"] for trip in third["changes"]["removed"]] == [trip_id]
    assert third["changes"]["level"] == pytest.approx(1.0 / 0.95, abs=0.008)
    assert third["changes"]["since"] == 2


def test_a_choice_that_means_nothing_is_said(client: TestClient, yard: Yard) -> None:
    driven(yard, "one", worked(1))
    for first, status, words in (
        ("newest", 422, "is no map to compare"),
        ("2026-02-30..", 422, "not a day of the calendar"),
        ("9", 404, "no map version"),
        (f"{new_id()}:1", 404, "no car"),
        ("1999-01-01..1999-12-31", 422, "share 0 trusted cells"),
    ):
        answer = client.get(f"/api/v1/cars/{yard.car_id}/maps/compare", params={"first": first})
        assert answer.status_code == status
        assert words in answer.json()["detail"]
