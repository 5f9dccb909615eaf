"""SQL of the uploads."""

from __future__ import annotations

from collections.abc import Sequence
from datetime import datetime

from sqlalchemy import select
from sqlalchemy.orm import Session

from app.storage.locks import row_lock
from app.storage.paging import Page, newest_first
from app.uploads.models import Upload, UploadState


def upload(session: Session, upload_id: str, *, lock: bool = False) -> Upload | None:
    """Return an upload; with ``lock`` nobody else changes it until the transaction ends."""
    return session.get(Upload, upload_id, with_for_update=row_lock(lock), populate_existing=lock)


def uploads(session: Session, cursor: str | None, limit: int) -> Page[Upload]:
    """Return one page of the uploads, newest first."""
    return newest_first(session, select(Upload), Upload.created_at, Upload.id, cursor, limit)


def with_content(session: Session, content_key: str) -> Upload | None:
    """Return the first complete upload of a content."""
    return session.scalars(select(Upload).where(Upload.content_key == content_key)).first()


def of_car(session: Session, car_id: str) -> Sequence[Upload]:
    """Return all uploads of a car."""
    return session.scalars(select(Upload).where(Upload.car_id == car_id)).all()


def receiving(session: Session) -> Sequence[Upload]:
    """Return all uploads still being received."""
    return session.scalars(select(Upload).where(Upload.state == UploadState.RECEIVING)).all()


def expired(session: Session, moment: datetime) -> Sequence[Upload]:
    """Return the uploads that have rested for too long."""
    statement = select(Upload).where(Upload.state == UploadState.RECEIVING, Upload.expires_at < moment)
    return session.scalars(statement).all()


def known_ids(session: Session, upload_ids: Sequence[str]) -> set[str]:
    """Return those of some identifiers that are still being received."""
    receiving_ids = select(Upload.id).where(Upload.id.in_(upload_ids), Upload.state == UploadState.RECEIVING)
    return set(session.scalars(receiving_ids))
