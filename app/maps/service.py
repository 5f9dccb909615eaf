"""What others may ask of the maps: bring up to date, look up, draw, hand out."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from sqlalchemy.orm import Session

from app.cars import service as cars
from app.errors import NotFound
from app.maps import repository
from app.maps.changing import cells_changed
from app.maps.documents import document
from app.maps.growing import added_by, grown
from app.maps.models import MapVersion
from app.maps.schemas import MapView
from app.maps.sweeping import sweep
from app.maps.updating import update
from app.schemas import Listing

__all__ = [
    "MapVersion",
    "MapView",
    "added_by",
    "cells_changed",
    "delete_of_car",
    "document",
    "grown",
    "latest_of_cars",
    "page",
    "sweep",
    "update",
    "version",
]


def page(session: Session, car_id: str, *, cursor: str | None, limit: int) -> Listing[MapView]:
    """Return one page of a car's maps, newest first; raises `NotFound` when there is no such car."""
    cars.get(session, car_id)
    return Listing[MapView].model_validate(repository.page(session, car_id, cursor, limit), from_attributes=True)


def version(session: Session, car_id: str, name: str) -> MapVersion:
    """Return a version of a car's map by its number, or the newest for ``latest``; raises `NotFound`."""
    cars.get(session, car_id)
    number = int(name) if name.isdecimal() and len(name) < 10 else None
    found = None if number is None and name != "latest" else repository.version(session, car_id, number)
    if found is None:
        raise NotFound("map version", name)
    return found


def latest_of_cars(session: Session, car_ids: Sequence[str]) -> Mapping[str, MapVersion]:
    """Return the newest map of each car that has one, by car."""
    return {found.car_id: found for found in repository.newest_of_cars(session, car_ids)}


def delete_of_car(session: Session, car_id: str) -> None:
    """Remove all maps of a car that is about to be removed."""
    repository.delete_of_car(session, car_id)
