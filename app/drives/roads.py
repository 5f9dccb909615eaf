"""Roads for problems: from a file as it is sent, or from a trip that was driven."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

from sqlalchemy.orm import Session

from app.drives.schemas import RoadAsked
from app.errors import Invalid, NotFound
from app.imports.road import RoadWishes, longest, read_roads, told
from app.science.optimal.posing.cleaning import PosedRoad
from app.science.optimal.posing.trip import road_of_states
from app.science.optimal.problem import Road
from app.storage.blobs import Blobs
from app.trips import service as trips

ORDINARY_LIMIT_MPS = 50.0 / 3.6
ORDINARY_NOTE = "Where the file says no speed limit, 50 km/h holds."


def road_of_file(data: bytes, wishes: RoadWishes, part: int | None) -> dict[str, Any]:
    """Return the road in a file, of several the longest or the one that is asked for.

    Raises
    ------
    SignalsError, PoseError
        When the file holds no road that can be driven.
    Invalid
        When it has no such part.
    """
    limit = wishes.speed_limit_mps or ORDINARY_LIMIT_MPS
    roads = read_roads(data, replace(wishes, speed_limit_mps=limit))
    if part is not None and part > len(roads):
        raise Invalid("no-such-part", f"The file has {len(roads)} parts between its stops.", field="query.part")
    found = told(roads, longest(roads) if part is None else part - 1)
    notes = [] if wishes.speed_limit_mps is not None or found["time_s"] is not None else [ORDINARY_NOTE]
    return found | {"notes": [*found["notes"], *notes]}


def road_as_asked(session: Session, blobs: Blobs, asked: RoadAsked, wishes: RoadWishes) -> dict[str, Any]:
    """Return the road that a trip took, with the highest speeds driven nearby as limits, or that of a problem.

    Raises
    ------
    NotFound
        When nothing is known of the trip's way.
    PoseError
        When the car hardly moved.
    """
    if asked.trip_id is None:
        columns = (asked.distance_m, asked.elevation_m, asked.speed_limit_mps)
        return told((PosedRoad(Road(*(tuple(values) for values in columns)), ()),), 0)
    trip = trips.observed_trip(session, asked.trip_id)
    if trip is None:
        raise NotFound("observed trip", asked.trip_id)
    states = trips.states_of(blobs, trip)
    return told((road_of_states(states, wishes.speed_limit_mps, from_t_s=asked.from_s, to_t_s=asked.to_s),), 0)
