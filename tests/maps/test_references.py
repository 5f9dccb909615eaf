"""A dynamometer's table laid over a car's map, and the level corrected by it when somebody says so."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from fastapi.testclient import TestClient

from app.science.vehicle.fuels import FUELS
from app.trips import repository as trip_rows
from tests.maps.test_comparing_maps import driven, worked
from tests.synthetic import table_4_1
from tests.yards import Yard

PETROL = FUELS["petrol"]


def bench_table(scale: float = 1.0) -> bytes:
    """Consumption of the engine of Table 4.1 as a dynamometer would write it."""
    rpm, nm = (a.ravel() for a in np.meshgrid(np.arange(1000.0, 5001.0, 500.0), np.arange(10.0, 111.0, 10.0)))
    bsfc = 3.6e9 * PETROL.density_kg_per_l / (PETROL.energy_j_per_l * table_4_1(rpm, nm) * scale)
    lines = [f"{s:.0f},{t:.0f},{b:.2f}" for s, t, b in zip(rpm, nm, bsfc, strict=True)]
    return "\n".join(["rpm,nm,bsfc_gpkwh", *lines]).encode()


@pytest.fixture
def path(client: TestClient, yard: Yard) -> str:
    """Address of the tables of a car whose map reads 10 % high."""
    trip_id = driven(yard, "one", worked(1, 1.1))

    def by_pulses(session: Any) -> None:
        trip = trip_rows.trip(session, trip_id)
        assert trip is not None
        trip.consistency = [{"sensor": "fuel_energy"}]

    yard.write(by_pulses)
    return f"/api/v1/cars/{yard.car_id}/references"


def added(client: TestClient, path: str, data: bytes, **params: str) -> dict[str, Any]:
    answer = client.post(path, params={"name": "Bench", "filename": "bench.csv"} | params, content=data)
    assert answer.status_code == 201, answer.text
    document: dict[str, Any] = answer.json()
    return document


def test_a_table_is_kept_as_it_came_and_told_beside_the_map(client: TestClient, path: str) -> None:
    data = bench_table()
    row = added(client, path, data)
    assert (row["points"], row["fuel"]) == (99, "petrol")
    assert client.post(path, content=data).status_code == 200
    assert [one["id"] for one in client.get(path).json()["items"]] == [row["id"]]
    assert client.get(f"{path}/{row['id']}").content == data
    found = client.get(f"{path}/{row['id']}/agreement").json()
    assert found["scale"] == pytest.approx(1.1, abs=0.006)
    assert found["correlation"] > 0.98
    assert abs(found["peak_rpm"]) <= 400.0
    assert found["rmse_scaled"] < 0.2 * found["rmse"]
    assert client.delete(f"{path}/{row['id']}").status_code == 204
    assert client.get(f"{path}/{row['id']}").status_code == 404


def test_before_and_after_are_drawn(client: TestClient, path: str) -> None:
    row = added(client, path, bench_table())
    overlay = client.get(f"{path}/{row['id']}/figures/overlay", params={"quantity": "bsfc"}).json()
    assert overlay["data"][-1]["name"].startswith("Bench, every")
    before, after = (
        client.get(f"{path}/{row['id']}/figures/difference", params={"corrected": corrected, "theme": "dark"}).json()
        for corrected in (False, True)
    )
    points = [
        np.array([z for line in figure["data"][0]["z"] for z in line if z is not None]) for figure in (before, after)
    ]
    assert points[0].mean() == pytest.approx(3.2, abs=0.4)
    assert abs(points[1].mean()) < 0.1


def test_the_level_is_corrected_on_the_users_word_only(client: TestClient, yard: Yard, path: str) -> None:
    row = added(client, path, bench_table())
    level = client.get(f"{path}/{row['id']}/agreement").json()["level"]
    assert level["after"] == pytest.approx(1.1 * level["before"], rel=0.01)
    assert level["impossible"] == ""
    word = {"version": 1, "key": level["key"]}
    assert client.post(f"{path}/{row['id']}/apply", json=word | {"key": "x"}).json()["code"] == "level-changed"
    done = client.post(f"{path}/{row['id']}/apply", json=word)
    assert done.status_code == 202, done.text
    assert "Injector flow" in done.json()["note"]
    assert len(done.json()["jobs"]) == 2
    fields = client.get(f"/api/v1/cars/{yard.car_id}/config/form").json()["fields"]
    flow = next(field["value"] for field in fields if field["path"] == "inj/calibration@fuelPerSecond")
    assert flow == pytest.approx(level["after"], rel=1e-6)
    assert client.post(f"{path}/{row['id']}/apply", json=word).json()["code"] == "level-changed"
    old = client.get(f"{path}/{row['id']}/agreement").json()["level"]
    assert "another car file" in old["impossible"]


def test_fuel_that_the_engine_reports_is_not_corrected_by_the_injectors(
    client: TestClient, yard: Yard, path: str
) -> None:
    trip_id = client.get(f"/api/v1/cars/{yard.car_id}/maps").json()["items"][0]["provenance"]["trips"][0]["trip_id"]
    yard.write(lambda session: setattr(trip_rows.trip(session, trip_id), "consistency", [{"sensor": "fuel_power"}]))
    row = added(client, path, bench_table())
    level = client.get(f"{path}/{row['id']}/agreement").json()["level"]
    assert "reported by the engine" in level["impossible"]
    answer = client.post(f"{path}/{row['id']}/apply", json={"version": 1, "key": level["key"]})
    assert (answer.status_code, answer.json()["code"]) == (422, "not-by-the-injectors")


def test_a_table_that_cannot_be_used_is_answered_with_its_row(client: TestClient, path: str) -> None:
    answer = client.post(path, content=bench_table().replace(b"2000,40,", b"2000,forty,"))
    assert (answer.status_code, answer.json()["field"]) == (422, "nm")
    assert "'forty' is not a number" in answer.json()["detail"]
    elsewhere = bench_table().replace(b"\n", b"\n1")  # 11 000 to 15 000 rpm
    row = added(client, path, elsewhere)
    answer = client.get(f"{path}/{row['id']}/agreement")
    assert answer.status_code == 422
    assert "hardly overlap" in answer.json()["detail"]
    assert client.post(path, params={"fuel": "coal"}, content=bench_table()).status_code == 422
    assert client.post(path, content=b"rpm,nm,efficiency\n" + b"1000,20,0.2\n" * 100_000).status_code == 413
