"""A car's map is the sum of its included trips, in immutable versions."""

from __future__ import annotations

from concurrent.futures import ThreadPoolExecutor
from dataclasses import fields
from typing import Any

import numpy as np
import pytest

from app.accounts.models import DEFAULT_FLEET_ID as FLEET
from app.cars import service as cars
from app.errors import NotFound
from app.maps import service as maps
from app.maps.models import MapVersion
from app.maps.sides import GRID
from app.maps.updating import update
from app.science.engine.cells import accumulate, build_map
from app.science.engine.document import map_document
from app.science.engine.points import OperatingPoints
from app.science.engine.resolution import resolve
from app.trips import repository as trip_rows
from app.webhooks import service as webhooks
from tests.synthetic import drive, random_points
from tests.yards import Yard, silent

OBSERVATION = drive(seconds=60.0)
ONE, TWO, THREE = (random_points(30_000, seed) for seed in (1, 2, 3))


def updated(yard: Yard) -> None:
    yard.write(update(yard.resources, FLEET, yard.car_id, silent))


def version(yard: Yard, name: str = "latest") -> MapVersion:
    with yard.resources.database.transaction(FLEET, read_only=True) as session:
        return maps.version(session, yard.car_id, name)


def cells(yard: Yard, name: str = "latest") -> list[dict[str, Any]]:
    listed: list[dict[str, Any]] = maps.document(yard.resources.blobs, version(yard, name))["cells"]
    return listed


def directly(yard: Yard, *parts: OperatingPoints) -> list[dict[str, Any]]:
    """The map of all points as one, made without this slice."""
    names = [f.name for f in fields(OperatingPoints) if f.name != "torque_source"]
    joined = OperatingPoints(
        **{name: np.concatenate([getattr(part, name) for part in parts]) for name in names}, torque_source="observer"
    )
    with yard.resources.database.transaction(FLEET, read_only=True) as session:
        vehicle = cars.config(session, yard.car_id).vehicle
    resolved = resolve(accumulate(joined, GRID), GRID)
    listed: list[dict[str, Any]] = map_document(build_map(resolved.sums, resolved.grid, vehicle), {})["cells"]
    return listed


def about_equal(one: list[dict[str, Any]], other: list[dict[str, Any]]) -> bool:
    """Equal but for the order in which numbers were added up, which a small deviation feels most."""
    tables = [np.array([list(cell.values()) for cell in cells], dtype=np.float64) for cells in (one, other)]
    return np.allclose(*tables, rtol=1e-9, atol=1e-7, equal_nan=True)


def everything_but_its_origin(yard: Yard, name: str) -> dict[str, Any]:
    whole: dict[str, Any] = maps.document(yard.resources.blobs, version(yard, name))
    return {key: value for key, value in whole.items() if key != "provenance"}


def leave_out(yard: Yard, trip_id: str, out: bool = True) -> None:
    yard.write(lambda session: setattr(trip_rows.trip(session, trip_id), "in_map", not out))


def test_each_trip_adds_to_the_map(yard: Yard) -> None:
    yard.observed("one", OBSERVATION, ONE)
    updated(yard)
    assert cells(yard) == directly(yard, ONE)
    yard.observed("two", OBSERVATION, TWO)
    updated(yard)
    assert about_equal(cells(yard), directly(yard, ONE, TWO))
    assert (version(yard).version, version(yard).trips, version(yard).points) == (2, 2, 60_000)
    assert cells(yard, "1") == directly(yard, ONE)


def test_a_trip_left_out_and_taken_back_leaves_the_map_as_it_was(yard: Yard) -> None:
    yard.observed("one", OBSERVATION, ONE)
    second = yard.observed("two", OBSERVATION, TWO)
    updated(yard)
    leave_out(yard, second)
    updated(yard)
    assert cells(yard) == directly(yard, ONE)
    leave_out(yard, second, out=False)
    updated(yard)
    assert cells(yard) == cells(yard, "1")
    assert everything_but_its_origin(yard, "3") == everything_but_its_origin(yard, "1")
    assert [trip["name"] for trip in version(yard).provenance["trips"]] == ["one", "two"]


