"""What others may ask of the trips: take an upload in, look up, change, run again, remove."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import PurePath
from typing import Any, Protocol

from sqlalchemy.orm import Session

from app.cars import service as cars
from app.errors import NotFound
from app.jobs import service as jobs
from app.schemas import Listing
from app.storage.outbox import enqueue
from app.storage.resources import Resources
from app.storage.tenancy import fleet_of
from app.trips import repository
from app.trips.calibrating import TripSays, evidence_of_car
from app.trips.models import LEFT_OUT, Trip
from app.trips.results import (
    DecodedTrip,
    ObservedTrip,
    decoded_trip,
    decoded_trips,
    observed_trip,
    observed_trips,
    operating_points_of,
    road_load_of,
    signals_of,
    states_of,
)
from app.trips.schemas import Reprocessing, TripChange, TripView
from app.trips.sweeping import sweep
from app.trips.tunings import tuning_of
from app.trips.viewing import view

__all__ = [
    "Accepted",
    "CarTotals",
    "DecodedTrip",
    "ObservedTrip",
    "TripSays",
    "TripView",
    "accept_upload",
    "decoded_trip",
    "decoded_trips",
    "evidence_of_car",
    "observed_trip",
    "observed_trips",
    "operating_points_of",
    "road_load_of",
    "signals_of",
    "states_of",
    "sweep",
    "view",
]

SWEEP = "ponthy.sweep"
"""Name of the task that removes the files of what was deleted."""


class ReceivedFile(Protocol):
    """A complete upload of a trip."""

    @property
    def id(self) -> str: ...
    @property
    def car_id(self) -> str | None: ...
    @property
    def filename(self) -> str: ...
    @property
    def blob_key(self) -> str | None: ...
    @property
    def sha256(self) -> str | None: ...
    @property
    def size(self) -> int: ...
    @property
    def mapping(self) -> dict[str, Any] | None: ...


@dataclass(frozen=True, slots=True)
class Accepted:
    """What became of an upload."""

    trip: TripView
    job: jobs.JobView


@dataclass(frozen=True, slots=True)
class CarTotals:
    """What a car's trips add up to; consumption counts the trips whose fuel is known."""

    trip_count: int
    distance_m: float
    fuel_l: float
    litres_per_100km: float | None


def decode(resources: Resources, fleet_id: str, trip_id: str, progress: jobs.Progress) -> jobs.Store:
    """Decode the upload of a trip; see `app.trips.decoding.decode`."""
    from app.trips import decoding  # brings compiled kernels, which the web server never runs and has no room for

    return decoding.decode(resources, fleet_id, trip_id, progress)


def observe(resources: Resources, fleet_id: str, trip_id: str, progress: jobs.Progress) -> jobs.Store:
    """Observe a trip; see `app.trips.observing.observe`."""
    from app.trips import observing  # as above

    return observing.observe(resources, fleet_id, trip_id, progress)


def accept_upload(session: Session, upload: ReceivedFile) -> Accepted:
    """Make the first trip of an upload and the job that processes it, in the caller's transaction.

    Raises
    ------
    NotFound
        When the car is gone.
    """
    if upload.car_id is None or upload.blob_key is None or upload.sha256 is None:
        raise ValueError("only a complete upload of a trip can be accepted")
    cars.get(session, upload.car_id)
    trip = Trip(
        car_id=upload.car_id,
        upload_id=upload.id,
        segment=0,
        input_key=upload.blob_key,
        input_sha256=upload.sha256,
        input_bytes=upload.size,
        mapping=upload.mapping,
        name=PurePath(upload.filename.removesuffix(".gz")).stem[:200] or "Trip",
        filename=upload.filename,
        options={},
    )
    session.add(trip)
    session.flush()
    job = jobs.create_trip_job(session, trip_id=trip.id, car_id=trip.car_id, title=trip.filename)
    return Accepted(view(session, [trip])[0], job)


def row(session: Session, trip_id: str, *, lock: bool = False) -> Trip:
    """Return a trip; raises `NotFound`."""
    trip = repository.trip(session, trip_id, lock=lock)
    if trip is None:
        raise NotFound("trip", trip_id)
    return trip


def get(session: Session, trip_id: str) -> TripView:
    """Return a trip as the API shows it; raises `NotFound`."""
    return view(session, [row(session, trip_id)])[0]


def names(session: Session, trip_ids: Sequence[str]) -> dict[str, str]:
    """Return the names of trips by identifier."""
    return {trip.id: trip.name for trip in repository.with_ids(session, trip_ids)}


