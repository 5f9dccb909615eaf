"""What the observer left of trips, for those who build on it."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from datetime import datetime
from functools import lru_cache
from typing import Any

from sqlalchemy.orm import Session

from app.imports.results import read_operating_points, read_road_load, read_some_signals, read_states
from app.science.arrays import FloatArray
from app.science.engine.idle import NO_IDLE, IdleSums
from app.science.engine.points import OperatingPoints
from app.science.logger.recording import Recording
from app.science.roadload.windows import RoadLoadWindows
from app.storage.blobs import Blobs
from app.storage.keys import stage_key
from app.trips import repository
from app.trips.keys import IDLE, POINTS, ROAD_LOAD, STATES, recording_file, result_file
from app.trips.models import Trip

PULSES = "fuel_energy"
"""The sensor that hears every injection."""


@dataclass(frozen=True, slots=True)
class ObservedTrip:
    """A trip whose operating points are there.

    Attributes
    ----------
    trip_id, name : str
    in_map : bool
        Whether it counts in the car's map.
    key : str
        Names the observer run; another run has another key.
    points_file, road_load_file : str
        Where the operating points and the road-load windows lie.
    provenance : dict
    started_at : datetime or None
    began : datetime
        What orders a car's trips: when it started, or, without a clock, when it came.
    verdict : str or None
    smoothed : bool
    counts_pulses : bool
        Whether its fuel is counted pulse by pulse at the injectors, rather than reported by the engine.
    idle : IdleSums
        Nothing where an earlier version of Ponthy observed the trip.
    """

    trip_id: str
    name: str
    in_map: bool
    key: str
    points_file: str
    road_load_file: str
    provenance: dict[str, Any]
    started_at: datetime | None
    began: datetime
    verdict: str | None
    smoothed: bool
    counts_pulses: bool
    idle: IdleSums = NO_IDLE

    @property
    def folder(self) -> str:
        """Where everything of this run lies; it goes when the run is replaced or the trip is removed."""
        return self.points_file.rpartition("/")[0]


def observed_trips(session: Session, car_id: str) -> list[ObservedTrip]:
    """Return the observed trips of a car, in the order they came."""
    found = (_observed(trip) for trip in repository.of_car(session, car_id))
    return [trip for trip in found if trip is not None]


def observed_trip(session: Session, trip_id: str) -> ObservedTrip | None:
    """Return a trip that was observed; None for one that wasn't or isn't there."""
    trip = repository.trip(session, trip_id)
    return None if trip is None else _observed(trip)


def _observed(trip: Trip) -> ObservedTrip | None:
    if trip.observe_key is None:
        return None
    return ObservedTrip(
        trip.id,
        trip.name,
        trip.in_map,
        trip.observe_key,
        result_file(trip, trip.observe_key, POINTS),
        result_file(trip, trip.observe_key, ROAD_LOAD),
        trip.provenance,
        trip.started_at,
        trip.started_at or trip.created_at,
        trip.verdict,
        bool(trip.smoothed),
        any(row["sensor"] == PULSES for row in trip.consistency),
        IdleSums.from_dict((trip.summary or {}).get(IDLE)),
    )


@dataclass(frozen=True, slots=True)
class DecodedTrip:
    """A trip whose measurements are there.

    Attributes
    ----------
    trip_id, car_id, name : str
    key : str
        Names the measurements; others have another key.
    file : str
        Where they lie.
    began : datetime
        When it started, or, without a clock, when it came.
    has_clock : bool
    """

    trip_id: str
    car_id: str
    name: str
    key: str
    file: str
    began: datetime
    has_clock: bool


def decoded_trips(session: Session, car_id: str) -> list[DecodedTrip]:
    """Return the decoded trips of a car, in the order they came."""
    found = (_decoded(trip) for trip in repository.of_car(session, car_id))
    return [trip for trip in found if trip is not None]


def decoded_trip(session: Session, trip_id: str) -> DecodedTrip | None:
    """Return a trip that was decoded; None for one that wasn't or isn't there."""
    trip = repository.trip(session, trip_id)
    return None if trip is None else _decoded(trip)


def _decoded(trip: Trip) -> DecodedTrip | None:
    if trip.decode_key is None:
        return None
    file = recording_file(trip, trip.decode_key, trip.segment)
    key = stage_key("measurements", decoded=trip.decode_key, segment=trip.segment)
    began = trip.started_at or trip.created_at
    return DecodedTrip(trip.id, trip.car_id, trip.name, key, file, began, trip.started_at is not None)


def signals_of(blobs: Blobs, trip: DecodedTrip, names: Sequence[str]) -> Recording:
    """Return those of some signals that a trip recorded, and none of the others, which may be a thousand times more."""
    with blobs.open(trip.file) as file:
        return read_some_signals(file, names)


def states_of(blobs: Blobs, trip: ObservedTrip, names: Sequence[str] | None = None) -> dict[str, FloatArray]:
    """Return the states of a trip over time, all or only these columns; NaN where a value is not known."""
    return read_states(blobs.get(f"{trip.folder}/{STATES}"), names)


def operating_points_of(blobs: Blobs, trip: ObservedTrip) -> OperatingPoints:
    """Return the operating points of a trip."""
    return read_operating_points(blobs.get(trip.points_file))


def road_load_of(blobs: Blobs, trip: ObservedTrip) -> RoadLoadWindows | None:
    """Return the road-load windows of a trip; None where an earlier version of Ponthy observed it."""
    try:
        return _road_load(blobs, trip.road_load_file)
    except FileNotFoundError:
        return None


@lru_cache(maxsize=256)
def _road_load(blobs: Blobs, file: str) -> RoadLoadWindows:
    """Return stored windows, about 70 kB a trip, which are asked for again with each new one; a file never changes."""
    return read_road_load(blobs.get(file))
