"""What others may ask of the cars' health: assess a car, say how it is, tell of alerts, set a new usual."""

from __future__ import annotations

from collections.abc import Sequence
from datetime import UTC, datetime
from typing import Literal

from sqlalchemy.orm import Session

from app.cars import service as cars
from app.errors import Invalid, NotFound
from app.health import repository
from app.health.alerting import NEW_USUAL, clear
from app.health.models import Alert, AlertState, Assessment
from app.health.schemas import AlertDocument, NewUsual
from app.jobs import service as jobs
from app.schemas import Listing
from app.science.health.result import CarHealth
from app.storage.base import now
from app.storage.resources import Resources
from app.trips import service as trips

__all__ = ["alerts", "assess"]

StateWanted = Literal["open", "seen", "cleared", "current", "all"]

EARLIEST = datetime(1970, 1, 1, tzinfo=UTC)

STATES: dict[StateWanted, tuple[AlertState, ...]] = {
    "open": (AlertState.OPEN,),
    "seen": (AlertState.SEEN,),
    "cleared": (AlertState.CLEARED,),
    "current": (AlertState.OPEN, AlertState.SEEN),
    "all": tuple(AlertState),
}


def assess(resources: Resources, fleet_id: str, car_id: str, progress: jobs.Progress) -> jobs.Store:
    """Assess a car's health; see `app.health.assessing.assess`."""
    from app.health import assessing  # for workers only, as it brings what the web server has no room for

    return assessing.assess(resources, fleet_id, car_id, progress)


def kept(session: Session, car_id: str) -> Assessment | None:
    """Return the newest assessment of a car, if there is one; raises `NotFound` when there is no such car."""
    cars.get(session, car_id)
    return repository.assessment(session, car_id)


def found(assessment: Assessment | None) -> CarHealth | None:
    """Return what an assessment found; None before the first one, and for one that another version has written."""
    if assessment is None or assessment.document is None:
        return None
    try:
        return CarHealth.from_dict(assessment.document)
    except (TypeError, KeyError, ValueError):
        return None  # the page says so; the next job of the car writes it anew


def alerts(
    session: Session, *, state: StateWanted, car_id: str | None, cursor: str | None, limit: int
) -> Listing[AlertDocument]:
    """Return one page of the fleet's alerts, newest first."""
    page = repository.alerts(session, car_id, STATES[state], cursor, limit)
    return Listing(items=alert_documents(session, page.items), next_cursor=page.next_cursor)


def alert_documents(session: Session, rows: Sequence[Alert]) -> list[AlertDocument]:
    """Return alerts as the API shows them."""
    names = cars.names(session, list({row.car_id for row in rows}))
    return [
        AlertDocument.model_validate(
            {name: getattr(row, name) for name in AlertDocument.model_fields if name != "car_name"}
            | {"car_name": names[row.car_id]}
        )
        for row in rows
    ]


def see(session: Session, car_id: str, alert_id: str, who: str | None) -> AlertDocument:
    """Note that somebody has looked at an alert; one that was seen already or is over stays as it is."""
    cars.get(session, car_id)
    row = repository.alert(session, car_id, alert_id)
    if row is None:
        raise NotFound("alert", alert_id)
    if row.state == AlertState.OPEN:
        row.state, row.seen_at, row.seen_by = AlertState.SEEN, now(), who
        session.flush()
    return alert_documents(session, [row])[0]


def set_usual(session: Session, car_id: str, wanted: NewUsual) -> tuple[datetime, jobs.JobView]:
    """Take how the car is since some moment as its usual: alerts are over, and it is assessed anew from there.

    Raises
    ------
    NotFound
        When there is no such car.
    Invalid
        When the trip is none of this car, or the moment lies ahead.
    """
    name = cars.config(session, car_id, lock=True) and cars.get(session, car_id).name
    current = repository.alerts_not_over(session, car_id)
    since = _since(session, car_id, wanted, current)
    for row in current:
        clear(session, row, NEW_USUAL)
    return since, _begin_at(session, car_id, since, f"New usual of {name}")


def forget_usual(session: Session, car_id: str) -> jobs.JobView:
    """Let the car's first trips say again what is usual; raises `NotFound`."""
    cars.config(session, car_id, lock=True)
    return _begin_at(session, car_id, None, f"First usual of {cars.get(session, car_id).name}")


def _begin_at(session: Session, car_id: str, since: datetime | None, title: str) -> jobs.JobView:
    row = repository.assessment(session, car_id)
    if row is None:
        row = Assessment(car_id=car_id)
        session.add(row)
    row.usual_since = since
    session.flush()
    return jobs.create_map_job(session, car_id=car_id, title=title)


def _since(session: Session, car_id: str, wanted: NewUsual, current: Sequence[Alert]) -> datetime:
    if wanted.since_trip_id is not None:
        began = {trip.trip_id: trip.began for trip in trips.observed_trips(session, car_id)}
        if wanted.since_trip_id not in began:
            message = f"No observed trip of this car is {wanted.since_trip_id!r}. Name one of its trips, or a moment."
            raise Invalid("not-a-trip-of-the-car", message, field="body.since_trip_id")
        return began[wanted.since_trip_id]
    if wanted.since is not None and not EARLIEST <= wanted.since <= now():
        message = f"What is usual begins between {EARLIEST:%Y} and now; {wanted.since.isoformat()} is not."
        raise Invalid("impossible-time", message, field="body.since")
    return wanted.since or min((row.since_at for row in current), default=now())
