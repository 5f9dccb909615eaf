"""Tables of the drives: what was posed, and what was worked out about it."""

from __future__ import annotations

from datetime import datetime
from enum import StrEnum
from typing import Any

from sqlalchemy import JSON, ForeignKey, Index, String
from sqlalchemy.orm import Mapped, mapped_column

from app.storage.base import Base, Identifier, new_id, now
from app.storage.tenancy import FleetOwned


class Work(StrEnum):
    """What can be worked out about a drive; also the name of the job's stage that does it."""

    SOLVE = "solve"
    COMPARE = "compare"
    FRONT = "front"


class Drive(FleetOwned, Base):
    """A drive problem and, in short, its newest answer.

    ``problem`` is the document as it was posed. Where its engine names a car's map, ``engine`` is what that became and
    ``map`` says which version; ``problem_sha256`` is of the problem with that engine. A drive outlives its car.
    """

    __tablename__ = "drives"
    __table_args__ = (Index("ix_drives_newest", "fleet_id", "created_at", "id"),)

    id: Mapped[Identifier] = mapped_column(primary_key=True, default=new_id)
    name: Mapped[str] = mapped_column(String(200))
    kind: Mapped[str] = mapped_column(String(16))
    car_id: Mapped[Identifier | None] = mapped_column(ForeignKey("cars.id", ondelete="SET NULL"), index=True)
    problem: Mapped[dict[str, Any]] = mapped_column(JSON, deferred=True)
    engine: Mapped[dict[str, Any] | None] = mapped_column(JSON, deferred=True)
    map: Mapped[dict[str, Any] | None] = mapped_column(JSON)
    problem_sha256: Mapped[str] = mapped_column(String(64))
    fuel_energy_j: Mapped[float | None]
    time_s: Mapped[float | None]
    distance_m: Mapped[float | None]
    verdict: Mapped[str | None] = mapped_column(String(32))
    created_at: Mapped[datetime] = mapped_column(default=now)


class DriveRun(FleetOwned, Base):
    """One piece of work on a drive, done by one job; its result lies in the blobs under ``document_key``."""

    __tablename__ = "drive_runs"
    __table_args__ = (Index("ix_drive_runs_drive_id_work", "drive_id", "work"),)

    job_id: Mapped[Identifier] = mapped_column(ForeignKey("jobs.id", ondelete="CASCADE"), primary_key=True)
    drive_id: Mapped[Identifier] = mapped_column(ForeignKey("drives.id", ondelete="CASCADE"))
    work: Mapped[str] = mapped_column(String(16))
    options: Mapped[dict[str, Any]] = mapped_column(JSON)
    document_key: Mapped[str | None] = mapped_column(String(300))
    provenance: Mapped[dict[str, Any] | None] = mapped_column(JSON)
    created_at: Mapped[datetime] = mapped_column(default=now)
