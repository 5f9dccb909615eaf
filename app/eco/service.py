"""What others may ask of the scores: score a trip, say how it is, rank cars and trips."""

from __future__ import annotations

import json
from collections.abc import Sequence
from dataclasses import fields
from typing import Any

from sqlalchemy.orm import Session

from app.cars import service as cars
from app.eco import repository
from app.eco.keys import COLUMNS
from app.eco.models import TripScoreRow
from app.errors import Invalid, PonthyError
from app.imports.results import read_columns
from app.jobs import service as jobs
from app.maps import service as maps
from app.science.arrays import FloatArray
from app.science.eco.result import Along, TripScore
from app.storage.blobs import Blobs
from app.storage.resources import Resources
from app.trips import service as trips

NOT_YET = "This trip has not been scored yet. Score it, or wait until its job has come to that."


def score(resources: Resources, fleet_id: str, trip_id: str, progress: jobs.Progress) -> jobs.Store:
    """Score a trip; see `app.eco.scoring.score`."""
    from app.eco import scoring  # for workers only, as it brings what the web server has no room for

    return scoring.score(resources, fleet_id, trip_id, progress)


def ask(session: Session, trip_id: str) -> jobs.JobView:
    """Have a trip scored with its car's newest map.

    Raises
    ------
    NotFound, Conflict
        When there is no such trip, or it is being worked on.
    PonthyError
        When it has no result that could be scored.
    """
    trip = trips.get(session, trip_id)
    observed(session, trip_id)
    return jobs.create_score_job(session, trip_id=trip.id, car_id=trip.car_id, title=f"Score of {trip.name}")


def observed(session: Session, trip_id: str) -> trips.ObservedTrip:
    """Return the result of a trip; raises `PonthyError` when there is none yet."""
    found = trips.observed_trip(session, trip_id)
    if found is None:
        raise PonthyError("not-observed", "This trip has no result yet; its job tells how far it is.", 409)
    return found


def ask_for_car(session: Session, car_id: str) -> list[jobs.JobView]:
    """Have those trips of a car scored whose score is missing or rests on an older map than the car's newest.

    Those still being worked on go on as they are, and are scored in the end. Raises `NotFound`.
    """
    cars.get(session, car_id)
    newest = maps.latest_of_cars(session, [car_id]).get(car_id)
    made_with = {row.trip_id: row.map_version for row in repository.of_car(session, car_id)}
    current = None if newest is None else newest.version
    wanted = trips.observed_trips(session, car_id)
    working = jobs.newest_of_trips(session, [trip.trip_id for trip in wanted])
    return [
        jobs.create_score_job(session, trip_id=trip.trip_id, car_id=car_id, title=f"Score of {trip.name}")
        for trip in sorted(wanted, key=lambda one: (one.began, one.trip_id))
        if trip.trip_id not in made_with or made_with[trip.trip_id] != current
        if trip.trip_id not in working or working[trip.trip_id].is_over
    ]


def kept(session: Session, trip_id: str) -> TripScoreRow:
    """Return the newest score of a trip.

    Raises
    ------
    NotFound
        When there is no such trip.
    PonthyError
        When it was not scored yet, or can't be; the message says why.
    """
    trip = trips.get(session, trip_id)
    row = repository.row(session, trip.id)
    if row is None:
        raise PonthyError("not-scored", NOT_YET, 409)
    if row.document_key is None:
        raise PonthyError("no-score", row.reason, 409, map_version=row.map_version)
    return row


def document(blobs: Blobs, row: TripScoreRow) -> dict[str, Any]:
    """Return a whole score as the science told it, but for the arrays along the road."""
    found: dict[str, Any] = json.loads(blobs.get(_document_key(row)))
    return found


def whole(blobs: Blobs, row: TripScoreRow) -> TripScore:
    """Return a score as the science knows it; raises `PonthyError` when another version wrote it in other words."""
    columns = read_columns(blobs.get(_columns_key(row)))
    try:
        return TripScore.from_document(document(blobs, row), columns)
    except (TypeError, KeyError) as error:
        message = "Another version of Ponthy scored this trip and told it differently. Score it again."
        raise PonthyError("score-of-another-version", message, 409) from error


def along(blobs: Blobs, row: TripScoreRow, names: Sequence[str]) -> dict[str, FloatArray]:
    """Return columns of driven and best drive along the road, all for no names; raises `Invalid` for an unknown one."""
    known = [field.name for field in fields(Along)]
    unknown = sorted(set(names) - set(known))
    if unknown:
        message = f"There is no column {unknown[0]!r} along a scored road; there are {', '.join(known)}."
        raise Invalid("unknown-column", message, field="columns")
    return read_columns(blobs.get(_columns_key(row)), names or known)


def _columns_key(row: TripScoreRow) -> str:
    return f"{_document_key(row).rpartition('/')[0]}/{COLUMNS}"


def _document_key(row: TripScoreRow) -> str:
    if row.document_key is None:
        raise ValueError("only a trip that could be scored has a document")
    return row.document_key
