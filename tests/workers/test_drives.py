"""Drives through a real supervisor, web server and worker: waited for, and cancelled on their way."""

from __future__ import annotations

from collections.abc import Iterator
from math import sin
from pathlib import Path
from typing import Any

import pytest

from app.drives.schemas import ACCELERATE
from app.settings import Settings
from tests.workers.house import House

pytestmark = pytest.mark.slow


def long_way() -> dict[str, Any]:
    """Return a hundred hilly kilometres, which take a worker many times as long as it takes to cancel them."""
    at = [100.0 * k for k in range(1001)]
    limits = [(14.0, 19.0, 25.0)[k // 20 % 3] for k in range(1001)]
    road = {"distance_m": at, "elevation_m": [30.0 * sin(s / 1500.0) for s in at], "speed_limit_mps": limits}
    ends = {"from_speed_mps": 12.0, "to_speed_mps": 12.0, "min_speed_mps": 5.0, "max_time_s": None}
    car = {name: ACCELERATE[name] for name in ("vehicle", "engine")}
    gears = ACCELERATE["transmission"] | {"neutral": True, "shift_cost_j": 500.0}
    return {"kind": "route", **car, "transmission": gears, "road": road, **ends, "brake_max_n": 5000.0}


@pytest.fixture
def house(tmp_path: Path) -> Iterator[House]:
    house = House(Settings(data_dir=tmp_path / "data", redeliver_s=0.5, workers=1), tmp_path / "up.log")
    yield house
    house.client.close()
    if house.process is not None:
        house.process.kill()
        house.process.wait()


def test_a_drive_is_waited_for_and_a_long_one_is_cancelled_on_its_way(house: House) -> None:
    house.start()
    house.until(lambda: house.children("worker"))
    drive = house.change("POST", "/drives?wait=30", 201, json=ACCELERATE)
    assert (drive["state"], drive["verdict"]) == ("solved", "optimal")
    impossible = house.change("POST", "/drives?wait=30", 422, json=ACCELERATE | {"to_speed_mps": 120.0})
    assert impossible["code"] == "infeasible"

    long = house.change("POST", "/drives", 202, json=long_way())
    job = long["job_id"]
    house.until(lambda: house.get(f"/jobs/{job}")["stages"][0]["progress"] > 0.0)
    assert house.change("GET", f"/drives/{long['id']}/answer", 409)["code"] == "answer-not-ready"
    assert house.get(f"/drives/{long['id']}")["state"] == "solving"
    house.change("POST", f"/jobs/{job}/cancel", 200)
    assert house.until(lambda: house.job_is_over(job))["state"] == "cancelled"
    assert house.change("GET", f"/drives/{long['id']}/answer", 409)["code"] == "cancelled"
    assert house.stop() == 0
