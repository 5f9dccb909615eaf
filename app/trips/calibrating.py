"""What each trip says about its car's calibration: gathered when it is observed, read when somebody asks."""

from __future__ import annotations

import json
from dataclasses import dataclass
from datetime import datetime
from functools import lru_cache

import structlog
from sqlalchemy.orm import Session

from app.cars.service import CarConfig
from app.science.calibration.evidence import TripEvidence
from app.science.logger.recording import Recording
from app.science.observer.result import Observation
from app.science.roadload.evidence import RoadLoadEvidence
from app.storage.blobs import Blobs
from app.trips import repository
from app.trips.keys import EVIDENCE, result_file
from app.trips.models import Trip
from app.trips.road_loads import road_load_evidence

MOST_TRIPS = 100
"""The latest trips of a car that are asked: more of them hardly change what they say together."""

NOT_OBSERVED = "It has not been observed yet."
OTHER_FILE = "It was observed with another car file; run it again."
NOTHING_KEPT = "It was observed by an earlier version of Ponthy; run it again."

log = structlog.get_logger(__name__)


@dataclass(frozen=True, slots=True)
class TripSays:
    """A trip of a car and what it says of the calibration.

    Attributes
    ----------
    trip_id, name : str
    started_at : datetime or None
    refuelled_l : float or None
        What filled the tank up right after it.
    evidence : TripEvidence or None
    why : str
        Why there is no evidence; empty when there is.
    road_load : tuple of RoadLoadEvidence
        Nothing where the observer failed: its forces are wrong.
    """

    trip_id: str
    name: str
    started_at: datetime | None
    refuelled_l: float | None
    evidence: TripEvidence | None
    why: str
    road_load: tuple[RoadLoadEvidence, ...] = ()


def gather(recording: Recording, car: CarConfig, observation: Observation) -> tuple[bytes | None, tuple[str, ...]]:
    """Return what a trip says as a file, and warnings; a fault here never costs the trip its result."""
    from app.science.calibration.calibrate import trip_evidence  # for workers only, as it needs scipy

    try:
        evidence = trip_evidence(recording, car.vehicle, observation)
        return json.dumps(evidence.to_dict()).encode(), ()
    except Exception as error:
        log.warning("no evidence for the calibration", exc_info=True)
        return None, (f"This trip says nothing about the car's calibration: {error}",)


def evidence_of_car(session: Session, blobs: Blobs, car: CarConfig) -> list[TripSays]:
    """Return the latest trips of a car in the order they were driven, each with what it says."""
    return [_says(blobs, trip, car) for trip in repository.latest_of_car(session, car.car_id, MOST_TRIPS)]


def _says(blobs: Blobs, trip: Trip, car: CarConfig) -> TripSays:
    evidence, why = None, ""
    road_load: tuple[RoadLoadEvidence, ...] = ()
    if trip.observe_key is None:
        why = NOT_OBSERVED
    elif trip.provenance.get("config_sha256") != car.sha256:
        why = OTHER_FILE
    else:
        try:
            evidence = _read(blobs, result_file(trip, trip.observe_key, EVIDENCE))
            road_load = road_load_evidence(blobs, trip) if trip.verdict != "failed" else ()
        except (FileNotFoundError, KeyError, TypeError, ValueError):
            why = NOTHING_KEPT
    return TripSays(trip.id, trip.name, trip.started_at, trip.refuelled_l, evidence, why, road_load)


@lru_cache(maxsize=2048)
def _read(blobs: Blobs, file: str) -> TripEvidence:
    """Return stored evidence; a run's file never changes."""
    return TripEvidence.from_dict(json.loads(blobs.get(file)))
