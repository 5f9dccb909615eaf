"""Elevation tables over REST, and finding those that cover a trip."""

from __future__ import annotations

import numpy as np
import pytest
from fastapi.testclient import TestClient

from app.accounts.models import DEFAULT_FLEET_ID
from app.roads import service
from app.storage.resources import Resources


def table(lat: float, alt: float) -> bytes:
    """Return a street of 100 m, going north."""
    return f"lat_deg,lon_deg,alt_m,way\n{lat},8.68,{alt},1\n{lat + 0.0009},8.68,{alt + 2},1\n".encode()


def found(resources: Resources, south: float, north: float) -> service.Elevation:
    with resources.database.transaction(DEFAULT_FLEET_ID, read_only=True) as session:
        return service.elevation_for(session, resources.blobs, service.Bounds(south, 8.6, north, 8.7))


def test_a_table_is_kept_listed_and_removed(client: TestClient, resources: Resources) -> None:
    answer = client.post("/api/v1/roads", content=table(49.0, 100), params={"name": "hill.csv"})
    kept = answer.json()
    assert (answer.status_code, kept["name"], kept["nodes"]) == (201, "hill.csv", 2)
    assert kept["bounds"] == pytest.approx([49.0, 8.68, 49.0009, 8.68])
    assert client.get("/api/v1/roads").json()["items"] == [kept]
    assert client.delete(f"/api/v1/roads/{kept['id']}").status_code == 204
    assert client.delete(f"/api/v1/roads/{kept['id']}").status_code == 404
    assert resources.blobs.keys("fleets") == []


def test_the_same_table_is_kept_once(client: TestClient, resources: Resources) -> None:
    first = client.post("/api/v1/roads", content=table(49.0, 100))
    again = client.post("/api/v1/roads", content=table(49.0, 100))
    assert (again.status_code, again.json()) == (200, first.json())
    assert len(resources.blobs.keys("fleets")) == 1


@pytest.mark.parametrize(
    ("data", "row", "field"),
    [
        (b"lat_deg,lon_deg,alt_m\n49,8,100\n49.1,8,high\n", 3, "alt_m"),
        (b"lat_deg,lon_deg,alt_m\n49,8,100\n95,8,100\n", 3, "lat_deg"),
        (b"lat_deg,lon_deg\n49,8\n49.1,8\n", 1, "alt_m"),
    ],
)
def test_a_bad_table_is_answered_with_row_and_column(client: TestClient, data: bytes, row: int, field: str) -> None:
    answer = client.post("/api/v1/roads", content=data)
    assert answer.status_code == 422
    assert (answer.json()["row"], answer.json()["field"]) == (row, field)


@pytest.mark.parametrize("data", [b"", b"\x00\xff", b"lat_deg,lon_deg,alt_m\n", b"\xff\xd8\xff\xe0" * 100])
def test_what_is_no_table_is_refused(client: TestClient, resources: Resources, data: bytes) -> None:
    assert client.post("/api/v1/roads", content=data).status_code == 422
    assert resources.blobs.keys("fleets") == []


def test_all_tables_that_cover_a_trip_are_joined(client: TestClient, resources: Resources) -> None:
    for lat, alt in ((49.0, 100.0), (49.01, 200.0), (50.0, 300.0)):
        client.post("/api/v1/roads", content=table(lat, alt))
    elevation = found(resources, 48.9, 49.1)
    assert len(elevation.sha256s) == 2
    assert elevation.roads is not None
    match = elevation.roads.lookup(np.array([49.00045, 49.01045, 50.00045]), np.full(3, 8.68))
    np.testing.assert_allclose(match.alt_m, [101.0, 201.0, np.nan], atol=1e-6)


def test_where_nothing_is_known_nothing_is_found(client: TestClient, resources: Resources) -> None:
    client.post("/api/v1/roads", content=table(49.0, 100))
    assert found(resources, 51.0, 52.0) == service.Elevation(None, ())
    with resources.database.transaction(DEFAULT_FLEET_ID, read_only=True) as session:
        assert service.elevation_for(session, resources.blobs, None) == service.Elevation(None, ())
