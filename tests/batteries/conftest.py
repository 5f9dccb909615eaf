"""Batteries over REST, with the test in the place of the worker."""

from __future__ import annotations

import io
from dataclasses import dataclass, field
from datetime import UTC, datetime
from typing import Any

import numpy as np
import pytest
from fastapi.testclient import TestClient

from app.accounts.models import DEFAULT_FLEET_ID as FLEET
from app.science.battery.config_reading import read_config
from app.science.battery.simulate import simulate
from app.storage.resources import Resources
from tests.yards import Yard
from workers.pipeline import STAGES
from workers.running import run_next_stage

CONFIG: dict[str, Any] = {
    "ocv": [[0.0, 3.0], [0.1, 3.3], [0.3, 3.45], [0.6, 3.6], [0.9, 3.9], [1.0, 4.1]],
    "initial": {
        "capacity_ah": 2.2,
        "resistance_ohm": 0.012,
        "relaxation_capacitance_f": 1800.0,
        "relaxation_resistance_ohm": 0.018,
        "soc": 0.6,
    },
    "rated_capacity_ah": 2.2,
}
TRUTH = CONFIG | {
    "initial": {
        "capacity_ah": 2.0,
        "resistance_ohm": 0.01,
        "relaxation_capacitance_f": 2000.0,
        "relaxation_resistance_ohm": 0.015,
        "soc": 0.7,
    }
}
BEGAN = datetime(2026, 3, 1, 8, 0, tzinfo=UTC)


def measured(seed: int = 1, hours: float = 1.0, **changed: float) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Return time, current and voltage of a drive with the true cell, a row a second, with 2 mV of noise."""
    random = np.random.default_rng(seed)
    t_s = np.arange(0.0, 3600.0 * hours)
    current = np.repeat(random.normal(-0.5, 2.0, len(t_s) // 10 + 1), 10)[: len(t_s)]
    cell = read_config(TRUTH | {"initial": TRUTH["initial"] | changed}).cell
    voltage = simulate(cell, t_s, current).voltage_v + random.normal(0.0, 0.002, len(t_s))
    return t_s, current, voltage


def table(seed: int = 1, hours: float = 1.0, **changed: float) -> bytes:
    """Return such a drive as a file."""
    sink = io.StringIO()
    sink.write("t_s,current_a,voltage_v\n")
    np.savetxt(sink, np.column_stack(measured(seed, hours, **changed)), fmt="%.6g", delimiter=",")
    return sink.getvalue().encode()


@dataclass
class Bench:
    """Where batteries are measured, and estimated when the test says so."""

    client: TestClient
    resources: Resources
    car_id: str = field(init=False)

    def __post_init__(self) -> None:
        self.car_id = self.client.post("/api/v1/cars", json={"name": "hybrid"}).json()["id"]

    def ask(self, method: str, path: str, status: int = 200, **more: Any) -> Any:
        """Send a request below /api/v1/batteries, and return its JSON."""
        answer = self.client.request(method, f"/api/v1/batteries{path}", **more)
        assert answer.status_code == status, answer.text
        return answer.json() if answer.content else None

    def make(self, **changed: Any) -> str:
        """Give the car a battery, and return its path."""
        body = {"car_id": self.car_id, "config": CONFIG | changed}
        return f"/{self.ask('POST', '', 201, json=body)['id']}"

    def send(self, path: str, data: bytes, status: int = 202, **params: Any) -> Any:
        """Send a file."""
        return self.ask("POST", f"{path}/data", status, content=data, params={"filename": "drive.csv", **params})

    def work(self, job_id: str) -> str:
        """Do what a job asks for, as a worker would."""
        return run_next_stage(self.resources, FLEET, job_id, STAGES)

    def work_all(self) -> list[str]:
        """Do what all jobs ask for that wait."""
        done: list[str] = []
        while waiting := self.client.get("/api/v1/jobs", params={"state": "queued"}).json()["items"]:
            done.append(self.work(waiting[-1]["id"]))
        return done


@pytest.fixture
def bench(client: TestClient, resources: Resources) -> Bench:
    """Return a service without workers."""
    return Bench(client, resources)


@pytest.fixture
def yard(resources: Resources) -> Yard:
    """Return a fleet with a car and a trip."""
    return Yard(resources)
