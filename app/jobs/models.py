"""Tables of the jobs: what is to be done, how far it is, and everything that happened on the way."""

from __future__ import annotations

from datetime import datetime
from enum import StrEnum
from typing import Any

from sqlalchemy import JSON, ForeignKey, Index, String, UniqueConstraint
from sqlalchemy.orm import Mapped, mapped_column

from app.storage.base import Base, Identifier, new_id, now
from app.storage.tenancy import FleetOwned


class JobKind(StrEnum):
    """What a job is about."""

    TRIP = "trip"
    MAP = "map"
    DEMO = "demo"
    SCORE = "score"
    DRIVE = "drive"
    BATTERY = "battery"


class JobState(StrEnum):
    """How far a job is. A queued or running one is open, the others are over."""

    QUEUED = "queued"
    RUNNING = "running"
    SUCCEEDED = "succeeded"
    FAILED = "failed"
    CANCELLED = "cancelled"


OPEN_STATES = (JobState.QUEUED, JobState.RUNNING)


class StageState(StrEnum):
    """How far a stage is."""

    WAITING = "waiting"
    RUNNING = "running"
    SUCCEEDED = "succeeded"
    FAILED = "failed"
    CANCELLED = "cancelled"


class EventKind(StrEnum):
    """What an event tells: a stage or the job changed, a stage got on, or something worth a line happened."""

    STAGE = "stage"
    PROGRESS = "progress"
    LOG = "log"
    STATE = "state"


class Job(FleetOwned, Base):
    """One piece of work in named stages. This row, not the queue, says whether it is done and who does it.

    ``owner`` and ``lease_until`` belong together: set while a worker runs a stage, empty while the job waits for one.
    ``attempt`` counts the tries of the stage that is next or running. ``offered_at`` is when the queue was last told.
    """

    __tablename__ = "jobs"
    __table_args__ = (
        Index("ix_jobs_open", "state", "offered_at"),
        Index("ix_jobs_newest", "fleet_id", "created_at", "id"),
    )

    id: Mapped[Identifier] = mapped_column(primary_key=True, default=new_id)
    kind: Mapped[str] = mapped_column(String(16))
    title: Mapped[str] = mapped_column(String(300))
    state: Mapped[str] = mapped_column(String(16))
    trip_id: Mapped[Identifier | None] = mapped_column(ForeignKey("trips.id", ondelete="CASCADE"), index=True)
    car_id: Mapped[Identifier | None] = mapped_column(ForeignKey("cars.id", ondelete="CASCADE"), index=True)
    drive_id: Mapped[Identifier | None] = mapped_column(ForeignKey("drives.id"), index=True)
    battery_id: Mapped[Identifier | None] = mapped_column(ForeignKey("batteries.id"), index=True)
    attempt: Mapped[int] = mapped_column(default=0)
    owner: Mapped[str | None] = mapped_column(String(32))
    lease_until: Mapped[datetime | None]
    offered_at: Mapped[datetime] = mapped_column(default=now)
    cancel_requested: Mapped[bool] = mapped_column(default=False)
    problem: Mapped[dict[str, Any] | None] = mapped_column(JSON)
    created_at: Mapped[datetime] = mapped_column(default=now)
    started_at: Mapped[datetime | None]
    finished_at: Mapped[datetime | None]


class JobStage(FleetOwned, Base):
    """One named stage of a job; stages run in the order of ``position``."""

    __tablename__ = "job_stages"
    __table_args__ = (UniqueConstraint("job_id", "position"),)

    id: Mapped[int] = mapped_column(primary_key=True, autoincrement=True)
    job_id: Mapped[Identifier] = mapped_column(ForeignKey("jobs.id", ondelete="CASCADE"))
    position: Mapped[int]
    name: Mapped[str] = mapped_column(String(32))
    state: Mapped[str] = mapped_column(String(16))
    progress: Mapped[float] = mapped_column(default=0.0)
    detail: Mapped[str | None] = mapped_column(String(300))
    started_at: Mapped[datetime | None]
    finished_at: Mapped[datetime | None]


class JobEvent(FleetOwned, Base):
    """Something that happened to a job. The ids only ever grow, so a reader can resume after the last one it saw."""

    __tablename__ = "job_events"
    __table_args__ = (Index("ix_job_events_job_id_id", "job_id", "id"), {"sqlite_autoincrement": True})

    id: Mapped[int] = mapped_column(primary_key=True, autoincrement=True)
    job_id: Mapped[Identifier] = mapped_column(ForeignKey("jobs.id", ondelete="CASCADE"))
    kind: Mapped[str] = mapped_column(String(16))
    data: Mapped[dict[str, Any]] = mapped_column(JSON)
    created_at: Mapped[datetime] = mapped_column(default=now)
