"""The score stage: a trip beside the best drive over its own road, kept unless the very same was done before."""

from __future__ import annotations

import json
from dataclasses import dataclass
from typing import Any

import structlog
from sqlalchemy.orm import Session

from app.cars import service as cars
from app.eco import repository
from app.eco.keys import COLUMNS, DOCUMENT, score_folder, scores_folder
from app.eco.models import TripScoreRow
from app.exports.parquet import columns_parquet
from app.jobs import service as jobs
from app.jsonable import jsonable
from app.maps import service as maps
from app.science.eco.result import TripScore
from app.science.errors import ScienceError
from app.storage.base import now
from app.storage.blobs import Blobs
from app.storage.keys import stage_key
from app.storage.resources import Resources
from app.trips import service as trips

OBSERVER_FAILED = "The observer failed on this trip, so what it says of the engine can't be compared with anything."
UNREADABLE = "The trip's stored result can't be read; run the trip again."
FAULT = "Scoring itself failed: {error}. The server's log says more; the trip can be scored again."
READ = 0.02
"""Share of the stage that is done when everything is read."""

log = structlog.get_logger(__name__)


@dataclass(frozen=True, slots=True)
class Question:
    """Everything that a score depends on; ``key`` names it, and another question has another key."""

    trip: trips.ObservedTrip
    car: cars.CarConfig
    version: maps.MapVersion | None
    key: str

    @property
    def folder(self) -> str:
        """Where the score lies."""
        return score_folder(self.trip, self.key)


def score(resources: Resources, fleet_id: str, trip_id: str, progress: jobs.Progress) -> jobs.Store:
    """Score a trip with its car's newest map, unless that was done for the very same trip, car, map and code.

    A trip that can't be scored says why, and a fault is told in the row: neither costs the trip anything.
    """
    with resources.database.transaction(fleet_id, read_only=True) as session:
        question = _question(session, trip_id, resources.settings.code_version)
        kept = repository.row(session, trip_id)
    if question is None or (kept is not None and kept.key == question.key):
        return lambda session: None
    found, reason = _answer(resources.blobs, question, progress)
    if found is not None:
        _keep(resources.blobs, question, found, kept)
    progress(1.0, reason or f"{found.score.value:.0f} of 100" if found is not None else reason)
    return lambda session: _store(session, question, found, reason, resources.settings.code_version)


def _question(session: Session, trip_id: str, code: str) -> Question | None:
    trip = trips.observed_trip(session, trip_id)
    if trip is None:
        return None
    car = cars.config(session, trips.get(session, trip_id).car_id)
    version = maps.latest_of_cars(session, [car.car_id]).get(car.car_id)
    named = None if version is None else version.key
    return Question(trip, car, version, stage_key("score", observed=trip.key, car=car.key, map=named, code=code))


def _answer(blobs: Blobs, question: Question, progress: jobs.Progress) -> tuple[TripScore | None, str]:
    """Return the score, or why there is none."""
    if question.trip.verdict == "failed":
        return None, OBSERVER_FAILED
    try:
        return beside_the_best(blobs, question, progress), ""
    except (jobs.JobCancelled, jobs.LeaseLost):
        raise
    except FileNotFoundError:
        return None, UNREADABLE
    except ScienceError as error:
        return None, str(error)
    except Exception as error:
        log.warning("no score of the trip", trip_id=question.trip.trip_id, exc_info=True)
        return None, FAULT.format(error=str(error).partition("\n")[0])


def beside_the_best(blobs: Blobs, question: Question, progress: jobs.Progress) -> TripScore:
    """Return what the science makes of a trip."""
    from app.science.eco.score import score_trip  # for workers only, which have room for it

    version = question.version
    told = "without a map" if version is None else f"with version {version.version} of the map"
    progress(READ, told)
    states = trips.states_of(blobs, question.trip)
    document = None if version is None else maps.document(blobs, version)

    def on(share: float) -> None:
        progress(READ + (1.0 - READ) * share, told)

    return score_trip(states, question.car.vehicle, document, progress=on)


def _keep(blobs: Blobs, question: Question, found: TripScore, kept: TripScoreRow | None) -> None:
    """Write the score, and remove what earlier ones left that no row refers to any more."""
    shown = "" if kept is None or kept.document_key is None else kept.document_key.rpartition("/")[0]
    old = (key for key in blobs.keys(scores_folder(question.trip)) if key.rpartition("/")[0] != shown)
    blobs.delete(*old)
    blobs.put(f"{question.folder}/{COLUMNS}", columns_parquet(found.along.columns()))
    blobs.put(f"{question.folder}/{DOCUMENT}", json.dumps(jsonable(found.document()), allow_nan=False).encode())


def _store(session: Session, question: Question, found: TripScore | None, reason: str, code: str) -> None:
    """Keep a score, unless the trip was observed anew meanwhile: that job scores it after this one."""
    trip = trips.observed_trip(session, question.trip.trip_id)
    if trip is None or trip.key != question.trip.key:
        return
    row = repository.row(session, trip.trip_id, lock=True)
    if row is None:
        row = TripScoreRow(trip_id=trip.trip_id, car_id=question.car.car_id)
        session.add(row)
    row.key, row.reason, row.code_version, row.scored_at = question.key, reason, code, now()
    row.map_version = None if question.version is None else question.version.version
    row.provenance = _provenance(question, code)
    _number(row, found)
    row.document_key = None if found is None else f"{question.folder}/{DOCUMENT}"


def _number(row: TripScoreRow, found: TripScore | None) -> None:
    """Fill in the numbers; litres deviate as the percentage does, since sums over trips are shown as shares."""
    row.score = None if found is None else found.score.value
    row.score_sd = None if found is None else found.score.sd
    row.fuel_l = None if found is None else found.trip_l * found.scored_percent / 100.0
    row.saved_l = None if found is None else found.saved_l.value
    row.saved_sd_l = None if found is None or row.fuel_l is None else found.score.sd / 100.0 * row.fuel_l
    row.distance_m = None if found is None else found.scored_m
    row.advice = [] if found is None else list(found.advice)


def _provenance(question: Question, code: str) -> dict[str, Any]:
    version = question.version
    return {
        "observe_key": question.trip.key,
        "input_sha256": question.trip.provenance.get("input_sha256"),
        "config_sha256": question.car.sha256,
        "config_revision": question.car.revision,
        "load_kg": question.car.vehicle.load_kg,
        "map_version": None if version is None else version.version,
        "map_key": None if version is None else version.key,
        "code_version": code,
    }
