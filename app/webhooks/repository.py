"""SQL of the webhooks. Whoever tries a delivery changes its row by an UPDATE that states what the row must still be."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Sequence
from datetime import datetime
from typing import Any

from sqlalchemy import CursorResult, delete, func, or_, select, update
from sqlalchemy.orm import Session

from app.storage.locks import row_lock
from app.storage.paging import Page, newest_first
from app.webhooks.models import Delivery, DeliveryState, Webhook


def webhook(session: Session, webhook_id: str, *, lock: bool = False) -> Webhook | None:
    """Return a webhook as the database has it now; with ``lock`` nobody else changes it until the commit."""
    return session.get(Webhook, webhook_id, with_for_update=row_lock(lock), populate_existing=True)


def page(session: Session, cursor: str | None, limit: int) -> Page[Webhook]:
    """Return one page of the webhooks, newest first."""
    return newest_first(session, select(Webhook), Webhook.created_at, Webhook.id, cursor, limit)


def count(session: Session) -> int:
    """Return how many webhooks there are."""
    return session.scalar(select(func.count(Webhook.id))) or 0


def active_by_fleet(session: Session) -> dict[str, list[Webhook]]:
    """Return the webhooks that are switched on, by fleet; none of them can be removed until the transaction ends."""
    query = select(Webhook).where(Webhook.active).order_by(Webhook.created_at, Webhook.id)
    found: dict[str, list[Webhook]] = defaultdict(list)
    for row in session.scalars(query.with_for_update(read=True, key_share=True)):
        found[row.fleet_id].append(row)
    return found


def delivery(session: Session, delivery_id: str) -> Delivery | None:
    """Return a delivery as the database has it now."""
    return session.get(Delivery, delivery_id, populate_existing=True)


def deliveries(session: Session, webhook_id: str, cursor: str | None, limit: int) -> Page[Delivery]:
    """Return one page of a webhook's deliveries, newest first."""
    query = select(Delivery).where(Delivery.webhook_id == webhook_id)
    return newest_first(session, query, Delivery.created_at, Delivery.id, cursor, limit)


def due(session: Session, moment: datetime, limit: int) -> Sequence[Delivery]:
    """Return deliveries that may be tried, to webhooks that are switched on and don't rest, the longest due first."""
    ready = or_(Webhook.rests_until.is_(None), Webhook.rests_until <= moment)
    query = select(Delivery).join(Webhook, Webhook.id == Delivery.webhook_id).where(Webhook.active, ready)
    query = query.where(Delivery.state == DeliveryState.WAITING, Delivery.next_try_at <= moment)
    return session.scalars(query.order_by(Delivery.next_try_at, Delivery.id).limit(limit)).all()


def take(session: Session, delivery_id: str, moment: datetime, until: datetime) -> bool:
    """Make a due delivery one's own until a moment; of several that try at once, one succeeds."""
    due_still = (
        Delivery.id == delivery_id,
        Delivery.state == DeliveryState.WAITING,
        Delivery.next_try_at <= moment,
    )
    values = {"attempts": Delivery.attempts + 1, "next_try_at": until, "tried_at": moment}
    return _changed(session, due_still, **values)


def settle(session: Session, delivery_id: str, attempt: int, /, **values: Any) -> bool:
    """Write down how a try ended, unless the delivery has been tried again or is over since."""
    same = (Delivery.id == delivery_id, Delivery.attempts == attempt, Delivery.state == DeliveryState.WAITING)
    return _changed(session, same, **values)


def forget_deliveries(session: Session, before: datetime) -> int:
    """Remove deliveries that are over and were made before a moment; return how many."""
    over = (Delivery.state != DeliveryState.WAITING, Delivery.created_at < before)
    statement = delete(Delivery).where(*over).execution_options(synchronize_session=False)
    result = session.execute(statement)
    return result.rowcount if isinstance(result, CursorResult) else 0


def _changed(session: Session, conditions: Sequence[Any], **values: Any) -> bool:
    statement = update(Delivery).where(*conditions).values(**values).execution_options(synchronize_session=False)
    result = session.execute(statement)
    return isinstance(result, CursorResult) and result.rowcount == 1
