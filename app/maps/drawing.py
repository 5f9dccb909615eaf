"""Figures of a map, made on request from its document."""

from __future__ import annotations

from typing import Literal

from sqlalchemy.orm import Session

from app.figures.map_contour import contour_figure
from app.figures.map_counts import counts_figure
from app.figures.map_scale import Shown
from app.figures.map_surface import surface_figure
from app.figures.theme import Json, theme_named
from app.maps.documents import efficiency_map
from app.maps.models import MapVersion
from app.science.engine.points import OperatingPoints
from app.storage.blobs import Blobs
from app.trips import service as trips

FigureName = Literal["contour", "surface", "counts"]


def draw(session: Session, blobs: Blobs, found: MapVersion, name: FigureName, quantity: Shown, theme: str) -> Json:
    """Return a figure of a map; over the contours lie the points of the last trip that is in it."""
    drawn = efficiency_map(blobs, found)
    match name:
        case "contour":
            last = _points_of_last_trip(session, blobs, found)
            return contour_figure(drawn, shown=quantity, last_trip=last, theme=theme_named(theme))
        case "surface":
            return surface_figure(drawn, shown=quantity, theme=theme_named(theme))
        case "counts":
            return counts_figure(drawn, theme=theme_named(theme))


def _points_of_last_trip(session: Session, blobs: Blobs, found: MapVersion) -> OperatingPoints | None:
    """Return the points of the trip that came last, unless it was deleted or observed anew since."""
    made_from = {(trip["trip_id"], trip["observe_key"]) for trip in found.provenance["trips"]}
    present = [trip for trip in trips.observed_trips(session, found.car_id) if (trip.trip_id, trip.key) in made_from]
    return trips.operating_points_of(blobs, present[-1]) if present else None
