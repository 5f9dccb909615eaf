"""Shapes of the jobs as the API shows them."""

from __future__ import annotations

from typing import Any

from pydantic import ConfigDict

from app.schemas import Document, Moment

STAGE_EXAMPLE: dict[str, Any] = {
    "name": "decode",
    "state": "running",
    "started_at": "2026-03-01T08:00:01Z",
    "finished_at": None,
    "seconds": None,
    "progress": 0.4,
    "detail": "21 of 52 MB, 2 trips",
}
JOB_EXAMPLE: dict[str, Any] = {
    "id": "6f1c2f0b8d8e4a0f9a52f1b6c0de0001",
    "kind": "trip",
    "state": "running",
    "trip_id": "6f1c2f0b8d8e4a0f9a52f1b6c0de0002",
    "car_id": "6f1c2f0b8d8e4a0f9a52f1b6c0de0003",
    "drive_id": None,
    "battery_id": None,
    "title": "27-october.dat",
    "stages": [STAGE_EXAMPLE],
    "attempt": 1,
    "problem": None,
    "cancel_requested": False,
    "created_at": "2026-03-01T08:00:00Z",
    "started_at": "2026-03-01T08:00:01Z",
    "finished_at": None,
}


class StageView(Document):
    """One stage of a job. ``seconds`` is how long it took or has been running, ``progress`` goes from 0 to 1."""

    name: str
    state: str
    started_at: Moment | None
    finished_at: Moment | None
    seconds: float | None
    progress: float
    detail: str | None


class JobView(Document):
    """A job with its stages in order. ``attempt`` counts the tries of the stage that is next or running."""

    model_config = ConfigDict(json_schema_extra={"example": JOB_EXAMPLE})

    id: str
    kind: str
    state: str
    trip_id: str | None
    car_id: str | None
    drive_id: str | None
    battery_id: str | None
    title: str
    stages: list[StageView]
    attempt: int
    problem: dict[str, Any] | None
    cancel_requested: bool
    created_at: Moment
    started_at: Moment | None
    finished_at: Moment | None

    @property
    def is_over(self) -> bool:
        """Whether nothing more will happen unless somebody retries it."""
        return self.state not in ("queued", "running")

    @property
    def current_stage(self) -> str | None:
        """Name of the stage that is next or running."""
        return next((stage.name for stage in self.stages if stage.state != "succeeded"), None)
