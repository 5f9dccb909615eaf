"""SQL of the cars' health."""

from __future__ import annotations

from collections.abc import Sequence

from sqlalchemy import select
from sqlalchemy.orm import Session

from app.health.models import Alert, AlertState, Assessment
from app.storage.paging import Page, newest_first


def assessment(session: Session, car_id: str) -> Assessment | None:
    """Return the newest assessment of a car."""
    return session.get(Assessment, car_id)


def alerts_not_over(session: Session, car_id: str) -> Sequence[Alert]:
    """Return the alerts of a car that have not been cleared, oldest first."""
    mine = (Alert.car_id == car_id, Alert.state != AlertState.CLEARED)
    return session.scalars(select(Alert).where(*mine).order_by(Alert.created_at, Alert.id)).all()


def alert(session: Session, car_id: str, alert_id: str) -> Alert | None:
    """Return an alert of a car."""
    return session.scalars(select(Alert).where(Alert.id == alert_id, Alert.car_id == car_id)).first()


def alerts(session: Session, car_id: str | None, states: Sequence[str], cursor: str | None, limit: int) -> Page[Alert]:
    """Return one page of the alerts in one of the states, newest first."""
    query = select(Alert).where(Alert.state.in_(states))
    if car_id is not None:
        query = query.where(Alert.car_id == car_id)
    return newest_first(session, query, Alert.created_at, Alert.id, cursor, limit)
