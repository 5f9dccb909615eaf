"""What each trip says of its car's road load: gathered when it is observed, read when somebody asks."""

from __future__ import annotations

import json
from functools import lru_cache
from typing import get_args

from app.science.roadload.evidence import Model, RoadLoadEvidence, trip_evidence
from app.science.roadload.windows import RoadLoadWindows
from app.science.vehicle.model import Vehicle
from app.storage.blobs import Blobs
from app.trips.keys import ROAD_LOAD_EVIDENCE, result_file
from app.trips.models import Trip


def road_load_json(windows: RoadLoadWindows, vehicle: Vehicle) -> bytes:
    """Return as a file what a trip says by each model of the engine that it has the measurements for."""
    found = [trip_evidence(windows, vehicle, model) for model in get_args(Model)]
    return json.dumps([one.to_dict() for one in found if one is not None]).encode()


def road_load_evidence(blobs: Blobs, trip: Trip) -> tuple[RoadLoadEvidence, ...]:
    """Return what an observed trip says; nothing where an earlier version of Ponthy observed it."""
    try:
        return _read(blobs, result_file(trip, trip.observe_key or "", ROAD_LOAD_EVIDENCE))
    except (FileNotFoundError, KeyError, TypeError, ValueError):
        return ()  # the trip's other evidence still counts, and running it again brings this


@lru_cache(maxsize=1024)
def _read(blobs: Blobs, file: str) -> tuple[RoadLoadEvidence, ...]:
    """Return stored evidence; a run's file never changes."""
    return tuple(RoadLoadEvidence.from_dict(one) for one in json.loads(blobs.get(file)))
