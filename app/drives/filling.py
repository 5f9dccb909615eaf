"""Problems filled in for a car: its file and its map say most of what a drive problem asks."""

from __future__ import annotations

from typing import Any

from sqlalchemy.orm import Session

from app.cars import service as cars
from app.maps import service as maps
from app.science.fields import Fields
from app.science.optimal.from_map import engine_of_map
from app.science.optimal.posing.car import CarKind, Wishes, problem_of_car
from app.storage.blobs import Blobs

EXAMPLE_ROAD: dict[str, list[float]] = {
    "distance_m": [0.0, 1000.0],
    "elevation_m": [0.0, 0.0],
    "speed_limit_mps": [13.888888888888889, 13.888888888888889],
}
EXAMPLE_NOTE = "The road is an example, a level kilometre at 50 km/h; put yours in its place."


def engine_of(session: Session, blobs: Blobs, car_id: str, version: str, fit: str) -> dict[str, Any]:
    """Return what a car's map gives as the engine of a problem, and how a problem names it.

    Raises
    ------
    NotFound
        When there is no such car or map.
    FitError
        When the map can't carry the formula.
    """
    found = maps.version(session, car_id, version)
    named = {"map": f"{car_id}:{found.version}", "fit": fit}
    engine = engine_of_map(maps.document(blobs, found), Fields(named, "engine"))
    return {"car_id": car_id, "version": found.version, "named": named, "engine": engine}


def filled(
    session: Session, blobs: Blobs, car_id: str, version: str, fit: str, kind: CarKind, *, whole: bool
) -> dict[str, Any]:
    """Return a problem for a car that can be posed as it is; raises what `engine_of` does, and `PoseError`."""
    vehicle = cars.config(session, car_id).vehicle
    known = engine_of(session, blobs, car_id, version, fit)
    road = EXAMPLE_ROAD if kind == "route" else None
    document = maps.document(blobs, maps.version(session, car_id, version))
    posed = problem_of_car(vehicle, document, road, kind=kind, wishes=Wishes(), fit=fit)
    notes = [*posed.notes, *([EXAMPLE_NOTE] if road else [])]
    problem = posed.problem if whole else posed.problem | {"engine": known["named"]}
    return known | {"problem": problem, "notes": notes}
