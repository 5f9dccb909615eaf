"""The engine of a drive problem, where it is that of a car: the newest version of its map or a given one."""

from __future__ import annotations

import re
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from sqlalchemy.orm import Session

from app.errors import NotFound
from app.maps import service as maps
from app.science.engine.fitting.terms import FitError
from app.science.errors import TooLittleData
from app.science.fields import Fields, ProblemError, shown
from app.science.optimal.from_map import engine_of_map
from app.storage.blobs import Blobs

NAMED = re.compile(r"(?:(?:/api/v1/)?cars/)?(?P<car>[0-9a-f]{32})(?:(?::|/maps/)(?P<version>latest|[0-9]{1,9}))?")
OF_THE_CAR = re.compile(r"latest|[0-9]{1,9}")


@dataclass(frozen=True, slots=True)
class MapEngine:
    """What an engine that names a map became.

    Attributes
    ----------
    car_id : str
    version : int
    engine : mapping
        What the map's engine burns, as a problem says it.
    """

    car_id: str
    version: int
    engine: Mapping[str, Any]


def engine_of_car(session: Session, blobs: Blobs, fields: Fields, car_id: str | None) -> MapEngine:
    """Look up the map that an engine names.

    Parameters
    ----------
    session : Session
    blobs : Blobs
    fields : Fields
        The engine: ``map`` is a car's identifier for its newest map, or ``CAR:VERSION``; with ``car_id``, a version's
        number or ``latest`` will do. ``fit`` chooses the formula.
    car_id : str or None
        The car that the drive is posed for.

    Raises
    ------
    ProblemError
        When there is no such map, or it can't carry the formula.
    """
    car, version = _named(fields, car_id)
    try:
        found = maps.version(session, car, version)
        engine = engine_of_map(maps.document(blobs, found), fields)
    except NotFound as error:
        raise ProblemError(fields.path("map"), error.message) from error
    except (FitError, TooLittleData) as error:
        raise ProblemError(fields.path("map"), str(error)) from error
    return MapEngine(car, found.version, engine)


def _named(fields: Fields, car_id: str | None) -> tuple[str, str]:
    name = fields.get("map")
    text = str(name) if isinstance(name, str | int) and not isinstance(name, bool) else ""
    found = NAMED.fullmatch(text)
    if found is not None:
        return found["car"], found["version"] or "latest"
    if car_id is not None and OF_THE_CAR.fullmatch(text):
        return car_id, text
    message = f"{shown(name)} names no map; give a car's identifier, or CAR:VERSION for one of its maps."
    raise ProblemError(fields.path("map"), message)
