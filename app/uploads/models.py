"""Uploads: files on their way in, and what became of them."""

from __future__ import annotations

from datetime import datetime
from enum import StrEnum
from typing import Any

from sqlalchemy import JSON, BigInteger, ForeignKey, Index, String, UniqueConstraint
from sqlalchemy.orm import Mapped, mapped_column

from app.storage.base import Base, Identifier, new_id, now
from app.storage.tenancy import FleetOwned


class UploadKind(StrEnum):
    """What a file is for."""

    TRIP = "trip"
    ELEVATION = "elevation"


class UploadState(StrEnum):
    """How far an upload has come."""

    RECEIVING = "receiving"
    COMPLETE = "complete"
    FAILED = "failed"


class Upload(FleetOwned, Base):
    """A file being received or received. While it is received its offset is the length of its staging file.

    ``content_key`` is set on the first complete upload of a content for a car only; it is unique per fleet, and so
    decides which of two browsers that send the same file at once makes the trip. The other one's ``duplicate_of``
    names the first; ``duplicate`` says that nothing new came of it. ``blob_key`` is where the bytes are once the upload
    is complete or failed.
    """

    __tablename__ = "uploads"
    __table_args__ = (
        UniqueConstraint("fleet_id", "content_key"),
        Index("ix_uploads_newest", "fleet_id", "created_at", "id"),
    )

    id: Mapped[Identifier] = mapped_column(primary_key=True, default=new_id)
    car_id: Mapped[Identifier | None] = mapped_column(ForeignKey("cars.id", ondelete="CASCADE"), index=True)
    kind: Mapped[str] = mapped_column(String(16))
    filename: Mapped[str] = mapped_column(String(255))
    mapping: Mapped[dict[str, Any] | None] = mapped_column(JSON)
    state: Mapped[str] = mapped_column(String(16), default=UploadState.RECEIVING)
    size: Mapped[int] = mapped_column(BigInteger)
    sha256: Mapped[str | None] = mapped_column(String(64))
    content_key: Mapped[str | None] = mapped_column(String(160))
    blob_key: Mapped[str | None] = mapped_column(String(300))
    duplicate: Mapped[bool] = mapped_column(default=False)
    duplicate_of: Mapped[Identifier | None] = mapped_column(ForeignKey("uploads.id", ondelete="SET NULL"), index=True)
    problem: Mapped[dict[str, Any] | None] = mapped_column(JSON)
    created_at: Mapped[datetime] = mapped_column(default=now)
    updated_at: Mapped[datetime] = mapped_column(default=now)
    expires_at: Mapped[datetime | None] = mapped_column(index=True)
    completed_at: Mapped[datetime | None]
