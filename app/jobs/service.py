"""What others do with jobs: make, look up, cancel, retry; and, for workers, the steps of `app.jobs.leases`."""

from __future__ import annotations

from collections.abc import Collection, Iterable, Sequence
from datetime import timedelta
from typing import Any

from sqlalchemy.orm import Session

from app.errors import Conflict, NotFound
from app.jobs import repository
from app.jobs.belonging import (
    forget_battery,
    forget_drive,
    lock_of_battery,
    lock_of_car,
    lock_of_drive,
    lock_of_trip,
)
from app.jobs.leases import Claim, advance, claim, fail, finish, need_care, put_off, recover, redeliver, renew, stop
from app.jobs.models import OPEN_STATES, EventKind, Job, JobKind, JobStage, JobState, StageState
from app.jobs.progress import JobCancelled, LeaseLost, Progress, Store
from app.jobs.schemas import JobView
from app.jobs.transitions import end_stage, note_state, offer, over, stage_view
from app.schemas import Listing
from app.storage.base import new_id, now
from app.storage.database import Database
from app.storage.tenancy import fleet_of

__all__ = [
    "Claim",
    "JobCancelled",
    "JobView",
    "LeaseLost",
    "Progress",
    "Store",
    "advance",
    "cancel",
    "claim",
    "counts",
    "create_battery_job",
    "create_demo_job",
    "create_drive_job",
    "create_map_job",
    "create_score_job",
    "create_trip_job",
    "demo_job_id",
    "fail",
    "finish",
    "forget_battery",
    "forget_drive",
    "forget_steps",
    "get",
    "is_idle",
    "lock_of_battery",
    "lock_of_car",
    "lock_of_drive",
    "lock_of_trip",
    "need_care",
    "newest_of_batteries",
    "newest_of_trips",
    "page",
    "put_off",
    "recover",
    "redeliver",
    "renew",
    "require_no_open_job",
    "retry",
    "stop",
    "with_ids",
]

EVENTS_AT_ONCE = 1000
TRIP_STAGES = ("decode", "observe", "map", "health", "battery", "score")
MAP_STAGES = ("map", "health")
SCORE_STAGES = ("score",)
DEMO_STAGES = ("cars", "short trip", "town", "motorway", "commutes", "full load", "roof box", "mixed hour")


def create_trip_job(session: Session, *, trip_id: str, car_id: str, title: str, done: Collection[str] = ()) -> JobView:
    """Make the job that takes a trip from its bytes to its score; stages in ``done`` count as finished."""
    job = Job(kind=JobKind.TRIP, trip_id=trip_id, car_id=car_id, title=title)
    return _create(session, job, TRIP_STAGES, done)


def create_map_job(session: Session, *, car_id: str, title: str) -> JobView:
    """Make the job that rebuilds a car's map and assesses its health.

    One that still waits serves as well, as it will see the latest trips.
    """
    job = repository.open_map_job(session, car_id)
    if job is not None:
        return view(session, [job])[0]
    return _create(session, Job(kind=JobKind.MAP, car_id=car_id, title=title), MAP_STAGES)


def create_score_job(session: Session, *, trip_id: str, car_id: str, title: str) -> JobView:
    """Make the job that scores a trip anew; one that is on its way is returned instead.

    Raises
    ------
    Conflict
        While the trip itself is being worked on, which scores it in the end.
    """
    require_no_open_job(session, trip_id)
    job = repository.open_score_job(session, trip_id)
    if job is not None:
        return view(session, [job])[0]
    return _create(session, Job(kind=JobKind.SCORE, trip_id=trip_id, car_id=car_id, title=title), SCORE_STAGES)


def create_demo_job(session: Session, *, again: bool = True) -> JobView:
    """Make the job that fills the fleet with virtual cars; one that is on its way is returned instead.

    Cars and trips that are there already are not made twice. Without ``again`` a demo that succeeded is enough, even
    if its cars were removed since.
    """
    job = repository.newest(session, JobKind.DEMO)
    if job is not None and (job.state in OPEN_STATES or (job.state == JobState.SUCCEEDED and not again)):
        return view(session, [job])[0]
    return _create(session, Job(kind=JobKind.DEMO, title="Demo cars"), DEMO_STAGES)


def create_drive_job(session: Session, *, drive_id: str, stage: str, title: str) -> JobView:
    """Make a job that does one thing about a drive: ``solve`` it, ``compare`` methods or draw a ``front``."""
    return _create(session, Job(kind=JobKind.DRIVE, drive_id=drive_id, title=title), (stage,))


def create_battery_job(
    session: Session, *, stage: str, title: str, battery_id: str | None, car_id: str | None
) -> JobView:
    """Make a job that does one thing about a battery, or, without one, works out the report's runs."""
    return _create(session, Job(kind=JobKind.BATTERY, battery_id=battery_id, car_id=car_id, title=title), (stage,))


def is_idle(session: Session, car_id: str, rest: timedelta) -> bool:
    """Lock the jobs of a car and say whether all have been over for a while, so that none runs before the commit."""
    repository.lock(session, car_id=car_id)
    return not repository.is_busy(session, car_id, now() - rest)


def forget_steps(database: Database, days: float) -> int:
    """Remove the events of jobs that are over for so long, but for their last state; return how many.

    A few at a time, so that nobody waits long, and none is looked for by a transaction that writes.
    """
    before, forgotten = now() - timedelta(days=days), 0
    while True:
        with database.system_transaction(read_only=True) as session:
            steps = repository.steps_on_the_way(session, before, EVENTS_AT_ONCE)
        if not steps:
            return forgotten
        with database.system_transaction() as session:
            repository.delete_events(session, steps)
        forgotten += len(steps)


