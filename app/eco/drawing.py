"""Figures of a trip's score, made on request from what the score stage kept."""

from __future__ import annotations

from typing import Literal

import numpy as np
from sqlalchemy.orm import Session

from app.eco import service
from app.eco.models import TripScoreRow
from app.errors import PonthyError
from app.figures.score_accelerations import accelerations_figure
from app.figures.score_along import along_figure
from app.figures.score_cells import cells_figure
from app.figures.score_parts import parts_figure
from app.figures.score_place import place_figure, place_plan_figure
from app.figures.theme import Json, theme_named
from app.figures.track import Tiles
from app.science.arrays import FloatArray
from app.science.eco.result import Along
from app.storage.resources import Resources
from app.trips import service as trips

FigureName = Literal["along", "parts", "cells", "accelerations", "place"]
Variant = Literal["map", "plan", ""]

PLACES = ("lat_deg", "lon_deg", "north_m", "east_m")
"""Columns that tell where the car was."""


def draw(
    session: Session, resources: Resources, row: TripScoreRow, name: FigureName, variant: Variant, theme: str
) -> Json:
    """Return a figure; ``variant`` says how the place is drawn: on a map, or on paper where none can be drawn."""
    look = theme_named(theme)
    found = service.whole(resources.blobs, row)
    match name:
        case "along":
            return along_figure(found.along, theme=look)
        case "parts":
            return parts_figure(found, theme=look)
        case "cells":
            return cells_figure(found, theme=look)
        case "accelerations":
            return accelerations_figure(found.accelerations, theme=look)
        case "place":
            places = _places(session, resources, row, found.along)
            if variant == "plan":
                return place_plan_figure(found.along, places, theme=look)
            url = resources.settings.tiles_url
            tiles = None if url is None else Tiles(url, resources.settings.tiles_attribution)
            return place_figure(found.along, places, theme=look, tiles=tiles)


def _places(session: Session, resources: Resources, row: TripScoreRow, along: Along) -> dict[str, FloatArray]:
    """Return where the car was at each row of the scored road."""
    trip = trips.observed_trip(session, row.trip_id)
    if trip is None:
        raise PonthyError("not-observed", "This trip has no result any more; its job tells how far it is.", 409)
    states = trips.states_of(resources.blobs, trip)
    known = [name for name in PLACES if name in states]
    return {name: _at(along.t_s, states["t_s"], states[name]) for name in known}


def _at(t_s: FloatArray, of_s: FloatArray, values: FloatArray) -> FloatArray:
    known = np.isfinite(values)
    if not known.any():
        return np.full(len(t_s), np.nan)
    return np.asarray(np.interp(t_s, of_s[known], values[known]), dtype=np.float64)
