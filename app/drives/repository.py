"""SQL of the drives."""

from __future__ import annotations

from collections.abc import Collection, Sequence

from sqlalchemy import select
from sqlalchemy.orm import Session, undefer

from app.drives.models import Drive, DriveRun, Work
from app.storage.locks import row_lock
from app.storage.paging import Page, newest_first


def drive(session: Session, drive_id: str, *, whole: bool = False, lock: bool = False) -> Drive | None:
    """Return a drive, with its documents when ``whole``; with ``lock`` nobody else changes it meanwhile."""
    documents = (undefer(Drive.problem), undefer(Drive.engine)) if whole else ()
    return session.get(Drive, drive_id, options=documents, with_for_update=row_lock(lock))


def page(session: Session, *, car_id: str | None, kind: str | None, cursor: str | None, limit: int) -> Page[Drive]:
    """Return one page of the drives, newest first."""
    query = select(Drive)
    if car_id is not None:
        query = query.where(Drive.car_id == car_id)
    if kind is not None:
        query = query.where(Drive.kind == kind)
    return newest_first(session, query, Drive.created_at, Drive.id, cursor, limit)


def run(session: Session, job_id: str) -> DriveRun | None:
    """Return what a job works out."""
    return session.get(DriveRun, job_id)


def runs(session: Session, drive_ids: Collection[str]) -> Sequence[DriveRun]:
    """Return everything that was asked about some drives, oldest first."""
    of_drives = select(DriveRun).where(DriveRun.drive_id.in_(drive_ids))
    return session.scalars(of_drives.order_by(DriveRun.created_at, DriveRun.job_id)).all()


def newest_run(session: Session, drive_id: str, work: Work, *, done: bool = False) -> DriveRun | None:
    """Return the newest run of a kind, with ``done`` the newest that has a result."""
    query = select(DriveRun).where(DriveRun.drive_id == drive_id, DriveRun.work == work)
    if done:
        query = query.where(DriveRun.document_key.is_not(None))
    return session.scalars(query.order_by(DriveRun.created_at.desc(), DriveRun.job_id).limit(1)).first()


def known_ids(session: Session, drive_ids: Collection[str]) -> set[str]:
    """Return those of some identifiers that are drives."""
    return set(session.scalars(select(Drive.id).where(Drive.id.in_(drive_ids))))
