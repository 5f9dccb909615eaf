"""Trying deliveries: sign, send, write down how it ended, and when to try again."""

from __future__ import annotations

import json
import time
from dataclasses import dataclass
from datetime import timedelta
from typing import Any

import structlog

from app import __version__
from app.errors import Invalid
from app.storage.base import now
from app.storage.resources import Resources
from app.webhooks import repository
from app.webhooks.addresses import OutOfReach, Reach, addresses_of, parse_url
from app.webhooks.models import TEST, DeliveryState
from app.webhooks.sending import KEPT_ANSWER, Answer, NotAnswered, post
from app.webhooks.signing import signature

PAUSES_S = (10, 30, 60, 300, 900, 1800, 3600, 7200, 14400, 28800, 28800)
"""From one try to the next: about a day in all, then the delivery is dead."""
LONGEST_REST_S = 60
"""An address that just failed is left alone for the delivery's pause, but not longer than this."""
HELD = timedelta(seconds=120)
"""Whoever takes a delivery has it for so long; looking up a slow name and the longest try end well before."""
AT_ONCE = 50

log = structlog.get_logger(__name__)


@dataclass(frozen=True, slots=True)
class Errand:
    """A delivery that this process tries, with what it needs of its webhook."""

    delivery_id: str
    webhook_id: str
    event: str
    attempt: int
    url: str
    secret: str
    body: bytes


@dataclass(frozen=True, slots=True)
class Outcome:
    """How a try ended: the answer, or why there is none."""

    answer: Answer | None
    error: str | None

    @property
    def delivered(self) -> bool:
        """Whether the receiver took it."""
        return self.error is None


def deliver(resources: Resources, fleet_id: str, delivery_id: str) -> str:
    """Try a delivery, if it is due and nobody else is at it.

    Returns
    -------
    str
        ``refused`` when it is not to be had, else ``delivered``, ``failed`` or ``dead``.
    """
    errand = _take(resources, fleet_id, delivery_id)
    if errand is None:
        return "refused"
    outcome = _try(errand, Reach.of(resources.settings))
    state = _settle(resources, fleet_id, errand, outcome)
    status = None if outcome.answer is None else outcome.answer.status
    log.info("webhook", event_name=errand.event, webhook_id=errand.webhook_id, attempt=errand.attempt, status=status)
    return state


def deliver_due(resources: Resources) -> int:
    """Try what is due and was forgotten by the queue or failed before; return how many were tried.

    Any number of processes may do this at once, as a delivery is taken by one of them.
    """
    settings = resources.settings
    overdue = now() - timedelta(seconds=settings.redeliver_s)  # until then a worker may yet come to it by itself
    with resources.database.system_transaction(read_only=True) as session:
        waiting = [(row.fleet_id, row.id) for row in repository.due(session, overdue, AT_ONCE)]
    return sum(deliver(resources, fleet_id, delivery_id) != "refused" for fleet_id, delivery_id in waiting)


def forget(resources: Resources, days: float) -> int:
    """Remove deliveries that have been over for so long; return how many."""
    with resources.database.system_transaction() as session:
        return repository.forget_deliveries(session, now() - timedelta(days=days))


def _take(resources: Resources, fleet_id: str, delivery_id: str) -> Errand | None:
    moment = now()
    with resources.database.transaction(fleet_id) as session:
        row = repository.delivery(session, delivery_id)
        webhook = None if row is None else repository.webhook(session, row.webhook_id)
        if row is None or webhook is None or not (webhook.active or row.event == TEST):
            return None
        if webhook.rests_until is not None and webhook.rests_until > moment:
            return None
        if not repository.take(session, delivery_id, moment, moment + HELD):
            return None
        taken = repository.delivery(session, delivery_id) or row
        body = json.dumps(taken.payload, separators=(",", ":")).encode()
        return Errand(delivery_id, webhook.id, taken.event, taken.attempts, webhook.url, webhook.secret, body)


def _try(errand: Errand, reach: Reach) -> Outcome:
    timestamp = str(int(time.time()))
    headers = {
        "Content-Type": "application/json",
        "User-Agent": f"Ponthy/{__version__}",
        "Ponthy-Event": errand.event,
        "Ponthy-Delivery": errand.delivery_id,
        "Ponthy-Timestamp": timestamp,
        "Ponthy-Signature": signature(errand.secret, timestamp, errand.body),
    }
    try:
        target = parse_url(errand.url, reach)
        answer = post(target, addresses_of(target, reach), errand.body, headers)
    except Invalid as error:
        return Outcome(None, error.message)
    except (OutOfReach, NotAnswered) as error:
        return Outcome(None, str(error))
    if 200 <= answer.status < 300:
        return Outcome(answer, None)
    followed = "; redirections are not followed" if 300 <= answer.status < 400 else ""
    return Outcome(answer, f"the receiver answered {answer.status}{followed}")


def _settle(resources: Resources, fleet_id: str, errand: Errand, outcome: Outcome) -> str:
    moment = now()
    values: dict[str, Any] = {
        "status": None if outcome.answer is None else outcome.answer.status,
        "error": None if outcome.error is None else outcome.error[:500],
        "answer": None if outcome.answer is None else outcome.answer.text[:KEPT_ANSWER],
    }
    pause = PAUSES_S[errand.attempt - 1] if errand.attempt <= len(PAUSES_S) else None
    if outcome.delivered:
        values |= {"state": DeliveryState.DELIVERED, "delivered_at": moment}
    elif pause is None:
        values |= {"state": DeliveryState.DEAD}
    else:
        values |= {"next_try_at": moment + timedelta(seconds=pause)}
    with resources.database.transaction(fleet_id) as session:
        webhook = repository.webhook(session, errand.webhook_id, lock=True)
        if webhook is None or not repository.settle(session, errand.delivery_id, errand.attempt, **values):
            return "lost"
        rest = moment + timedelta(seconds=min(pause or LONGEST_REST_S, LONGEST_REST_S))
        webhook.failing_since = None if outcome.delivered else (webhook.failing_since or moment)
        webhook.rests_until = None if outcome.delivered else rest
    if outcome.delivered:
        return "delivered"
    return "dead" if pause is None else "failed"