def test_the_same_trips_make_no_new_version(yard: Yard) -> None:
    yard.observed("one", OBSERVATION, ONE)
    updated(yard)
    before = version(yard).id
    updated(yard)
    assert version(yard).id == before


def test_webhooks_hear_of_a_new_version_once(yard: Yard) -> None:
    with yard.resources.database.transaction(FLEET) as session:
        settings, asked = yard.resources.settings, ["map.updated"]
        listener = webhooks.add(session, settings, url="http://localhost:9/", events=asked, description="")
    yard.observed("one", OBSERVATION, ONE)
    updated(yard)
    updated(yard)
    with yard.resources.database.transaction(FLEET, read_only=True) as session:
        (told,) = webhooks.deliveries(session, listener.id, None, 10).items
    newest = version(yard)
    data = told.payload["data"]
    assert (data["car_id"], data["version"], data["points"]) == (yard.car_id, 1, newest.points)
    assert data["best"] == newest.best


def test_a_car_of_which_nothing_is_known_has_no_map(yard: Yard) -> None:
    yard.observed("no fuel", OBSERVATION, random_points(0))
    updated(yard)
    with pytest.raises(NotFound):
        version(yard)


def test_leaving_out_the_only_trip_leaves_an_empty_version(yard: Yard) -> None:
    trip = yard.observed("one", OBSERVATION, ONE)
    updated(yard)
    leave_out(yard, trip)
    updated(yard)
    assert (version(yard).version, version(yard).cells, version(yard).best) == (2, 0, None)


def test_two_workers_at_once_leave_a_map_of_everything(yard: Yard) -> None:
    for name, points in (("one", ONE), ("two", TWO), ("three", THREE)):
        yard.observed(name, OBSERVATION, points)
    with ThreadPoolExecutor(4) as pool:
        list(pool.map(lambda _: updated(yard), range(4)))
    assert (version(yard).version, version(yard).trips) == (1, 3)
    assert about_equal(cells(yard), directly(yard, ONE, TWO, THREE))


def test_a_trip_observed_anew_replaces_its_own_part(yard: Yard) -> None:
    trip_id = yard.observed("one", OBSERVATION, ONE)
    updated(yard)
    again = yard.trip(yard.observed("again", OBSERVATION, TWO))
    key = again.observe_key

    def take_over(session: Any) -> None:
        session.delete(trip_rows.trip(session, again.id))
        trip_rows.trip(session, trip_id).observe_key = key

    blobs = yard.resources.blobs
    data = blobs.get(f"fleets/{FLEET}/trips/{again.id}/{key}/operating_points.parquet")
    blobs.put(f"fleets/{FLEET}/trips/{trip_id}/{key}/operating_points.parquet", data)
    yard.write(take_over)
    updated(yard)
    assert cells(yard) == directly(yard, TWO)


@pytest.mark.parametrize("name", ["0", "2", "-1", "newest", "9" * 30, "1.0", "٣"])
def test_versions_that_are_not_there_are_not_found(yard: Yard, name: str) -> None:
    yard.observed("one", OBSERVATION, ONE)
    updated(yard)
    with pytest.raises(NotFound):
        version(yard, name)


def test_documents_of_removed_cars_are_swept(yard: Yard) -> None:
    yard.observed("one", OBSERVATION, ONE)
    updated(yard)
    assert maps.sweep(yard.resources, FLEET) == 0
    kept = version(yard).document_key
    orphan = kept.replace(yard.car_id, "0" * 32)
    yard.resources.blobs.put(orphan, b"{}")
    assert maps.sweep(yard.resources, FLEET) == 1
    assert yard.resources.blobs.exists(kept)
    assert not yard.resources.blobs.exists(orphan)
