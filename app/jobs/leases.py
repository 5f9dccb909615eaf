"""What workers do with jobs: take the next stage, hold it, bring it to an end; and what is done for dead workers.

A worker holds a job by an owner token and a lease that it renews. Whatever it writes is fenced by the token: after the
lease ran out and somebody else took the job, its late result is refused.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from datetime import timedelta
from typing import Any

from sqlalchemy.orm import Session

from app.jobs import repository
from app.jobs.models import OPEN_STATES, EventKind, Job, JobKind, JobState, StageState
from app.jobs.progress import JobCancelled, LeaseLost
from app.jobs.transitions import end_stage, note_stage, note_state, offer, over
from app.storage.base import new_id, now

CAN_WAIT = (JobKind.TRIP, "score")
PATIENCE = timedelta(minutes=30)


@dataclass(frozen=True, slots=True)
class Claim:
    """A stage of a job that this worker holds."""

    job_id: str
    kind: str
    trip_id: str | None
    car_id: str | None
    drive_id: str | None
    battery_id: str | None
    stage: str
    owner: str
    attempt: int


def put_off(session: Session, job_id: str) -> bool:
    """Put a job whose next stage can wait behind all others of its fleet; return whether that was done.

    A trip is there before it has a score, and what its score is compared with grows with the trips that wait. One that
    has been on its way for long is not put off any more.
    """
    job, stage = repository.job(session, job_id), repository.first_unfinished_stage(session, job_id)
    if job is None or stage is None or (job.kind, stage.name) != CAN_WAIT or job.state not in OPEN_STATES:
        return False
    if job.created_at < now() - PATIENCE or not repository.something_else_waits(session, job_id, stage.name):
        return False
    if repository.renew_offer(session, job, now()):
        offer(session, job)
    return True


def claim(session: Session, job_id: str, lease_s: float) -> Claim | None:
    """Take the next stage of a job, or return None when somebody has it or the job is over."""
    owner, moment = new_id(), now()
    if not repository.take(session, job_id, owner, moment, moment + timedelta(seconds=lease_s)):
        return None
    job = repository.present(session, job_id)
    stage = repository.first_unfinished_stage(session, job_id)
    if stage is None:
        raise RuntimeError(f"job {job_id} is open but has no stage left")
    stage.state, stage.started_at, stage.finished_at, stage.progress = StageState.RUNNING, moment, None, 0.0
    note_state(session, job_id)
    note_stage(session, job_id, stage)
    about = job.trip_id, job.car_id, job.drive_id, job.battery_id
    return Claim(job_id, job.kind, *about, stage.name, owner, job.attempt)


def renew(session: Session, held: Claim, lease_s: float) -> None:
    """Hold a stage for another lease.

    Raises
    ------
    LeaseLost, JobCancelled
        When the job is somebody else's by now, or should stop.
    """
    _change(session, held, lease_until=now() + timedelta(seconds=lease_s))
    if repository.present(session, held.job_id).cancel_requested:
        raise JobCancelled


def advance(session: Session, held: Claim, fraction: float, detail: str | None) -> None:
    """Write down how far a stage is.

    Raises
    ------
    LeaseLost, JobCancelled
        When the job is somebody else's by now, or should stop.
    """
    _change(session, held)
    job = repository.present(session, held.job_id)
    if job.cancel_requested:
        raise JobCancelled
    stage = repository.first_unfinished_stage(session, held.job_id)
    if stage is not None:
        stage.progress, stage.detail = min(max(fraction, 0.0), 1.0), detail
        data = {"stage": held.stage, "progress": stage.progress, "detail": detail}
        repository.add_event(session, job, EventKind.PROGRESS, data, now())


def finish(session: Session, held: Claim, detail: str | None = None) -> None:
    """Close a stage, with a last word on it; the job goes on to its next one, or has succeeded. Raises `LeaseLost`.

    Call it first in the transaction that stores the result, so that a result that comes too late is refused.
    """
    _change(session, held, owner=None, lease_until=None, attempt=0, offered_at=now())
    stage = repository.first_unfinished_stage(session, held.job_id)
    if stage is not None:
        stage.progress, stage.detail = 1.0, detail
    end_stage(session, held.job_id, StageState.SUCCEEDED)
    session.flush()
    job = repository.present(session, held.job_id)
    if repository.first_unfinished_stage(session, held.job_id) is None:
        repository.change_unowned(session, held.job_id, OPEN_STATES, **over(JobState.SUCCEEDED))
        note_state(session, held.job_id)
    elif job.cancel_requested:
        _cancel(session, job)
    else:
        offer(session, job)


def fail(session: Session, held: Claim, problem: dict[str, Any]) -> None:
    """Close a stage and its job as failed; raises `LeaseLost`."""
    _change(session, held, **over(JobState.FAILED, problem))
    end_stage(session, held.job_id, StageState.FAILED)
    note_state(session, held.job_id)


def stop(session: Session, held: Claim) -> None:
    """Close a stage and its job as cancelled; raises `LeaseLost`."""
    _change(session, held, **over(JobState.CANCELLED))
    end_stage(session, held.job_id, StageState.CANCELLED)
    note_state(session, held.job_id)


def need_care(session: Session, redeliver_after_s: float) -> bool:
    """Whether `recover` or `redeliver` might have anything to do, without locking anything."""
    overdue = now() - timedelta(seconds=redeliver_after_s)
    return bool(repository.held(session, expired_at=now()) or repository.waiting(session, offered_before=overdue))


def recover(
    session: Session,
    max_attempts: int,
    *,
    everything: bool = False,
    gave_up: Callable[[str, str], None] | None = None,
) -> int:
    """Free the jobs whose worker stopped renewing its lease, for another worker; return how many.

    Parameters
    ----------
    session : Session
        A system session: this is done for all fleets.
    max_attempts : int
        A stage that lost so many workers fails instead of being tried again.
    everything : bool
        Free every held job, for a start at which no worker can be alive. That Ponthy ended is not the stage's fault,
        so it doesn't count as an attempt.
    gave_up : callable, optional
        Told fleet and job of each job that failed by this, in the same transaction.
    """
    freed = 0
    for job in repository.held(session, expired_at=None if everything else now()):
        if not repository.free(session, job, attempt=job.attempt - 1 if everything else job.attempt):
            continue
        freed += 1
        lost = "Ponthy was stopped." if everything else f"The worker stopped answering in attempt {job.attempt}."
        repository.add_event(session, job, EventKind.LOG, {"message": lost}, now())
        if job.cancel_requested:
            _cancel(session, job)
        elif job.attempt >= max_attempts and not everything:
            _give_up(session, job)
            if gave_up is not None:
                gave_up(job.fleet_id, job.id)
        else:
            end_stage(session, job.id, StageState.WAITING)
            repository.renew_offer(session, job, now())
            offer(session, job)
    return freed


def redeliver(session: Session, after_s: float, *, messages: int) -> int:
    """Tell the queue again of jobs that wait although it has forgotten some of them; return how many.

    Messages get lost when a worker is killed, when the queue's folder is deleted, or between a commit and the
    sending. Which one is lost can't be told, so all that wait for a while are offered again; the extra messages
    are refused as soon as a worker takes them.

    Parameters
    ----------
    session : Session
        A system session.
    after_s : float
        A job is left alone for so long after it was offered.
    messages : int
        How many messages the queue holds. With one for each waiting job, none is lost.
    """
    if messages >= len(repository.waiting(session)):
        return 0
    sent = 0
    for job in repository.waiting(session, offered_before=now() - timedelta(seconds=after_s)):
        if repository.renew_offer(session, job, now()):
            offer(session, job)
            sent += 1
    return sent


def _change(session: Session, held: Claim, **values: Any) -> None:
    if not repository.change_owned(session, held.job_id, held.owner, **(values or {"owner": held.owner})):
        raise LeaseLost(f"job {held.job_id} is not held by {held.owner} any more")


def _cancel(session: Session, job: Job) -> None:
    repository.change_unowned(session, job.id, OPEN_STATES, **over(JobState.CANCELLED))
    end_stage(session, job.id, StageState.CANCELLED)
    note_state(session, job.id)


def _give_up(session: Session, job: Job) -> None:
    detail = (
        f"The worker died {job.attempt} times in this stage, so it was not tried again. It may need more memory than "
        "there is; look into the server's log, then retry the job."
    )
    problem = {"type": "urn:ponthy:problem:worker-lost", "title": "Worker lost", "status": 500, "detail": detail}
    repository.change_unowned(session, job.id, OPEN_STATES, **over(JobState.FAILED, problem | {"code": "worker-lost"}))
    end_stage(session, job.id, StageState.FAILED)
    note_state(session, job.id)
