"""Drives over REST, with the test in the place of the worker."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import pytest
from fastapi.testclient import TestClient

from app.accounts.models import DEFAULT_FLEET_ID as FLEET
from app.drives.schemas import ACCELERATE
from app.storage.resources import Resources
from tests.yards import Yard
from workers.pipeline import STAGES
from workers.running import run_next_stage


@dataclass
class Desk:
    """Where drives are posed, and worked on when the test says so."""

    client: TestClient
    resources: Resources

    def ask(self, method: str, path: str, status: int = 200, **more: Any) -> Any:
        """Send a request below /api/v1/drives, and return its JSON."""
        answer = self.client.request(method, f"/api/v1/drives{path}", **more)
        assert answer.status_code == status, answer.text
        return answer.json() if answer.content else None

    def pose(self, **changed: Any) -> dict[str, Any]:
        """Pose the thesis' acceleration with some fields changed."""
        drive: dict[str, Any] = self.ask("POST", "", 202, json={"problem": ACCELERATE | changed})
        return drive

    def work(self, job_id: str) -> str:
        """Do what a job asks for, as a worker would."""
        return run_next_stage(self.resources, FLEET, job_id, STAGES)


@pytest.fixture
def desk(client: TestClient, resources: Resources) -> Desk:
    """Return a service without workers."""
    return Desk(client, resources)


@pytest.fixture
def yard(resources: Resources) -> Yard:
    """Return a fleet with a car and a trip."""
    return Yard(resources)
