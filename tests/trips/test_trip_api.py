"""What the pages and scripts ask of a trip and of a map."""

from __future__ import annotations

import gzip
import io
import json
import zipfile
from dataclasses import asdict
from typing import Any

import numpy as np
import pyarrow.parquet as pq
import pytest
from fastapi.testclient import TestClient

from app.accounts.models import DEFAULT_FLEET_ID as FLEET
from app.maps.updating import update
from app.trips.keys import OBSERVABILITY, result_file
from app.trips.models import Trip
from tests.synthetic import drive, random_points
from tests.yards import Yard, silent

OBSERVATION = drive(seconds=300.0)
POINTS = random_points(30_000)


@pytest.fixture
def shown(client: TestClient) -> Yard:
    """Return the fleet behind the client, with an observed trip and its map."""
    yard = Yard(client.app.state.resources)  # type: ignore[attr-defined]  # the application is FastAPI's
    yard.trip_id = yard.observed("Über Land", OBSERVATION, POINTS)
    yard.write(update(yard.resources, FLEET, yard.car_id, silent))
    return yard


def ask(client: TestClient, path: str, status: int = 200, **query: Any) -> Any:
    answer = client.get(f"/api/v1{path}", params=query)
    assert answer.status_code == status, answer.text
    return answer.json()


def test_a_trip_is_listed_and_changed(client: TestClient, shown: Yard) -> None:
    trip = ask(client, f"/trips/{shown.trip_id}")
    assert (trip["name"], trip["state"], trip["car_name"], trip["job_id"]) == ("Über Land", "ready", "car", None)
    assert trip in ask(client, "/trips", car_id=shown.car_id)["items"]
    assert ask(client, "/trips", car_id="0" * 32)["items"] == []
    changed = client.patch(f"/api/v1/trips/{shown.trip_id}", json={"name": " Kurz ", "notes": "two\nlines"}).json()
    assert (changed["name"], changed["notes"], changed["in_map"]) == ("Kurz", "two\nlines", True)
    for bad in ({"name": ""}, {"color": "red"}, {"name": "x" * 300}):
        assert client.patch(f"/api/v1/trips/{shown.trip_id}", json=bad).status_code == 422


@pytest.mark.parametrize("theme", ["light", "dark"])
@pytest.mark.parametrize(
    "name",
    ["track", "stack", "innovations", "points", "sensors", "told", "nis", "whiteness", "coverage", "refusals"],
)
def test_every_figure_of_a_trip_can_be_drawn(client: TestClient, shown: Yard, name: str, theme: str) -> None:
    figure = ask(client, f"/trips/{shown.trip_id}/figures/{name}", theme=theme)
    assert set(figure) >= {"data", "layout"}


def test_figures_follow_the_wish(client: TestClient, shown: Yard) -> None:
    base = f"/trips/{shown.trip_id}/figures"
    stack = ask(client, f"{base}/stack", signals="thrust_n", from_s=10, to_s=20)
    assert "Thrust" in json.dumps(stack["layout"]) + json.dumps(stack["data"])
    assert ask(client, f"{base}/track", variant="plan")["data"][0]["type"] == "scatter"
    ask(client, f"{base}/stack", 422, signals="speed_mps,nonsense")
    ask(client, f"{base}/portrait", 422)


def test_large_answers_are_compressed_for_those_who_can_read_that(client: TestClient, shown: Yard) -> None:
    path = f"/api/v1/trips/{shown.trip_id}/traces?signals=speed_mps,thrust_n"
    plain = client.get(path, headers={"Accept-Encoding": "identity"})
    packed = client.get(path, headers={"Accept-Encoding": "gzip"})
    assert "Content-Encoding" not in plain.headers
    assert packed.headers["Content-Encoding"] == "gzip"
    assert int(packed.headers["Content-Length"]) < 0.6 * int(plain.headers["Content-Length"])
    assert packed.json() == plain.json()
    assert len(gzip.compress(plain.content)) < len(plain.content)


def test_a_trip_can_be_saved_in_every_format(client: TestClient, shown: Yard) -> None:
    def file(form: str) -> bytes:
        answer = client.get(f"/api/v1/trips/{shown.trip_id}/export", params={"format": form})
        assert answer.status_code == 200, answer.text
        assert "filename*=UTF-8''%C3%9Cber%20Land." in answer.headers["Content-Disposition"]
        return answer.content

    table = pq.read_table(io.BytesIO(file("parquet")))
    np.testing.assert_array_equal(table["speed_mps"].to_numpy(), OBSERVATION.columns["speed_mps"])
    header, first, *_ = file("csv").decode().splitlines()
    assert header.split(",")[0].strip('"') == "t_s"
    assert float(first.split(",")[0]) == 0.0
    assert json.loads(file("geojson"))["type"] == "FeatureCollection"
    assert any(name.endswith(".kml") for name in zipfile.ZipFile(io.BytesIO(file("kmz"))).namelist())


def test_a_trip_without_a_result_says_so(client: TestClient, shown: Yard) -> None:
    waiting = shown.new_trip("waiting")
    for path in ("traces", "at", "figures/track", "figures/stack", "figures/points", "export", "observability"):
        problem = ask(client, f"/trips/{waiting}/{path}", 409, t_s=1, format="csv")
        assert problem["code"] == "not-observed"
    assert ask(client, f"/trips/{waiting}/decode-report", 409)["code"] == "not-decoded"
    assert ask(client, f"/trips/{'0' * 32}/traces", 404)["code"] == "not-found"