def page(session: Session, *, car_id: str | None, cursor: str | None, limit: int) -> Listing[TripView]:
    """Return one page of the trips, newest first."""
    found = repository.page(session, car_id, cursor, limit)
    return Listing(items=view(session, found.items), next_cursor=found.next_cursor)


def ids_of_upload(session: Session, upload_id: str) -> list[str]:
    """Return the identifiers of an upload's trips, in the order of its segments."""
    return [trip.id for trip in repository.of_upload(session, upload_id)]


def totals_of_cars(session: Session, car_ids: Sequence[str]) -> dict[str, CarTotals]:
    """Return what the trips of each car add up to."""
    sums = repository.sums_of_cars(session, car_ids)
    totals = {}
    for car_id in car_ids:
        count, metres, litres, fuelled_metres = sums.get(car_id, (0, 0.0, 0.0, 0.0))
        consumption = litres / fuelled_metres * 1e5 if litres > 0.0 and fuelled_metres > 0.0 else None
        totals[car_id] = CarTotals(count, metres, litres, consumption)
    return totals


def change(session: Session, trip_id: str, wanted: TripChange) -> TripView:
    """Change what a person says of a trip, or leave it out of its car's map; raises `NotFound`."""
    trip = row(session, trip_id, lock=True)
    if wanted.name is not None:
        trip.name = wanted.name
    if wanted.notes is not None:
        trip.notes = wanted.notes
    if wanted.refuelled_l is not None:
        trip.refuelled_l = wanted.refuelled_l or None
    if wanted.in_map is not None and wanted.in_map != trip.in_map:
        trip.in_map = wanted.in_map
        trip.warnings = [warning for warning in trip.warnings if warning != LEFT_OUT]
        jobs.create_map_job(
            session, car_id=trip.car_id, title=f"Map {'with' if trip.in_map else 'without'} {trip.name}"
        )
    session.flush()
    return view(session, [trip])[0]


def reprocess(session: Session, trip_id: str, wanted: Reprocessing) -> jobs.JobView:
    """Run a trip again; stages whose input, configuration and code are the same as before keep their results.

    Raises
    ------
    NotFound, Conflict
        When there is no such trip, or it is still being worked on.
    TuningError
        When the tuning has an unknown entry or an impossible value.
    """
    jobs.lock_of_trip(session, trip_id)
    trip = row(session, trip_id, lock=True)
    jobs.require_no_open_job(session, trip_id)
    tuning_of(wanted.tuning)
    trip.options = {
        "filter": wanted.filter,
        "tuning": wanted.tuning,
        "smooth": wanted.smooth,
        "without": sorted(set(wanted.without)),
        "carry_over": wanted.carry_over,
    }
    session.flush()
    return jobs.create_trip_job(session, trip_id=trip.id, car_id=trip.car_id, title=trip.filename)


def reprocess_car(session: Session, car_id: str) -> list[jobs.JobView]:
    """Run all trips of a car again as they were run last, in the order they were driven.

    Those still being worked on go on as they are, but for those that have only to be scored.
    """
    trips = sorted(repository.of_car(session, car_id), key=lambda trip: (trip.started_at or trip.created_at, trip.id))
    newest = jobs.newest_of_trips(session, [trip.id for trip in trips])
    return [
        jobs.create_trip_job(session, trip_id=trip.id, car_id=car_id, title=trip.filename)
        for trip in trips
        if jobs.make_way(session, newest.get(trip.id))
    ]


def delete(session: Session, trip_id: str) -> str | None:
    """Remove a trip with its results and jobs, and have its car's map made without it.

    Returns
    -------
    str or None
        The upload it came from when no other trip needs it any more.

    Raises
    ------
    NotFound
    """
    jobs.lock_of_trip(session, trip_id)
    trip = row(session, trip_id, lock=True)
    car_id, upload_id, name, was_in_map = trip.car_id, trip.upload_id, trip.name, trip.in_map and trip.observe_key
    session.delete(trip)
    session.flush()
    if was_in_map:
        jobs.create_map_job(session, car_id=car_id, title=f"Map without {name}")
    enqueue(session, SWEEP, fleet_id=fleet_of(session))
    return None if repository.of_upload(session, upload_id) else upload_id


def delete_of_car(session: Session, car_id: str) -> None:
    """Remove all trips of a car that is about to be removed."""
    jobs.lock_of_car(session, car_id)
    repository.delete_of_car(session, car_id)
    enqueue(session, SWEEP, fleet_id=fleet_of(session))
