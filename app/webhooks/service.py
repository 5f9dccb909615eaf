"""What others may ask of the webhooks: keep them, tell them of events, and see what each was told."""

from __future__ import annotations

from collections.abc import Sequence

from sqlalchemy.orm import Session

from app.errors import Conflict, Invalid, NotFound
from app.settings import Settings
from app.storage.base import now
from app.storage.paging import Page
from app.webhooks import repository
from app.webhooks.addresses import Reach, parse_url
from app.webhooks.delivering import deliver, deliver_due, forget
from app.webhooks.models import EVENTS, Delivery, DeliveryState, Webhook
from app.webhooks.publishing import offer, publish, send_test
from app.webhooks.schemas import WebhookChange
from app.webhooks.signing import new_secret

__all__ = [
    "add",
    "change",
    "deliver",
    "deliver_again",
    "deliver_due",
    "deliveries",
    "forget",
    "get",
    "new_secret_of",
    "page",
    "publish",
    "remove",
    "test",
]

MOST = 20
"""Webhooks that a fleet may have."""


def add(session: Session, settings: Settings, *, url: str, events: Sequence[str], description: str) -> Webhook:
    """Make a webhook; its secret stands in the row and is to be shown this once.

    Raises
    ------
    Invalid
        When the URL leads where no webhook may go, or an event is unknown.
    Conflict
        When the fleet has as many as it may have.
    """
    parse_url(url, Reach.of(settings))
    if repository.count(session) >= MOST:
        raise Conflict("too-many-webhooks", f"There are {MOST} webhooks already. Remove one that nobody needs.")
    row = Webhook(url=url, secret=new_secret(), events=_known(events), description=description)
    session.add(row)
    session.flush()
    return row


def page(session: Session, cursor: str | None, limit: int) -> Page[Webhook]:
    """Return one page of the fleet's webhooks, newest first."""
    return repository.page(session, cursor, limit)


def get(session: Session, webhook_id: str, *, lock: bool = False) -> Webhook:
    """Return a webhook; raises `NotFound`."""
    row = repository.webhook(session, webhook_id, lock=lock)
    if row is None:
        raise NotFound("webhook", webhook_id)
    return row


def change(session: Session, settings: Settings, webhook_id: str, wanted: WebhookChange) -> Webhook:
    """Change what is given of a webhook; raises `NotFound` and `Invalid` as `add` does."""
    row = get(session, webhook_id, lock=True)
    if wanted.url is not None and wanted.url != row.url:
        parse_url(wanted.url, Reach.of(settings))
        row.url, row.failing_since, row.rests_until = wanted.url, None, None
    if wanted.events is not None:
        row.events = _known(wanted.events)
    if wanted.active is not None:
        row.active = wanted.active
    if wanted.description is not None:
        row.description = wanted.description
    session.flush()
    return row


def new_secret_of(session: Session, webhook_id: str) -> Webhook:
    """Give a webhook a new secret, to be shown this once; the old one signs nothing from now on."""
    row = get(session, webhook_id, lock=True)
    row.secret = new_secret()
    session.flush()
    return row


def remove(session: Session, webhook_id: str) -> None:
    """Remove a webhook with all it was told; raises `NotFound`."""
    session.delete(get(session, webhook_id, lock=True))


def test(session: Session, webhook_id: str) -> Delivery:
    """Send a test to a webhook; raises `NotFound`."""
    return send_test(session, get(session, webhook_id, lock=True))


def deliveries(session: Session, webhook_id: str, cursor: str | None, limit: int) -> Page[Delivery]:
    """Return one page of what a webhook was told, newest first; raises `NotFound`."""
    get(session, webhook_id)
    return repository.deliveries(session, webhook_id, cursor, limit)


def deliver_again(session: Session, webhook_id: str, delivery_id: str) -> Delivery:
    """Send the same once more, at once: from the beginning when it was over, before its time when it waits.

    Raises
    ------
    NotFound
        When there is no such delivery.
    Conflict
        When the webhook is switched off.
    """
    webhook = get(session, webhook_id, lock=True)
    row = repository.delivery(session, delivery_id)
    if row is None or row.webhook_id != webhook_id:
        raise NotFound("delivery", delivery_id)
    if not webhook.active:
        raise Conflict("webhook-inactive", "The webhook is switched off. Switch it on first.")
    if row.state != DeliveryState.WAITING:
        row.state, row.attempts, row.delivered_at = DeliveryState.WAITING, 0, None
        row.status, row.error, row.answer = None, None, None
    row.next_try_at, webhook.rests_until = now(), None
    session.flush()
    offer(session, row)
    return row


def _known(events: Sequence[str]) -> list[str]:
    unknown = [event for event in events if event not in EVENTS]
    if unknown or not events:
        said = f"There is no event {unknown[0]!r}." if unknown else "A webhook without events hears nothing."
        raise Invalid("bad-webhook-events", f"{said} Choose from {', '.join(EVENTS)}.", field="events")
    return [event for event in EVENTS if event in events]
