"""Roads for problems over REST: from files, from trips, and as they are."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from tests.drives.conftest import Desk
from tests.synthetic import drive, random_points
from tests.yards import Yard

GPX = """<gpx><trk><trkseg>{}</trkseg></trk></gpx>"""
TABLE = b"distance_m,elevation_m,speed_limit_kmh\n0,100,50\n400,104,50\n1000,104,90\n1500,100,90\n"
ROAD = {"distance_m": [0.0, 800.0], "elevation_m": [3.0, 3.0], "speed_limit_mps": [20.0, 20.0]}


CYCLE_MPS = [0, 2, 5, *[8] * 20, 4, 0, 0, 3, *[6] * 12, 3, 0]


def track(metres: float) -> bytes:
    """Return a track due north, a point every 20 m, rising by one in a hundred."""
    at = np.arange(0.0, metres + 1.0, 20.0)
    points = (f'<trkpt lat="{46.0 + d / 111_150.0:.9f}" lon="7.0"><ele>{500.0 + d / 100.0}</ele></trkpt>' for d in at)
    return GPX.format("".join(points)).encode()


def send(desk: Desk, data: bytes, status: int = 200, **params: Any) -> Any:
    return desk.ask("POST", "/roads", status, content=data, params=params)


def test_a_track_a_table_and_a_cycle_become_roads(desk: Desk) -> None:
    of_track = send(desk, track(2000.0), speed_limit_mps=25.0)
    assert of_track["length_m"] == pytest.approx(2000.0, rel=2e-3)
    assert of_track["climb_m"] == pytest.approx(20.0, abs=1.0)
    assert set(of_track["road"]["speed_limit_mps"]) == {25.0}
    assert any("50 km/h" in note for note in send(desk, track(2000.0))["notes"])
    of_table = send(desk, TABLE)
    assert of_table["road"]["distance_m"] == [0.0, 400.0, 1000.0, 1500.0]
    assert of_table["road"]["speed_limit_mps"] == pytest.approx([50 / 3.6, 50 / 3.6, 25.0, 25.0])
    cycle = "time_s,speed_mps\n" + "".join(f"{t},{v}\n" for t, v in enumerate(CYCLE_MPS))
    first, second = send(desk, cycle.encode(), part=1), send(desk, cycle.encode(), part=2)
    assert len(first["parts"]) == 2
    assert first["length_m"] > second["length_m"]
    assert send(desk, cycle.encode(), 422, part=3)["field"] == "query.part"


def test_a_road_that_is_there_already_is_taken_as_it_is(desk: Desk) -> None:
    assert desk.ask("POST", "/roads", json=ROAD)["road"] == ROAD
    assert desk.ask("POST", "/roads", json={"road": ROAD, "notes": []})["length_m"] == 800.0
    assert "two points" in desk.ask("POST", "/roads", 422, json=ROAD | {"elevation_m": [1.0]})["detail"]


NO_ROADS = {
    b"<gpx></gpx>": "no track and no route",
    b"<gpx><trk>": "well-formed",
    b"a,b\n1,2\n": "is no road",
    b"distance_m,elevation_m,speed_limit_kmh\n0,0,50\n9000,0,50\n": "9000",
}


def test_a_file_without_a_road_says_what_is_missing(desk: Desk) -> None:
    for data, words in NO_ROADS.items():
        assert words in send(desk, data, 422)["detail"].replace("\u202f", "")


def test_a_trip_gives_the_road_it_took(desk: Desk, yard: Yard) -> None:
    observation = drive(seconds=120.0)
    trip = yard.observed("one", observation, random_points(1000))
    found = desk.ask("POST", "/roads", json={"trip_id": trip})
    assert found["length_m"] == pytest.approx(np.ptp(observation.columns["distance_m"]), rel=1e-3)
    assert found["time_s"] == pytest.approx(np.ptp(observation.columns["t_s"]))
    half = desk.ask("POST", "/roads", json={"trip_id": trip, "from_s": 60.0})
    assert half["length_m"] < found["length_m"]
    assert desk.ask("POST", "/roads", 404, json={"trip_id": yard.trip_id})["code"] == "not-found"
