"""Batteries and the trips that tell of them: a stage of the trip's job that never costs the trip anything."""

from __future__ import annotations

import io
from dataclasses import replace
from datetime import datetime
from typing import Any

import numpy as np
import pytest
from fastapi.testclient import TestClient

from app.accounts.models import DEFAULT_FLEET_ID as FLEET
from app.batteries import service, working
from app.trips import service as trips
from tests.batteries.conftest import BEGAN, CONFIG, measured
from tests.yards import Yard, silent

pytestmark = pytest.mark.parametrize("settings", ["embedded"], indirect=True)
"""What the two databases differ in is tried where files come in."""

HOURS = 0.5


def log(seed: int, day: int, *, battery: bool = True, apart: bool = False, clock: bool = True) -> bytes:
    """Return a signals table of a drive on a day: its battery, and much else."""
    t_s, current, voltage = measured(seed, HOURS)
    zero_s = BEGAN.timestamp() + 86400.0 * day if clock else 0.0
    rows = {"speed_mps": np.column_stack([t_s, np.full(len(t_s), 15.0)])}
    if battery:
        rows["battery_current_a"] = np.column_stack([t_s, current])
        rows["battery_voltage_v"] = np.column_stack([t_s, voltage])[:: 2 if apart else 1]
    sink = io.StringIO()
    sink.write("t_s,signal,value\n")
    for name, columns in rows.items():
        for t, value in columns:
            sink.write(f"{zero_s + t:.3f},{name},{value:.6g}\n")
    return sink.getvalue().encode()


class Garage(Yard):
    """A car whose trips are decoded and told to its battery."""

    client: TestClient

    def drive(self, data: bytes, name: str) -> str:
        """Send a trip, decode it and estimate the battery from it; return its identifier."""
        trip_id = self.new_trip(name, data, f"{name}.csv")
        self.write(trips.decode(self.resources, FLEET, trip_id, silent))
        self.tell(trip_id)
        return trip_id

    def tell(self, trip_id: str) -> None:
        """Do what the battery's stage does."""
        self.write(service.estimate_trip(self.resources, FLEET, trip_id, silent))

    def has_battery(self, **changed: Any) -> str:
        """Give the car a battery, and return its path."""
        body = {"car_id": self.car_id, "config": CONFIG | changed}
        made = self.client.post("/api/v1/batteries", json=body)
        assert made.status_code == 201, made.text
        return f"/api/v1/batteries/{made.json()['id']}"

    def history(self, path: str) -> list[dict[str, Any]]:
        """Return all estimates in the order of time."""
        items: list[dict[str, Any]] = self.client.get(f"{path}/estimates").json()["items"]
        return items[::-1]


@pytest.fixture
def garage(client: TestClient) -> Garage:
    """Return a car without a battery."""
    garage = Garage(client.app.state.resources)  # type: ignore[attr-defined]  # the application is FastAPI's
    garage.client = client
    return garage


def test_trips_tell_of_the_battery_in_the_order_they_were_driven(garage: Garage) -> None:
    path = garage.has_battery()
    first, second = garage.drive(log(1, 0), "to work"), garage.drive(log(2, 1), "home")
    one, two = garage.history(path)
    assert [(one["trip_id"], one["source"]), (two["trip_id"], two["source"])] == [(first, "to work"), (second, "home")]
    assert (one["began_at"], two["began_at"]) == ("2026-03-01T08:00:00Z", "2026-03-02T08:00:00Z")
    assert two["follows_id"] == one["id"]
    for estimate in (one, two):
        assert estimate["capacity_ah"] == pytest.approx(2.0, abs=3.0 * estimate["capacity_ah_sd"])
    assert two["capacity_ah_sd"] < one["capacity_ah_sd"] < 0.1
    garage.tell(second)
    assert garage.history(path)[1]["made_at"] == two["made_at"]  # the very same is not done twice


def test_signals_that_were_not_sampled_together_will_do(garage: Garage) -> None:
    path = garage.has_battery()
    garage.drive(log(1, 0, apart=True), "apart")
    (one,) = garage.history(path)
    assert one["capacity_ah"] == pytest.approx(2.0, abs=3.0 * one["capacity_ah_sd"])


def test_a_trip_that_tells_nothing_of_a_battery_leaves_no_trace(garage: Garage) -> None:
    garage.drive(log(1, 0), "without a battery in the file")
    path = garage.has_battery()
    garage.drive(log(2, 1, battery=False), "without its signals")
    assert garage.history(path) == []
    garage.client.post(f"{path}/reestimate")
    (job,) = garage.client.get("/api/v1/jobs", params={"battery_id": path[-32:]}).json()["items"]
    store = service.run(garage.resources, FLEET, path[-32:], job["id"], silent)
    garage.write(store)
    assert [one["source"] for one in garage.history(path)] == ["without a battery in the file"]


def test_a_trip_is_removed_with_what_it_said(garage: Garage) -> None:
    path = garage.has_battery()
    first, second = garage.drive(log(1, 0), "one"), garage.drive(log(2, 1), "two")
    assert garage.client.delete(f"/api/v1/trips/{first}").status_code == 204
    assert [one["trip_id"] for one in garage.history(path)] == [second]
    assert service.sweep(garage.resources, FLEET) == 1
    kept = garage.client.get(f"{path}/estimates/{garage.history(path)[0]['id']}")
    assert kept.json()["trip_id"] == second


def test_what_fails_is_told_and_costs_the_trip_nothing(garage: Garage, monkeypatch: pytest.MonkeyPatch) -> None:
    path = garage.has_battery()
    trip_id = garage.drive(log(1, 0), "drive")

    def broken(*_: object) -> None:
        raise RuntimeError("out of luck")

    asked = working.question
    with monkeypatch.context() as patched:
        patched.setattr(working, "answer", broken)
        patched.setattr(working, "question", lambda *given: replace(asked(*given), key="another"))
        garage.tell(trip_id)
    (failed,) = garage.history(path)
    assert (failed["capacity_ah"], failed["warnings"]) == (None, [])
    assert "out of luck" in failed["reason"]
    refused = garage.client.get(f"{path}/estimates/{failed['id']}")
    assert (refused.status_code, refused.json()["code"]) == (409, "no-estimate")
    garage.tell(trip_id)
    (mended,) = garage.history(path)
    assert (mended["id"], mended["reason"]) == (failed["id"], "")
    assert mended["capacity_ah"] is not None


def test_a_configuration_that_lacks_something_is_the_reason(garage: Garage) -> None:
    xml = b'<ponthy_config><battery><cells series="96"/></battery></ponthy_config>'
    assert garage.client.put(f"/api/v1/cars/{garage.car_id}/config", content=xml).status_code == 200
    (battery_id,) = garage.client.get(f"/api/v1/cars/{garage.car_id}").json()["battery_ids"]
    garage.drive(log(1, 0), "drive")
    (one,) = garage.history(f"/api/v1/batteries/{battery_id}")
    assert "ocv" in one["reason"]


def test_a_trip_without_a_clock_counts_from_when_it_came(garage: Garage) -> None:
    path = garage.has_battery()
    trip_id = garage.drive(log(1, 0, clock=False), "no clock")
    (one,) = garage.history(path)
    assert garage.trip(trip_id).started_at is None
    assert datetime.fromisoformat(one["began_at"]) == garage.trip(trip_id).created_at
