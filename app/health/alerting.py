"""Alerts as rows: each is told once when it is raised and once when it is over, however often a car is assessed."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from datetime import datetime
from typing import Any

from sqlalchemy.orm import Session

from app.cars import service as cars
from app.health import repository
from app.health.models import Alert, AlertState
from app.science.health.result import CarHealth, HealthAlert
from app.storage.base import now
from app.webhooks import service as webhooks

BACK = "Back to its usual."
OTHERWISE = "The trips are explained otherwise by now: {words}."
NO_LONGER = "The trips, looked at again, no longer say so."
NEW_USUAL = "Taken as the car's new usual."


def sync(
    session: Session, car_id: str, found: CarHealth, began: Mapping[str, datetime], waiting: Sequence[datetime]
) -> None:
    """Make the rows of a car's alerts say what its newest assessment says.

    Parameters
    ----------
    session : Session
    car_id : str
    found : CarHealth
    began : mapping of str to datetime
        When each trip that was counted began.
    waiting : sequence of datetime
        When trips began that will count once they were run again. What was told of their time stands until then, and
        also while nothing can be said.
    """
    rows = {row.quantity: row for row in repository.alerts_not_over(session, car_id)}
    newest = {alert.quantity: alert for alert in found.open_alerts}
    for alert in newest.values():
        row = rows.pop(alert.quantity, None)
        if row is None:
            _raise(session, car_id, alert, began[alert.since_trip_id])
        else:
            _describe(row, alert, began[alert.since_trip_id])
    if found.reason:
        return
    for row in rows.values():
        if not any(moment >= row.since_at for moment in waiting):
            clear(session, row, _why_over(row, found))


def clear(session: Session, row: Alert, words: str) -> None:
    """Close an alert and tell so."""
    row.state, row.cleared_at, row.cleared_words = AlertState.CLEARED, now(), words
    session.flush()
    webhooks.publish(session, "health.cleared", _payload(session, row) | {"cleared_words": words})


def _raise(session: Session, car_id: str, alert: HealthAlert, since: datetime) -> None:
    row = Alert(car_id=car_id, quantity=alert.quantity, state=AlertState.OPEN)
    _describe(row, alert, since)
    session.add(row)
    session.flush()
    webhooks.publish(session, "health.alert", _payload(session, row))


def _describe(row: Alert, alert: HealthAlert, since: datetime) -> None:
    row.since_trip_id, row.since_at, row.trips = alert.since_trip_id, since, alert.trips
    row.change, row.change_sd, row.unit = alert.change, alert.change_sd, alert.unit
    row.chance, row.other = alert.chance, alert.other
    row.words, row.advice = alert.words, alert.advice


def _why_over(row: Alert, found: CarHealth) -> str:
    if any(alert.quantity == row.quantity for alert in found.alerts):
        return BACK
    if found.open_alerts:
        return OTHERWISE.format(words=found.open_alerts[-1].words)
    return NO_LONGER


def _payload(session: Session, row: Alert) -> dict[str, Any]:
    return {
        "alert_id": row.id,
        "car_id": row.car_id,
        "car_name": cars.names(session, [row.car_id])[row.car_id],
        "quantity": row.quantity,
        "words": row.words,
        "advice": row.advice,
        "change": row.change,
        "change_sd": row.change_sd,
        "unit": row.unit,
        "chance": row.chance,
        "trips": row.trips,
        "since_trip_id": row.since_trip_id,
        "state": str(row.state),
    }
