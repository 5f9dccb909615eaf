"""Tables of the cars' health: the newest assessment of each car, and what was told about it."""

from __future__ import annotations

from datetime import datetime
from enum import StrEnum
from typing import Any

from sqlalchemy import JSON, ForeignKey, Index, String, Text
from sqlalchemy.orm import Mapped, mapped_column

from app.storage.base import Base, Identifier, new_id, now
from app.storage.tenancy import FleetOwned


class AlertState(StrEnum):
    """How an alert stands: open, open but looked at by somebody, or over."""

    OPEN = "open"
    SEEN = "seen"
    CLEARED = "cleared"


class Assessment(FleetOwned, Base):
    """The newest assessment of a car.

    ``key`` names everything it depends on; ``document`` is a `CarHealth` as it writes itself; ``left_out`` are the
    trips it could not count, each with why. Trips that began before ``usual_since`` say nothing of what is usual.
    """

    __tablename__ = "car_health"

    car_id: Mapped[Identifier] = mapped_column(ForeignKey("cars.id", ondelete="CASCADE"), primary_key=True)
    key: Mapped[str | None] = mapped_column(String(64))
    document: Mapped[dict[str, Any] | None] = mapped_column(JSON)
    left_out: Mapped[list[dict[str, Any]]] = mapped_column(JSON, default=list)
    code_version: Mapped[str | None] = mapped_column(String(64))
    assessed_at: Mapped[datetime | None]
    usual_since: Mapped[datetime | None]


class Alert(FleetOwned, Base):
    """A change of a car that was told, from when it was sure enough until it was over.

    ``since_at`` is when the first trip of the change began. ``seen_by`` is who has looked at it, where one logs in.
    """

    __tablename__ = "health_alerts"
    __table_args__ = (
        Index("ix_health_alerts_car_id_state", "car_id", "state"),
        Index("ix_health_alerts_newest", "fleet_id", "created_at", "id"),
    )

    id: Mapped[Identifier] = mapped_column(primary_key=True, default=new_id)
    car_id: Mapped[Identifier] = mapped_column(ForeignKey("cars.id", ondelete="CASCADE"))
    quantity: Mapped[str] = mapped_column(String(32))
    state: Mapped[str] = mapped_column(String(16), default=AlertState.OPEN)
    since_trip_id: Mapped[Identifier | None] = mapped_column(ForeignKey("trips.id", ondelete="SET NULL"))
    since_at: Mapped[datetime]
    trips: Mapped[int]
    change: Mapped[float]
    change_sd: Mapped[float]
    unit: Mapped[str] = mapped_column(String(16))
    chance: Mapped[float]
    other: Mapped[str] = mapped_column(String(32))
    words: Mapped[str] = mapped_column(Text)
    advice: Mapped[str] = mapped_column(Text)
    seen_at: Mapped[datetime | None]
    seen_by: Mapped[str | None] = mapped_column(String(320))
    cleared_at: Mapped[datetime | None]
    cleared_words: Mapped[str] = mapped_column(Text, default="")
    created_at: Mapped[datetime] = mapped_column(default=now)
