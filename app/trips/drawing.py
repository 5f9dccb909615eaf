"""Figures of a trip, made on request from its stored results."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Literal

import numpy as np

from app.figures.agreement import coverage_figure, nis_figure, refusals_figure, whiteness_figure
from app.figures.innovations import innovations_figure, sensors_figure
from app.figures.operating_points import operating_points_figure
from app.figures.stack import DEFAULT_SIGNALS, stack_figure
from app.figures.theme import Json, theme_named
from app.figures.told import told_figure
from app.figures.torque_sources import torque_sources_figure
from app.figures.track import Tiles, track_figure, track_plan_figure
from app.settings import Settings
from app.storage.blobs import Blobs
from app.trips.models import Trip
from app.trips.states import StatesTable
from app.trips.stored import innovations_of, observability_of, points_of, sensors_of, torques_of

FigureName = Literal[
    "track",
    "stack",
    "innovations",
    "points",
    "sensors",
    "told",
    "nis",
    "whiteness",
    "coverage",
    "refusals",
    "torque-sources",
]
ThemeName = Literal["light", "dark"]

GEOGRAPHIC = ("lat_deg", "lon_deg", "speed_mps", "distance_m")
PLANE = ("north_m", "east_m", "speed_mps", "distance_m")


@dataclass(frozen=True, slots=True)
class Wish:
    """What of a figure can be chosen.

    Attributes
    ----------
    signals : sequence of str
        Panels of the stack; empty for the usual ones.
    from_s, to_s : float or None
        Span of the stack.
    points : int
        Samples of a panel at most.
    variant : {"map", "plan"}
        The track on a map, or on paper for machines that can't draw maps.
    """

    signals: Sequence[str] = ()
    from_s: float | None = None
    to_s: float | None = None
    points: int = 4000
    variant: Literal["map", "plan"] = "map"


class TripFigures:
    """Draws one trip.

    Parameters
    ----------
    blobs : Blobs
    settings : Settings
        Says whether there are map tiles.
    trip : Trip
    theme : {"light", "dark"}
    """

    def __init__(self, blobs: Blobs, settings: Settings, trip: Trip, theme: ThemeName) -> None:
        self._blobs = blobs
        self._settings = settings
        self._trip = trip
        self._theme = theme_named(theme)

    def draw(self, name: FigureName, wish: Wish) -> Json:
        """Return a figure; raises `PonthyError` when the trip has no result yet."""
        match name:
            case "track":
                return self._track(wish)
            case "stack":
                return self._stack(wish)
            case "innovations":
                return innovations_figure(innovations_of(self._blobs, self._trip), theme=self._theme)
            case "points":
                return operating_points_figure(points_of(self._blobs, self._trip), theme=self._theme)
            case "sensors":
                return sensors_figure(sensors_of(self._trip), theme=self._theme)
            case "told":
                return self._told()
            case "nis":
                return nis_figure(sensors_of(self._trip), theme=self._theme)
            case "whiteness":
                return whiteness_figure(sensors_of(self._trip), theme=self._theme)
            case "coverage":
                return coverage_figure(sensors_of(self._trip), theme=self._theme)
            case "refusals":
                return refusals_figure(sensors_of(self._trip), self._trip.duration_s or 0.0, theme=self._theme)
            case "torque-sources":
                return torque_sources_figure(torques_of(self._blobs, self._trip), theme=self._theme)

    def _track(self, wish: Wish) -> Json:
        with StatesTable(self._blobs, self._trip) as table:
            columns = table.columns(PLANE if wish.variant == "plan" else GEOGRAPHIC)
        if wish.variant == "plan":
            return track_plan_figure(columns, theme=self._theme)
        url = self._settings.tiles_url
        tiles = None if url is None else Tiles(url, self._settings.tiles_attribution)
        return track_figure(columns, theme=self._theme, tiles=tiles)

    def _told(self) -> Json:
        document = observability_of(self._blobs, self._trip)
        states = document["states"]
        return told_figure(
            np.array(document["begin_s"]),
            document["window_s"],
            {name: np.array(state["sd"]) for name, state in states.items()},
            {name: state["prior_sd"] for name, state in states.items()},
            theme=self._theme,
        )

    def _stack(self, wish: Wish) -> Json:
        names = wish.signals or DEFAULT_SIGNALS
        with StatesTable(self._blobs, self._trip) as table:
            table.check(names)
            columns = table.columns(table.with_deviations(names), wish.from_s, wish.to_s)
        return stack_figure(columns, names, theme=self._theme, from_s=wish.from_s, to_s=wish.to_s, points=wish.points)
