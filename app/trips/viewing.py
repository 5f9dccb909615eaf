"""Trips as the API shows them: with their car's name, their newest job and what state that leaves them in."""

from __future__ import annotations

from collections.abc import Sequence

from sqlalchemy.orm import Session

from app.cars import service as cars
from app.jobs import service as jobs
from app.trips.models import Trip
from app.trips.schemas import TripState, TripView

STATE_OF_STAGE: dict[str | None, TripState] = {
    "decode": "decoding",
    "observe": "observing",
    "map": "mapping",
    "health": "assessing",
    "battery": "assessing",
}


CANCELLED = {
    "type": "urn:ponthy:problem:cancelled",
    "title": "Cancelled",
    "status": 409,
    "detail": "The trip's job was cancelled before there was a result. Retry the job to go on.",
    "code": "cancelled",
}


def view(session: Session, trips: Sequence[Trip]) -> list[TripView]:
    """Return trips as the API shows them."""
    newest = jobs.newest_of_trips(session, [trip.id for trip in trips])
    names = cars.names(session, list({trip.car_id for trip in trips}))
    return [_view(trip, names.get(trip.car_id, ""), newest.get(trip.id)) for trip in trips]


def _view(trip: Trip, car_name: str, job: jobs.JobView | None) -> TripView:
    columns = {name: getattr(trip, name) for name in TripView.model_fields if hasattr(trip, name)}
    state = _state(trip, job)
    problem = None if job is None else job.problem
    if state == "failed" and problem is None:
        problem = CANCELLED
    return TripView(**columns, car_name=car_name, state=state, job_id=job.id if job else None, problem=problem)


def _state(trip: Trip, job: jobs.JobView | None) -> TripState:
    if job is not None and job.current_stage == "score" and trip.observe_key is not None:
        return "ready"  # whatever becomes of its score
    if job is not None and job.state == "queued":
        return "waiting"
    if job is not None and job.state == "running":
        return STATE_OF_STAGE.get(job.current_stage, "waiting")
    if job is not None and job.state == "failed":
        return "failed"
    return "ready" if trip.observe_key else "failed"
