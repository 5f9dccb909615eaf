"""A car's health as the API shows it."""

from __future__ import annotations

from datetime import UTC, datetime
from typing import Any

from sqlalchemy.orm import Session

from app.figures.idle_trend import TripIdle
from app.health import repository, service
from app.health.idling import idle_by_trip
from app.health.models import Assessment
from app.health.schemas import HealthDocument, HealthState, IdlePart, TrendDocument, TripPart
from app.science.health.baseline import BASELINE_TRIPS
from app.science.health.result import CarHealth

NOT_ASSESSED = (
    f"The first {BASELINE_TRIPS} trips that agree say what is usual for a car; each one after them is compared with "
    "that. None has been assessed yet; trips that an earlier version of Ponthy observed have to be run again."
)


def health(session: Session, car_id: str) -> HealthDocument:
    """Return the document of a car's health; raises `NotFound` when there is no such car."""
    row = service.kept(session, car_id)
    found = service.found(row)
    known = found or CarHealth((), (), (), "", 0.0, 0, BASELINE_TRIPS, NOT_ASSESSED)
    alerts = service.alert_documents(session, repository.alerts_not_over(session, car_id))
    counted: list[dict[str, Any]] = known.to_dict()["trips"]
    left_out = [] if row is None or found is None else row.left_out
    return HealthDocument(
        car_id=car_id,
        state=_state(known, bool(alerts)),
        words=known.words,
        reason=known.reason,
        baseline_trips=known.baseline_trips,
        baseline_needed=known.baseline_needed,
        false_alarms_per_200_trips=known.false_alarms_per_200_trips if known.trends else None,
        alerts=alerts,
        trends=[TrendDocument.model_validate(trend) for trend in known.trends],
        idle=[_idle(one) for one in idle_by_trip(session, car_id)],
        trips=[_part(trip) for trip in sorted([*counted, *left_out], key=_began)],
        **_about(row if found else None, row),
    )


def _state(known: CarHealth, has_alerts: bool) -> HealthState:
    if has_alerts:
        return "alert"
    return "unknown" if known.reason else "healthy"


def _about(assessed: Assessment | None, row: Assessment | None) -> dict[str, Any]:
    return {
        "assessed_at": None if assessed is None else assessed.assessed_at,
        "code_version": None if assessed is None else assessed.code_version,
        "usual_since": None if row is None else row.usual_since,
    }


def _began(trip: dict[str, Any]) -> float:
    return trip["started_at"] or 0.0


def _idle(one: TripIdle) -> IdlePart:
    known = one.idle
    return IdlePart(
        trip_id=one.trip_id,
        name=one.name,
        litres_per_hour=known.litres_per_hour,
        rpm=known.rpm,
        seconds=known.seconds,
    )


def _part(trip: dict[str, Any]) -> TripPart:
    started = trip["started_at"]
    return TripPart(
        trip_id=trip["trip_id"],
        name=trip["name"],
        started_at=None if started is None else datetime.fromtimestamp(started, UTC),
        role=trip["role"],
        why=trip["reason"],
    )
