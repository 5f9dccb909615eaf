"""From something that happened to one delivery for each webhook that wants to hear of it."""

from __future__ import annotations

import json
from typing import Any

from sqlalchemy.orm import Session

from app.storage.base import new_id, now
from app.storage.outbox import enqueue
from app.storage.tenancy import fleet_of
from app.webhooks import repository
from app.webhooks.models import EVENTS, TEST, Delivery, Webhook

TASK = "ponthy.deliver"
"""Name of the task that tries a delivery."""


def publish(session: Session, event: str, data: dict[str, Any], *, fleet_id: str | None = None) -> None:
    """Have every webhook that asks for an event told of it, once the session's transaction is committed.

    Call it in the transaction that makes the event true; without its commit nobody hears of anything.

    Parameters
    ----------
    session : Session
    event : str
        One of `EVENTS`.
    data : dict
        What to tell, JSON-able; a number that is not finite becomes null.
    fleet_id : str, optional
        Whose event it is, where a system session tells it; otherwise that of the session.
    """
    if event not in EVENTS:
        raise ValueError(f"{event!r} is not an event that webhooks know")
    webhooks = repository.active_by_fleet(session).get(fleet_id or fleet_of(session), [])
    event_id = new_id()
    for webhook in webhooks:
        if event in webhook.events:
            send(session, webhook, event, data, event_id)


def send_test(session: Session, webhook: Webhook) -> Delivery:
    """Send a test to one webhook, at once, even if it fails or is switched off at the moment."""
    webhook.rests_until = None
    return send(session, webhook, TEST, {"message": "This is a test. Nothing happened."}, new_id())


def send(session: Session, webhook: Webhook, event: str, data: dict[str, Any], event_id: str) -> Delivery:
    """Put an event on its way to one webhook; to one that rests it goes later."""
    moment = now()
    delivery = Delivery(
        id=new_id(),
        fleet_id=webhook.fleet_id,
        webhook_id=webhook.id,
        event_id=event_id,
        event=event,
        payload={
            "id": event_id,
            "event": event,
            "created_at": moment.isoformat().replace("+00:00", "Z"),
            "data": json.loads(json.dumps(data), parse_constant=lambda _: None),
        },
        next_try_at=moment,
        created_at=moment,
    )
    session.add(delivery)
    session.flush()
    if webhook.rests_until is None or webhook.rests_until <= moment:
        offer(session, delivery)
    return delivery


def offer(session: Session, delivery: Delivery) -> None:
    """Have the queue told, after the commit, that a delivery is due."""
    enqueue(session, TASK, fleet_id=delivery.fleet_id, delivery_id=delivery.id)
