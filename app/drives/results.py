"""What became of the work on a drive: its state, why it failed, and the documents that were stored."""

from __future__ import annotations

import json
from typing import Any

from sqlalchemy.orm import Session

from app.drives import repository
from app.drives.models import Drive, Work
from app.drives.schemas import DriveState
from app.errors import Conflict, PonthyError, Problem, from_problem, problem
from app.jobs import service as jobs
from app.storage.blobs import Blobs

STATES: dict[str, DriveState] = {
    "queued": "waiting",
    "running": "solving",
    "succeeded": "solved",
    "cancelled": "cancelled",
}
CANCELLED = Conflict("cancelled", "It was cancelled before there was a result. Retry its job to go on.")
NOUNS = {Work.SOLVE: "answer", Work.COMPARE: "comparison", Work.FRONT: "front"}
UNANSWERED = 422
"""Status of a failure that is the problem's own fault."""


def state_of(job: jobs.JobView | None) -> DriveState:
    """Return how far a drive is, from the job that solves it."""
    if job is not None and job.state == "failed" and (job.problem or {}).get("code") == "infeasible":
        return "infeasible"
    return "failed" if job is None else STATES.get(job.state, "failed")


def failure_of(job: jobs.JobView | None) -> Problem | None:
    """Return why a job has no result, None while it may still have one."""
    if job is None or job.state not in ("failed", "cancelled"):
        return None
    return job.problem or problem(CANCELLED)


def document_of(session: Session, blobs: Blobs, drive: Drive, work: Work) -> dict[str, Any]:
    """Return the newest result of a kind, with what it was made from.

    Raises
    ------
    PonthyError
        When there is none: nobody asked for it, it is still being worked out, or why it failed.
    """
    found = repository.newest_run(session, drive.id, work, done=True)
    if found is None or found.document_key is None:
        raise _missing(session, drive, work)
    document: dict[str, Any] = json.loads(blobs.get(found.document_key))
    return document | {"provenance": found.provenance}


def _missing(session: Session, drive: Drive, work: Work) -> PonthyError:
    newest, noun = repository.newest_run(session, drive.id, work), NOUNS[work]
    if newest is None:
        return Conflict(f"no-{noun}", f"Nobody has asked for a {noun} of this drive yet. POST to …/{work} first.")
    job = jobs.get(session, newest.job_id)
    failure = failure_of(job)
    if failure is None:
        percent = 100.0 * job.stages[0].progress
        message = f"The {noun} is being worked out ({percent:.0f} % done). Ask again soon, or follow job {job.id}."
        return PonthyError(f"{noun}-not-ready", message, 409, headers={"Retry-After": "1"}, job_id=job.id)
    error = from_problem(failure | {"drive_id": drive.id})
    return error if error.status == UNANSWERED else Conflict(error.code, error.message)