def demo_job_id(session: Session) -> str | None:
    """Return the newest demo job of the fleet, if there ever was one."""
    job = repository.newest(session, JobKind.DEMO)
    return None if job is None else job.id


def get(session: Session, job_id: str) -> JobView:
    """Return a job; raises `NotFound`."""
    return view(session, [_job(session, job_id)])[0]


def with_ids(session: Session, job_ids: Iterable[str]) -> dict[str, JobView]:
    """Return those of some jobs that are there, by identifier."""
    return {job.id: job for job in view(session, repository.with_ids(session, job_ids))}


def page(session: Session, *, cursor: str | None = None, limit: int, **wanted: str | None) -> Listing[JobView]:
    """Return one page of the jobs, newest first, of those with the wanted ``state``, ``trip_id``, ``battery_id``…"""
    found = repository.page(session, wanted=wanted, cursor=cursor, limit=limit)
    return Listing(items=view(session, found.items), next_cursor=found.next_cursor)


def newest_of_trips(session: Session, trip_ids: Iterable[str]) -> dict[str, JobView]:
    """Return the newest job that made the results of each trip, by trip."""
    newest = {job.trip_id: job for job in repository.of_trips(session, trip_ids)}
    views = view(session, list(newest.values()))
    return {job.trip_id: job for job in views if job.trip_id is not None}


def newest_of_batteries(session: Session, battery_ids: Iterable[str]) -> dict[str, str]:
    """Return the newest job about each battery, by battery."""
    return {job.battery_id: job.id for job in repository.of_batteries(session, battery_ids) if job.battery_id}


def counts(session: Session) -> dict[str, int]:
    """Return the number of jobs by state."""
    return repository.counts(session)


def make_way(session: Session, job: JobView | None) -> bool:
    """Return whether a trip with this newest job may be worked on; a job that has only to score it is cancelled."""
    if job is None or job.is_over:
        return True
    if any(stage.name not in SCORE_STAGES and stage.state != StageState.SUCCEEDED for stage in job.stages):
        return False
    cancel(session, job.id)
    return True


def require_no_open_job(session: Session, trip_id: str) -> None:
    """Raise `Conflict` while a trip is being worked on; see `make_way`."""
    job = newest_of_trips(session, [trip_id]).get(trip_id)
    if job is not None and not make_way(session, job):
        message = f"The trip is still being worked on by job {job.id}. Wait until it is done, or cancel it first."
        raise Conflict("trip-busy", message)


def cancel(session: Session, job_id: str) -> JobView:
    """Cancel a job: at once while nobody works on it, otherwise as soon as its worker notices.

    Raises
    ------
    NotFound, Conflict
        When there is no such job, or it is over.
    """
    job = _job(session, job_id)
    if repository.change_unowned(session, job_id, OPEN_STATES, **over(JobState.CANCELLED)):
        end_stage(session, job_id, StageState.CANCELLED)
        note_state(session, job_id)
    elif repository.ask_to_cancel(session, job_id):
        repository.add_event(session, job, EventKind.LOG, {"message": "Asked to cancel."}, now())
    else:
        raise Conflict("job-over", f"The job has {job.state} already; there is nothing to cancel.")
    session.flush()
    return get(session, job_id)


def retry(session: Session, job_id: str) -> JobView:
    """Run a failed or cancelled job again from the stage that failed.

    Raises
    ------
    NotFound, Conflict
        When there is no such job, or it neither failed nor was cancelled.
    """
    job = _job(session, job_id)
    if job.trip_id is not None:
        require_no_open_job(session, job.trip_id)
    again: dict[str, Any] = {
        "state": JobState.QUEUED,
        "attempt": 0,
        "problem": None,
        "cancel_requested": False,
        "finished_at": None,
        "offered_at": now(),
    }
    if not repository.change_unowned(session, job_id, (JobState.FAILED, JobState.CANCELLED), **again):
        raise Conflict("job-not-failed", f"The job is {job.state}; only a failed or cancelled one can be retried.")
    end_stage(session, job_id, StageState.WAITING)
    note_state(session, job_id)
    offer(session, job)
    session.flush()
    return get(session, job_id)


def view(session: Session, jobs: Sequence[Job]) -> list[JobView]:
    """Return jobs as the API shows them."""
    stages = repository.stages(session, [job.id for job in jobs])
    return [
        JobView.model_validate(
            {name: getattr(job, name) for name in JobView.model_fields if name != "stages"}
            | {"stages": [stage_view(stage) for stage in stages.get(job.id, [])]}
        )
        for job in jobs
    ]


def _create(session: Session, job: Job, stages: Sequence[str], done: Collection[str] = ()) -> JobView:
    job.id, job.fleet_id, job.state = new_id(), fleet_of(session), JobState.QUEUED
    session.add(job)
    session.flush()
    for position, name in enumerate(stages):
        finished = name in done
        state = StageState.SUCCEEDED if finished else StageState.WAITING
        session.add(JobStage(job_id=job.id, position=position, name=name, state=state, progress=float(finished)))
    note_state(session, job.id)
    session.flush()
    offer(session, job)
    return view(session, [job])[0]


def _job(session: Session, job_id: str) -> Job:
    job = repository.job(session, job_id)
    if job is None:
        raise NotFound("job", job_id)
    return job