def test_what_the_sensors_tell_is_told(client: TestClient, shown: Yard) -> None:
    path = f"/trips/{shown.trip_id}/observability"
    found = ask(client, path)
    assert found["sensors"] == ["vss", "acc", "gps"]
    assert found["losses"][0]["lost"] == []
    assert found["losses"][0]["moving"]["fuel_power_w"] == "never"
    assert "fuel power" in found["losses"][0]["words"]
    assert len(found["begin_s"]) == len(found["states"]["speed_mps"]["sd"]) == 5
    trip = shown.trip()
    assert trip.observe_key is not None
    shown.resources.blobs.delete(result_file(trip, trip.observe_key, OBSERVABILITY))
    assert ask(client, path, 409)["code"] == ask(client, f"/trips/{trip.id}/figures/told", 409)["code"] == "not-told"


def test_a_map_is_listed_drawn_and_saved(client: TestClient, shown: Yard) -> None:
    base = f"/cars/{shown.car_id}/maps"
    (listed,) = ask(client, base)["items"]
    document = ask(client, f"{base}/latest")
    assert document == ask(client, f"{base}/1")
    assert listed["trusted_cells"] == sum(cell["efficiency"] is not None for cell in document["cells"])
    assert listed["points"] == sum(cell["n"] for cell in document["cells"]) == 30_000
    assert document["provenance"]["trips"][0]["trip_id"] == shown.trip_id
    for name in ("contour", "surface", "counts"):
        for quantity in ("efficiency", "bsfc"):
            assert ask(client, f"{base}/latest/figures/{name}", quantity=quantity)["data"]
    for form, start in (("json", b"{"), ("csv", b"rpm,nm"), ("png", b"\x89PNG"), ("svg", b"<?xml")):
        answer = client.get(f"/api/v1{base}/1/export", params={"format": form})
        assert answer.status_code == 200
        assert answer.content.startswith(start)
    ask(client, f"{base}/2", 404)
    ask(client, f"{base}/latest/figures/contour", 422, quantity="colour")


def test_jobs_are_listed_by_state_and_trip(client: TestClient, shown: Yard) -> None:
    job = shown.new_job()
    assert [found["id"] for found in ask(client, "/jobs", trip_id=shown.trip_id)["items"]] == [job.id]
    assert ask(client, "/jobs", state="succeeded")["items"] == []
    cancelled = client.post(f"/api/v1/jobs/{job.id}/cancel").json()
    assert cancelled["state"] == "cancelled"
    assert client.post(f"/api/v1/jobs/{job.id}/cancel").status_code == 409
    assert client.post(f"/api/v1/jobs/{job.id}/retry").json()["state"] == "queued"
    assert ask(client, f"/jobs/{'0' * 32}/events", 404)["code"] == "not-found"


def test_metrics_count_the_jobs(client: TestClient, shown: Yard) -> None:
    shown.new_job()
    lines = client.get("/metrics").text.splitlines()
    assert 'ponthy_jobs{state="queued"} 1.0' in lines
    assert 'ponthy_jobs{state="failed"} 0.0' in lines


def test_the_demo_is_made_once(client: TestClient, shown: Yard) -> None:
    first = client.post("/api/v1/demo")
    assert first.status_code == 202
    assert client.post("/api/v1/demo").json()["id"] == first.json()["id"]


@pytest.mark.parametrize(
    ("tuning", "said"),
    [
        ({"q_thrust": 0.0}, "q_thrust: 0.0 can't be a covariance"),
        ({"q_thurst": 1.0}, "q_thurst: no such entry in a tuning. Did you mean q_thrust?"),
        ("thesis-1810", "there is no tuning called 'thesis-1810'"),
    ],
)
def test_a_bad_tuning_is_refused_with_the_entry_and_starts_nothing(
    client: TestClient, shown: Yard, tuning: Any, said: str
) -> None:
    before = ask(client, f"/trips/{shown.trip_id}")
    answer = client.post(f"/api/v1/trips/{shown.trip_id}/reprocess", json={"tuning": tuning})
    assert answer.status_code == 422
    assert said in answer.json()["detail"]
    assert ask(client, f"/trips/{shown.trip_id}") == before


def test_the_consistency_names_each_sensor_and_tells_its_refusals(client: TestClient, shown: Yard) -> None:
    rows_kept = [asdict(sensor) for sensor in OBSERVATION.sensors]
    shown.write(lambda session: setattr(session.get(Trip, shown.trip_id), "consistency", rows_kept))
    rows = ask(client, f"/trips/{shown.trip_id}/consistency")["items"]
    assert [row["words"] for row in rows] == ["Wheels", "Accelerometer, forward", "Position, north"]
    assert set(rows[0]) >= {"nis_low", "nis_high", "lag1", "portmanteau", "within_one_sigma", "bias", "recovered"}
    assert rows[2]["episodes"][0] == {"from_s": 10.0, "to_s": 12.0, "count": 5, "recovered": True}
