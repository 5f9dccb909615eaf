"""SQL of the jobs. Whoever changes a job row does it by an UPDATE that states what the row must still be."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from datetime import datetime
from typing import Any

from sqlalchemy import CursorResult, delete, func, or_, select, update
from sqlalchemy.orm import Session, aliased

from app.jobs.models import OPEN_STATES, EventKind, Job, JobEvent, JobKind, JobStage, JobState, StageState
from app.storage.paging import Page, newest_first


def job(session: Session, job_id: str) -> Job | None:
    """Return a job as the database has it now, or None."""
    return session.get(Job, job_id, populate_existing=True)


def present(session: Session, job_id: str) -> Job:
    """Return a job that is known to be there, as the database has it now."""
    return session.get_one(Job, job_id, populate_existing=True)


def page(session: Session, *, wanted: Mapping[str, str | None], cursor: str | None, limit: int) -> Page[Job]:
    """Return one page of the jobs, newest first, of those that have the wanted values where there are any."""
    query = select(Job)
    for name, value in wanted.items():
        if value is not None:
            query = query.where(getattr(Job, name) == value)
    return newest_first(session, query, Job.created_at, Job.id, cursor, limit)


def of_trips(session: Session, trip_ids: Iterable[str]) -> Sequence[Job]:
    """Return the jobs that took trips from their bytes to their results, oldest first."""
    made = (Job.trip_id.in_(list(trip_ids)), Job.kind == JobKind.TRIP)
    return session.scalars(select(Job).where(*made).order_by(Job.created_at, Job.id)).all()


def of_batteries(session: Session, battery_ids: Iterable[str]) -> Sequence[Job]:
    """Return the jobs about batteries, oldest first."""
    about = select(Job).where(Job.battery_id.in_(list(battery_ids)))
    return session.scalars(about.order_by(Job.created_at, Job.id)).all()


def with_ids(session: Session, job_ids: Iterable[str]) -> Sequence[Job]:
    """Return those of some jobs that are there, in no order."""
    return session.scalars(select(Job).where(Job.id.in_(list(job_ids)))).all()


def newest(session: Session, kind: JobKind) -> Job | None:
    """Return the newest job of a kind."""
    return session.scalars(select(Job).where(Job.kind == kind).order_by(Job.created_at.desc()).limit(1)).first()


def lock(session: Session, **of: str) -> None:
    """Have nobody change the jobs of a trip, a car, a drive or a battery (``trip_id=…``) until the transaction ends.

    Workers take a job first and what it is about after it; so does whoever removes the two.
    """
    about = [getattr(Job, name) == identifier for name, identifier in of.items()]
    session.execute(select(Job.id).where(*about).order_by(Job.id).with_for_update())


def delete_about(session: Session, **of: str) -> None:
    """Remove the jobs of a drive or a battery (``drive_id=…``), with their stages and events."""
    about = [getattr(Job, name) == identifier for name, identifier in of.items()]
    session.execute(delete(Job).where(*about).execution_options(synchronize_session=False))


def open_map_job(session: Session, car_id: str) -> Job | None:
    """Return a job that will make the car's next map and hasn't begun yet."""
    waiting = (Job.kind == JobKind.MAP, Job.car_id == car_id, Job.state == JobState.QUEUED, Job.owner.is_(None))
    return session.scalars(select(Job).where(*waiting).limit(1)).first()


def open_score_job(session: Session, trip_id: str) -> Job | None:
    """Return a job that waits to score a trip or does so."""
    mine = (Job.kind == JobKind.SCORE, Job.trip_id == trip_id, Job.state.in_(OPEN_STATES))
    return session.scalars(select(Job).where(*mine).limit(1)).first()


def stages(session: Session, job_ids: Iterable[str]) -> dict[str, list[JobStage]]:
    """Return the stages of jobs in their order, by job."""
    found: dict[str, list[JobStage]] = {}
    query = select(JobStage).where(JobStage.job_id.in_(list(job_ids))).order_by(JobStage.job_id, JobStage.position)
    for stage in session.scalars(query.execution_options(populate_existing=True)):
        found.setdefault(stage.job_id, []).append(stage)
    return found


def first_unfinished_stage(session: Session, job_id: str) -> JobStage | None:
    """Return the stage that runs next or is running."""
    query = select(JobStage).where(JobStage.job_id == job_id, JobStage.state != StageState.SUCCEEDED)
    query = query.order_by(JobStage.position).limit(1).execution_options(populate_existing=True)
    return session.scalars(query).first()


def something_else_waits(session: Session, job_id: str, stage: str) -> bool:
    """Whether another job waits for a worker with more before it than a stage of this name."""
    waiting = (Job.state.in_(OPEN_STATES), Job.owner.is_(None), Job.id != job_id)
    before = (JobStage.state != StageState.SUCCEEDED, JobStage.name != stage)
    query = select(JobStage.id).join(Job, Job.id == JobStage.job_id).where(*waiting, *before).limit(1)
    return session.scalar(query) is not None


def take(session: Session, job_id: str, owner: str, moment: datetime, lease_until: datetime) -> bool:
    """Make a waiting job one's own; of several that try at once, one succeeds."""
    waiting = (Job.id == job_id, Job.owner.is_(None), Job.state.in_(OPEN_STATES))
    return _changed(
        session,
        waiting,
        owner=owner,
        lease_until=lease_until,
        state=JobState.RUNNING,
        attempt=Job.attempt + 1,
        started_at=func.coalesce(Job.started_at, moment),
    )


