"""Steps in the life of a job that both its users and its workers take."""

from __future__ import annotations

from typing import Any

from sqlalchemy.orm import Session

from app.jobs import repository
from app.jobs.models import EventKind, Job, JobStage, JobState, StageState
from app.jobs.schemas import StageView
from app.storage.base import now
from app.storage.outbox import enqueue

TASK = "ponthy.stage"
"""Name of the task that runs the next stage of a job."""


def offer(session: Session, job: Job) -> None:
    """Have the queue told, after the commit, that a job waits for a worker."""
    enqueue(session, TASK, fleet_id=job.fleet_id, job_id=job.id)


def over(state: JobState, problem: dict[str, Any] | None = None) -> dict[str, Any]:
    """Return the columns of a job that has come to an end."""
    return {"state": state, "owner": None, "lease_until": None, "problem": problem, "finished_at": now()}


def end_stage(session: Session, job_id: str, state: StageState) -> JobStage | None:
    """Bring the stage that is next or running to a state, and write it down."""
    stage = repository.first_unfinished_stage(session, job_id)
    if stage is None:
        return None
    stage.state = state
    if state is StageState.WAITING:
        stage.started_at, stage.finished_at, stage.progress, stage.detail = None, None, 0.0, None
    elif stage.started_at is not None:
        stage.finished_at = now()
    note_stage(session, job_id, stage)
    return stage


def note_stage(session: Session, job_id: str, stage: JobStage) -> None:
    """Write down that a stage changed."""
    job = repository.present(session, job_id)
    repository.add_event(session, job, EventKind.STAGE, stage_view(stage).model_dump(mode="json"), now())


def note_state(session: Session, job_id: str) -> None:
    """Write down that a job changed its state."""
    job = repository.present(session, job_id)
    data = {"state": job.state, "attempt": job.attempt, "problem": job.problem}
    repository.add_event(session, job, EventKind.STATE, data, now())


def stage_view(stage: JobStage) -> StageView:
    """Return a stage as the API shows it."""
    end = stage.finished_at or now()
    seconds = None if stage.started_at is None else (end - stage.started_at).total_seconds()
    return StageView(
        name=stage.name,
        state=stage.state,
        started_at=stage.started_at,
        finished_at=stage.finished_at,
        seconds=seconds,
        progress=stage.progress,
        detail=stage.detail,
    )
