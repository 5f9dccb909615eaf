"""Drives of a car with its own map: the engine looked up, the version remembered, the problem filled in."""

from __future__ import annotations

import json
from typing import Any

import pytest

from app.accounts.models import DEFAULT_FLEET_ID as FLEET
from app.drives.schemas import ACCELERATE
from app.maps.updating import update
from app.science.vehicle.xml import new_car_xml
from app.science.virtualcar.carfile import car_xml
from app.science.virtualcar.specification import DEFAULT_CAR
from tests.drives.conftest import Desk
from tests.synthetic import drive, random_points
from tests.yards import Yard, silent

OBSERVATION = drive(seconds=60.0)


@pytest.fixture
def mapped(desk: Desk, yard: Yard) -> Yard:
    """A car with a file of its own whose map is of Table 4.1's engine."""
    xml = {"content": car_xml(DEFAULT_CAR), "headers": {"Content-Type": "application/xml"}}
    assert desk.client.put(f"/api/v1/cars/{yard.car_id}/config", **xml).status_code == 200
    yard.observed("one", OBSERVATION, random_points(60_000))
    yard.write(update(yard.resources, FLEET, yard.car_id, silent))
    return yard


def names(car_id: str) -> list[tuple[Any, str | None]]:
    """Return every way to name the car's only map, and the car that has to be given with it."""
    alone = [car_id, f"{car_id}:1", f"{car_id}:latest", f"/api/v1/cars/{car_id}/maps/1"]
    return [*((name, None) for name in alone), ("latest", car_id), (1, car_id)]


def test_a_cars_map_is_its_engine_by_any_of_its_names(desk: Desk, mapped: Yard) -> None:
    known = desk.ask("GET", "/engines", params={"car_id": mapped.car_id})
    assert known["named"] == {"map": f"{mapped.car_id}:1", "fit": "willans"}
    seen = set()
    for name, car_id in names(mapped.car_id):
        body = {"car_id": car_id, "problem": ACCELERATE | {"engine": {"map": name}}}
        posed = desk.ask("POST", "", 202, json=body)
        assert posed["engine"] == known["engine"]
        assert (posed["car_id"], posed["map"]) == (mapped.car_id, {"car_id": mapped.car_id, "version": 1})
        seen.add(desk.ask("GET", "", params={"car_id": mapped.car_id})["items"][0]["car_name"])
    assert seen == {"car"}
    assert (
        desk.ask("POST", "", 422, json=ACCELERATE | {"engine": {"map": f"{mapped.car_id}:2"}})["path"] == "engine.map"
    )
    asked = ACCELERATE | {"engine": {"map": mapped.car_id, "fit": "cubic"}}
    assert desk.ask("POST", "", 422, json=asked)["path"] == "engine.fit"


def test_the_drive_keeps_its_engine_when_the_car_goes(desk: Desk, mapped: Yard) -> None:
    posed = desk.pose(engine={"map": mapped.car_id}, to_speed_mps=20.0)
    params = {"with_trips": True}
    assert desk.client.delete(f"/api/v1/cars/{mapped.car_id}", params=params).status_code == 204
    assert desk.work(posed["job_id"]) == "succeeded"
    drive = desk.ask("GET", f"/{posed['id']}")
    assert (drive["state"], drive["car_id"], drive["map"]["version"]) == ("solved", None, 1)
    saved = desk.ask("GET", f"/{posed['id']}/export", params={"format": "problem"})
    assert saved == posed["problem"] | {"engine": posed["engine"]}


def test_a_problem_filled_in_for_a_car_can_be_posed_as_it_is(desk: Desk, mapped: Yard) -> None:
    for fit in ("willans", "phi"):
        asked = {"car_id": mapped.car_id, "fit": fit}
        template = desk.ask("GET", "/template", params=asked)
        assert template["problem"]["engine"] == {"map": f"{mapped.car_id}:1", "fit": fit}
        assert template["problem"]["transmission"]["ratios"] == list(DEFAULT_CAR.gear_ratios)
        posed = desk.ask("POST", "", 202, json={"problem": template["problem"]})
        assert desk.work(posed["job_id"]) == "succeeded"
        whole = desk.ask("GET", "/template", params=asked | {"whole": True})
        assert whole["problem"]["engine"] == template["engine"]


def test_every_kind_is_filled_in(desk: Desk, mapped: Yard) -> None:
    for kind in ("accelerate", "distance", "route"):
        template = desk.ask("GET", "/template", params={"car_id": mapped.car_id, "kind": kind})
        posed = desk.ask("POST", "", 202, json={"problem": template["problem"]})
        assert posed["kind"] == kind
        assert json.dumps(posed["problem"]) == json.dumps(template["problem"])


def test_a_car_without_a_map_or_gears_says_what_it_lacks(desk: Desk, yard: Yard, mapped: Yard) -> None:
    bare = desk.client.post("/api/v1/cars", json={"name": "bare"}).json()["id"]
    assert desk.ask("GET", "/template", 404, params={"car_id": bare})["code"] == "not-found"
    assert desk.ask("GET", "/engines", 404, params={"car_id": bare})["code"] == "not-found"
    refused = desk.ask("POST", "", 422, json=ACCELERATE | {"engine": {"map": bare}})
    assert refused["path"] == "engine.map"
    xml = {"content": new_car_xml(), "headers": {"Content-Type": "application/xml"}}
    desk.client.put(f"/api/v1/cars/{mapped.car_id}/config", **xml)
    lacking = desk.ask("GET", "/template", 422, params={"car_id": mapped.car_id})
    assert "gear ratios" in lacking["detail"]
