"""Telling the webhooks how the job of a trip ended, in the transaction that ends it."""

from __future__ import annotations

from sqlalchemy.orm import Session

from app.jobs import service as jobs
from app.trips import service as trips
from app.webhooks import service as webhooks

EVENTS = {"succeeded": "trip.ready", "failed": "trip.failed"}
TOLD = frozenset(
    ("car_id", "car_name", "name", "started_at", "duration_s", "distance_m", "fuel_l", "verdict", "reasons")
)


def announce(session: Session, fleet_id: str, job_id: str) -> None:
    """Tell of a trip's job that has succeeded or failed just now; of any other job there is nothing to tell."""
    job = jobs.get(session, job_id)
    event = EVENTS.get(job.state)
    if event is None or job.kind != "trip" or job.trip_id is None:
        return
    trip = trips.get(session, job.trip_id).model_dump(mode="json", include=set(TOLD))
    data = {"trip_id": job.trip_id, "job_id": job_id} | trip
    if job.problem is not None:
        data["problem"] = job.problem
    webhooks.publish(session, event, data, fleet_id=fleet_id)