def change_owned(session: Session, job_id: str, owner: str, /, **values: Any) -> bool:
    """Change a job that must still belong to the owner."""
    return _changed(session, (Job.id == job_id, Job.owner == owner), **values)


def change_unowned(session: Session, job_id: str, states: Sequence[JobState], /, **values: Any) -> bool:
    """Change a job that nobody works on and that must be in one of the states."""
    return _changed(session, (Job.id == job_id, Job.owner.is_(None), Job.state.in_(states)), **values)


def ask_to_cancel(session: Session, job_id: str) -> bool:
    """Note that whoever works on the job should stop."""
    return _changed(session, (Job.id == job_id, Job.state == JobState.RUNNING), cancel_requested=True)


def free(session: Session, job: Job, *, attempt: int) -> bool:
    """Take a job from its owner, unless the lease was renewed or the job changed hands since it was read."""
    same = (Job.id == job.id, Job.owner == job.owner, Job.lease_until == job.lease_until)
    return _changed(session, same, owner=None, lease_until=None, attempt=attempt)


def renew_offer(session: Session, job: Job, moment: datetime) -> bool:
    """Note that the queue is told again of a waiting job; of several that try at once, one succeeds."""
    same = (Job.id == job.id, Job.owner.is_(None), Job.offered_at == job.offered_at)
    return _changed(session, same, offered_at=moment)


def held(session: Session, *, expired_at: datetime | None) -> Sequence[Job]:
    """Return jobs that somebody works on; with a moment, only those whose lease is over by then."""
    query = select(Job).where(Job.owner.is_not(None))
    return session.scalars(query if expired_at is None else query.where(Job.lease_until < expired_at)).all()


def waiting(session: Session, *, offered_before: datetime | None = None) -> Sequence[Job]:
    """Return jobs that wait for a worker; with a moment, those of which the queue was last told before it."""
    query = select(Job).where(Job.state.in_(OPEN_STATES), Job.owner.is_(None)).order_by(Job.offered_at)
    return session.scalars(query if offered_before is None else query.where(Job.offered_at < offered_before)).all()


def add_event(session: Session, job: Job, kind: EventKind, data: dict[str, Any], moment: datetime) -> None:
    """Write down what happened; call it after the job row was changed, so that a job's events come in order."""
    session.add(JobEvent(fleet_id=job.fleet_id, job_id=job.id, kind=kind, data=data, created_at=moment))


def events(session: Session, *, after: int, job_id: str | None, limit: int = 500) -> Sequence[JobEvent]:
    """Return events with greater ids, oldest first, of one job or of all."""
    query = select(JobEvent).where(JobEvent.id > after).order_by(JobEvent.id).limit(limit)
    return session.scalars(query if job_id is None else query.where(JobEvent.job_id == job_id)).all()


def steps_on_the_way(session: Session, over_before: datetime, limit: int) -> Sequence[int]:
    """Return the events of jobs that were over by a moment, but for the last state of each and what came after it."""
    later = aliased(JobEvent)
    last = select(func.max(later.id)).where(later.job_id == JobEvent.job_id, later.kind == EventKind.STATE)
    over = select(Job.id).where(Job.state.not_in(OPEN_STATES), Job.finished_at < over_before)
    query = select(JobEvent.id).where(JobEvent.job_id.in_(over), JobEvent.id < last.scalar_subquery())
    return session.scalars(query.order_by(JobEvent.id).limit(limit)).all()


def delete_events(session: Session, event_ids: Sequence[int]) -> None:
    """Remove events."""
    session.execute(delete(JobEvent).where(JobEvent.id.in_(event_ids)).execution_options(synchronize_session=False))


def is_busy(session: Session, car_id: str, since: datetime) -> bool:
    """Whether any job of a car or its trips waits, runs, or came to its end after a moment."""
    busy = or_(Job.state.in_(OPEN_STATES), Job.finished_at > since)
    return session.scalar(select(Job.id).where(Job.car_id == car_id, busy).limit(1)) is not None


def last_event_id(session: Session) -> int:
    """Return the greatest id of an event, 0 when there is none."""
    return session.scalar(select(func.max(JobEvent.id))) or 0


def counts(session: Session) -> dict[str, int]:
    """Return the number of jobs in each state."""
    found = dict(session.execute(select(Job.state, func.count()).group_by(Job.state)).all())
    return {state: found.get(state, 0) for state in JobState}


def _changed(session: Session, conditions: Sequence[Any], **values: Any) -> bool:
    statement = update(Job).where(*conditions).values(**values).execution_options(synchronize_session=False)
    result = session.execute(statement)
    return isinstance(result, CursorResult) and result.rowcount == 1
