"""Tables of the webhooks: whom to tell of what, and what each has been told."""

from __future__ import annotations

from datetime import datetime
from enum import StrEnum
from typing import Any

from sqlalchemy import JSON, ForeignKey, Index, String
from sqlalchemy.orm import Mapped, mapped_column

from app.storage.base import Base, Identifier, new_id, now
from app.storage.tenancy import FleetOwned

EVENTS = ("trip.ready", "trip.failed", "map.updated", "health.alert", "health.cleared", "battery.ready")
"""What a webhook can ask for."""
TEST = "webhook.test"
"""What "Send a test" sends, whatever the webhook asks for."""


class DeliveryState(StrEnum):
    """How far a delivery is; a dead one was tried to the end and is not tried again by itself."""

    WAITING = "waiting"
    DELIVERED = "delivered"
    DEAD = "dead"


class Webhook(FleetOwned, Base):
    """An address that wants to be told of events.

    The secret is kept as it is, because every delivery is signed with it. ``failing_since`` is when the address began
    to refuse what it is sent; until ``rests_until`` nothing is sent there by itself.
    """

    __tablename__ = "webhooks"

    id: Mapped[Identifier] = mapped_column(primary_key=True, default=new_id)
    url: Mapped[str] = mapped_column(String(2000))
    secret: Mapped[str] = mapped_column(String(100))
    events: Mapped[list[str]] = mapped_column(JSON)
    active: Mapped[bool] = mapped_column(default=True)
    description: Mapped[str] = mapped_column(String(200), default="")
    failing_since: Mapped[datetime | None]
    rests_until: Mapped[datetime | None]
    created_at: Mapped[datetime] = mapped_column(default=now)


class Delivery(FleetOwned, Base):
    """One event on its way to one webhook.

    ``next_try_at`` is when it may be taken; whoever takes it puts that off, so that nobody else does meanwhile.
    ``attempts`` counts the tries and fences a late result. The status is that of the last answer, the error says why
    the last try failed.
    """

    __tablename__ = "webhook_deliveries"
    __table_args__ = (
        Index("ix_webhook_deliveries_due", "state", "next_try_at"),
        Index("ix_webhook_deliveries_newest", "webhook_id", "created_at", "id"),
    )

    id: Mapped[Identifier] = mapped_column(primary_key=True, default=new_id)
    webhook_id: Mapped[Identifier] = mapped_column(ForeignKey("webhooks.id", ondelete="CASCADE"))
    event_id: Mapped[Identifier]
    event: Mapped[str] = mapped_column(String(32))
    payload: Mapped[dict[str, Any]] = mapped_column(JSON)
    state: Mapped[str] = mapped_column(String(16), default=DeliveryState.WAITING)
    attempts: Mapped[int] = mapped_column(default=0)
    next_try_at: Mapped[datetime] = mapped_column(default=now)
    tried_at: Mapped[datetime | None]
    status: Mapped[int | None]
    error: Mapped[str | None] = mapped_column(String(500))
    answer: Mapped[str | None] = mapped_column(String(500))
    delivered_at: Mapped[datetime | None]
    created_at: Mapped[datetime] = mapped_column(default=now)
