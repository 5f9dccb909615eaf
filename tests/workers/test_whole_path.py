"""From an upload to the car's map and back, through a real supervisor, web server and worker."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
from collections.abc import Iterator
from functools import cache
from pathlib import Path

import pytest

from app.science.virtualcar.simulate import SimulatedTrip, simulate
from app.science.virtualcar.specification import DEFAULT_CAR, Simulation
from app.settings import Settings
from tests.workers.house import ROOT, House
from workers.supervisor import environment_of

pytestmark = pytest.mark.slow


@cache
def driven(seed: int, seconds: float = 240.0) -> SimulatedTrip:
    return simulate(Simulation(duration_s=seconds, seed=seed, route="full-load", vehicle=DEFAULT_CAR))


@pytest.fixture
def house(settings: Settings, tmp_path: Path) -> Iterator[House]:
    quick = settings.model_copy(update={"lease_s": 1.5, "redeliver_s": 0.5, "workers": 1})
    house = House(quick, tmp_path / "up.log")
    yield house
    house.client.close()
    if house.process is not None:
        house.process.kill()
        house.process.wait()


def new_car(house: House) -> str:
    xml = driven(1).car_xml
    return str(house.change("POST", "/cars", 201, content=xml, headers={"Content-Type": "application/xml"})["id"])


def test_an_uploaded_trip_becomes_a_map_and_can_be_left_out(house: House) -> None:
    house.start()
    car = new_car(house)
    first = house.send(car, "first.dat", driven(1).image)
    events = list(house.events(f"/jobs/{first['job']['id']}/events"))
    assert [e["data"]["name"] for e in events if e["event"] == "stage" and e["data"]["state"] == "succeeded"] == [
        "decode",
        "observe",
        "map",
        "health",
        "battery",
        "score",
    ]
    assert events[-1]["data"]["state"] == "succeeded"
    assert [e["id"] for e in events] == sorted(e["id"] for e in events)
    half = events[len(events) // 2]["id"]
    resumed = list(house.events(f"/jobs/{first['job']['id']}/events", seen=half))
    assert resumed == [e for e in events if e["id"] > half]
    end = {"Last-Event-ID": str(events[-1]["id"])}
    assert house.client.get(f"/api/v1/jobs/{first['job']['id']}/events", headers=end).status_code == 204

    trip = house.get(f"/trips/{first['trip']['id']}")
    truth = driven(1).summary
    assert trip["state"] == "ready"
    assert trip["verdict"] == "healthy"
    assert trip["distance_m"] == pytest.approx(truth["distance_m"], rel=0.005)
    assert trip["fuel_l"] == pytest.approx(truth["fuel_l"], rel=0.02)
    assert trip["provenance"]["input_sha256"] == first["upload"]["sha256"]

    second = house.send(car, "second.dat", driven(2).image)
    house.until(lambda: house.job_is_over(second["job"]["id"]))
    maps = house.get(f"/cars/{car}/maps")["items"]
    assert [(m["version"], m["trips"]) for m in maps] == [(2, 2), (1, 1)]
    assert maps[0]["points"] > maps[1]["points"] > 100

    house.change("PATCH", f"/trips/{second['trip']['id']}", 200, json={"in_map": False})
    house.until(lambda: house.get(f"/cars/{car}/maps/latest")["version"] == 3)
    house.change("PATCH", f"/trips/{second['trip']['id']}", 200, json={"in_map": True})
    house.until(lambda: house.get(f"/cars/{car}/maps/latest")["version"] == 4)
    one, both, without, again = (house.get(f"/cars/{car}/maps/{version}")["cells"] for version in (1, 2, 3, 4))
    assert without == one
    assert again == both
    assert one != both

    assert house.send(car, "copy.dat", driven(1).image)["upload"]["duplicate"]
    house.change("DELETE", f"/trips/{second['trip']['id']}", 204)
    house.until(lambda: house.get(f"/cars/{car}/maps/latest")["version"] == 5)
    assert house.get(f"/cars/{car}/maps/5")["cells"] == one
    assert not house.send(car, "second once more.dat", driven(2).image)["upload"]["duplicate"]
    assert house.stop() == 0


def test_everything_is_killed_and_goes_on_at_the_next_start(house: House) -> None:
    house.start()
    car = new_car(house)
    jobs = [house.send(car, f"trip {seed}.dat", driven(seed).image)["job"]["id"] for seed in (1, 2, 3)]
    house.until(lambda: any(house.get(f"/jobs/{job}")["state"] == "running" for job in jobs))
    house.kill_everything()
    house.start()
    for job in jobs:
        assert house.until(lambda job=job: house.job_is_over(job))["state"] == "succeeded"
    assert house.get(f"/cars/{car}/maps/latest")["trips"] == 3


def test_a_killed_worker_and_a_killed_web_server_come_back(house: House) -> None:
    house.start()
    worker = house.until(lambda: house.children("worker"))
    web = house.children("web")
    for pid in (*worker, *web):
        os.kill(pid, signal.SIGKILL)
    house.until(lambda: house.children("worker") not in ([], worker) and house.children("web") not in ([], web))
    job = house.send(new_car(house), "trip.dat", driven(1).image)["job"]["id"]
    assert house.until(lambda: house.job_is_over(job))["state"] == "succeeded"


def test_a_file_that_holds_nothing_fails_with_a_reason_and_can_be_retried(house: House) -> None:
    house.start()
    car = new_car(house)
    received = house.send(car, "blank.dat", b"\xff" + bytes(200_000))
    if received["job"] is None:
        assert received["upload"]["problem"]["detail"]
        return
    job = house.until(lambda: house.job_is_over(received["job"]["id"]))
    assert job["state"] == "failed"
    assert job["problem"]["code"] == "undecodable-image"
    trip = house.get(f"/trips/{received['trip']['id']}")
    assert (trip["state"], trip["problem"]) == ("failed", job["problem"])
    house.change("POST", f"/jobs/{job['id']}/retry", 200)
    again = house.until(lambda: house.job_is_over(job["id"]))
    assert again["problem"] == job["problem"]


def test_an_open_stream_ends_properly_when_it_is_stopped(house: House) -> None:
    house.start()
    with house.client.stream("GET", "/api/v1/jobs/events", timeout=20) as answer:
        assert answer.status_code == 200
        assert house.stop() == 0
        answer.read()  # raises when the connection was cut before the stream's proper end
    log = house.log.read_text()
    assert "without completing response" not in log
    assert "error" not in log.lower()


def test_a_second_supervisor_on_the_same_folder_is_refused(house: House) -> None:
    house.start()
    environment = {**os.environ, **environment_of(house.settings), "PONTHY_PORT": "0"}
    second = subprocess.run(
        [sys.executable, "-m", "workers", "up"], env=environment, cwd=ROOT, capture_output=True, text=True, check=False
    )
    assert second.returncode == 1
    assert "Another Ponthy is running" in second.stderr
    other = {"PONTHY_DATA_DIR": str(house.log.parent / "other"), "PONTHY_PORT": str(house.client.base_url.port)}
    third = subprocess.run(
        [sys.executable, "-m", "workers", "up"],
        env={**environment, **other},
        cwd=ROOT,
        capture_output=True,
        text=True,
        check=False,
    )
    assert third.returncode == 1
    assert "Can't listen" in third.stderr
