"""Which trips count in a map is the car's to say, and stands in the map's provenance."""

from __future__ import annotations

from datetime import UTC, datetime
from typing import Any

import pytest
from fastapi.testclient import TestClient

from app.maps.rules import Rules
from app.trips.service import ObservedTrip
from tests.maps.test_comparing_maps import driven, renewed, versions, worked
from tests.yards import Yard

FEBRUARY = datetime(2026, 2, 1, tzinfo=UTC)


def names(version: dict[str, Any]) -> list[str]:
    return [trip["name"] for trip in version["provenance"]["trips"]]


@pytest.mark.parametrize(
    ("rules", "why"),
    [
        (Rules(), ""),
        (Rules(verdicts="doubtful"), ""),
        (Rules(verdicts="healthy"), "the observer's verdict is doubtful"),
        (Rules(smoothed_only=True), "it is not smoothed"),
        (Rules(torque_source="observer"), ""),
        (Rules(torque_source="ecu"), "its torque comes from the observer"),
        (Rules(since=FEBRUARY), "it began before 2026-02-01"),
        (Rules(until=FEBRUARY), ""),
        (Rules(until=datetime(2026, 1, 15, tzinfo=UTC)), "it began after 2026-01-15"),
    ],
)
def test_a_rule_says_why_a_trip_does_not_count(rules: Rules, why: str) -> None:
    began = datetime(2026, 1, 15, tzinfo=UTC)
    trip = ObservedTrip("", "January", True, "", "", "", {}, began, began, "doubtful", False, True)
    assert rules.why_not(trip, "observer") == why


def test_other_rules_make_another_map_and_the_usual_ones_the_same_again(client: TestClient, yard: Yard) -> None:
    driven(yard, "January", worked(1), 1)
    driven(yard, "February", worked(2), 2, "doubtful")
    driven(yard, "March", worked(3), 3, "failed")
    path = f"/api/v1/cars/{yard.car_id}/maps/rules"
    usual = client.get(path).json()
    assert list(usual.values()) == ["all", False, "both", None, None]
    answer = client.patch(path, json={"verdicts": "doubtful", "since": "2026-02-01"})
    assert answer.json() == usual | {"verdicts": "doubtful", "since": "2026-02-01T00:00:00Z"}
    renewed(yard)
    newest = versions(client, yard)[0]
    assert (newest["version"], names(newest)) == (4, ["February"])
    assert [trip["why"] for trip in newest["provenance"]["left_out"]] == [
        "it began before 2026-02-01", "the observer's verdict is failed",
    ]  # fmt: skip
    assert newest["provenance"]["rules"]["verdicts"] == "doubtful"
    assert newest["changes"]["rules_changed"]
    client.patch(path, json={"verdicts": "all", "since": None})
    renewed(yard)
    fifth, _, third, *_ = versions(client, yard)
    cells = [client.get(f"/api/v1/cars/{yard.car_id}/maps/{one['version']}").json()["cells"] for one in (fifth, third)]
    assert cells[0] == cells[1]
    client.patch(path, json={"verdicts": "all"})
    titles = [job["title"] for job in client.get("/api/v1/jobs").json()["items"]]
    assert titles == ["Map by other rules"]  # the second one joined it
    for wrong in ({"verdicts": "good"}, {"since": "yesterday"}, {"trips": 3}, {"verdicts": None}):
        assert client.patch(path, json=wrong).status_code == 422
