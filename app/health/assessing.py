"""The health stage: what a car's trips say of its health, assessed anew when they or its file have changed."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from datetime import datetime
from typing import Any

import structlog
from sqlalchemy.orm import Session

from app.cars import service as cars
from app.health import repository
from app.health.alerting import sync
from app.health.models import Assessment
from app.jobs import service as jobs
from app.science.health.result import CarHealth
from app.science.roadload.windows import RoadLoadWindows
from app.science.vehicle.model import Vehicle
from app.storage.base import now
from app.storage.blobs import Blobs
from app.storage.keys import stage_key
from app.storage.resources import Resources
from app.trips import service as trips

NOT_IN_MAP = "It is left out of the map, and so it doesn't count here."
OTHER_FILE = "It was observed with another car file or load; run it again."
NOTHING_KEPT = "It was observed by an earlier version of Ponthy; run it again."
UNREADABLE = "Its stored result can't be read; run it again."
FAULT = "The assessment itself failed: {error}. The server's log says more; it is tried again with the next trip."

READ = 0.5
"""Share of the stage that is done when all trips are read."""

log = structlog.get_logger(__name__)

Told = tuple[trips.ObservedTrip, RoadLoadWindows]


@dataclass(frozen=True, slots=True)
class LeftOut:
    """A trip that doesn't count, and why; one that ``waits`` will count once it was run again."""

    trip: trips.ObservedTrip
    why: str
    waits: bool


@dataclass(frozen=True, slots=True)
class Question:
    """Everything that an assessment depends on.

    Attributes
    ----------
    car : CarConfig
    counted : list of ObservedTrip
        In the order they were driven.
    left_out : list of LeftOut
    usual_since : datetime or None
        Trips that began earlier say nothing of what is usual.
    key : str
        Names all of it; another question has another key.
    """

    car: cars.CarConfig
    counted: list[trips.ObservedTrip]
    left_out: list[LeftOut]
    usual_since: datetime | None
    key: str


def assess(resources: Resources, fleet_id: str, car_id: str, progress: jobs.Progress) -> jobs.Store:
    """Assess a car's health, unless that was done for the very same trips, file, usual and code.

    A fault is told in the assessment and costs the trip nothing that it has reached already.
    """
    code = resources.settings.code_version
    with resources.database.transaction(fleet_id, read_only=True) as session:
        question = _question(session, car_id, code)
        kept = repository.assessment(session, car_id)
    if kept is not None and kept.key == question.key:
        return lambda session: None
    found, unread = _answer(resources.blobs, question, progress)
    left_out = [*question.left_out, *unread]
    progress(1.0, found.words or found.reason)
    return lambda session: _store(session, question, found, left_out, code)


def _question(session: Session, car_id: str, code: str, *, lock: bool = False) -> Question:
    car = cars.config(session, car_id, lock=lock)
    kept = repository.assessment(session, car_id)
    usual_since = None if kept is None else kept.usual_since
    counted, left_out = [], []
    for trip in sorted(trips.observed_trips(session, car_id), key=lambda trip: (trip.began, trip.trip_id)):
        if not trip.in_map:
            left_out.append(LeftOut(trip, NOT_IN_MAP, waits=False))
        elif not _is_of(trip, car):
            left_out.append(LeftOut(trip, OTHER_FILE, waits=True))
        else:
            counted.append(trip)
    parts = {
        "counted": [trip.key for trip in counted],
        "left_out": [[one.trip.trip_id, one.why] for one in left_out],
        "usual_since": None if usual_since is None else usual_since.isoformat(),
    }
    return Question(car, counted, left_out, usual_since, stage_key("health", car=car.key, code=code, **parts))


def _is_of(trip: trips.ObservedTrip, car: cars.CarConfig) -> bool:
    made = trip.provenance.get("config_sha256"), trip.provenance.get("load_kg")
    return made == (car.sha256, car.vehicle.load_kg)


def _answer(blobs: Blobs, question: Question, progress: jobs.Progress) -> tuple[CarHealth, list[LeftOut]]:
    """Return what the trips say, and those that say nothing; faults are told, not raised."""
    told: list[Told] = []
    unread: list[LeftOut] = []
    for number, trip in enumerate(question.counted):
        progress(READ * number / len(question.counted), f"road load of {trip.name}")
        windows, why = _windows(blobs, trip)
        if windows is None:
            unread.append(LeftOut(trip, why, waits=True))
        else:
            told.append((trip, windows))
    try:
        return judge(told, question.car.vehicle, question.usual_since), unread
    except Exception as error:
        log.warning("no assessment of the car's health", car_id=question.car.car_id, exc_info=True)
        return CarHealth((), (), (), "", 0.0, 0, 0, FAULT.format(error=error)), unread


def judge(told: Sequence[Told], vehicle: Vehicle, usual_since: datetime | None) -> CarHealth:
    """Return what the science makes of the trips, given in the order they were driven."""
    from app.science.health.assess import TripLoad  # for workers only, which have room for it
    from app.science.health.assess import assess as assess_trips

    loads = [TripLoad(trip.trip_id, trip.name, trip.began.timestamp(), windows) for trip, windows in told]
    return assess_trips(loads, vehicle, usual_since=None if usual_since is None else usual_since.timestamp())


def _windows(blobs: Blobs, trip: trips.ObservedTrip) -> tuple[RoadLoadWindows | None, str]:
    try:
        windows = trips.road_load_of(blobs, trip)
    except (KeyError, TypeError, ValueError, OSError):
        log.warning("windows of a trip can't be read", trip_id=trip.trip_id, exc_info=True)
        return None, UNREADABLE
    return windows, NOTHING_KEPT


def _store(session: Session, question: Question, found: CarHealth, left_out: Sequence[LeftOut], code: str) -> None:
    """Keep an assessment and tell what is new in it.

    One car at a time; when its trips have changed meanwhile, the job that changed them assesses it after this one.
    """
    if _question(session, question.car.car_id, code, lock=True).key != question.key:
        return
    kept = repository.assessment(session, question.car.car_id)
    if kept is None:
        kept = Assessment(car_id=question.car.car_id)
        session.add(kept)
    kept.key, kept.code_version, kept.assessed_at = question.key, code, now()
    kept.document = found.to_dict()
    kept.left_out = [_left_out(one) for one in left_out]
    waiting = [one.trip.began for one in left_out if one.waits]
    sync(session, question.car.car_id, found, {trip.trip_id: trip.began for trip in question.counted}, waiting)


def _left_out(one: LeftOut) -> dict[str, Any]:
    started = one.trip.started_at
    return {
        "trip_id": one.trip.trip_id,
        "name": one.trip.name,
        "started_at": None if started is None else started.timestamp(),
        "role": "left_out",
        "reason": one.why,
    }
