"""Two maps cell by cell: versions of a car, two cars, or two periods."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from sqlalchemy.orm import Session

from app.figures.map_difference import difference_figure
from app.figures.theme import Json, theme_named
from app.maps.sides import GRID, Side, map_of, read_side
from app.science.engine.compare import MapDifference, compare_maps
from app.science.engine.compare_trips import TripComparison, compare_trips
from app.science.engine.efficiency_map import CellGrid
from app.storage.blobs import Blobs

SURE_SIGMAS = 2.0
DECIMALS = 5


@dataclass(frozen=True, slots=True)
class Comparison:
    """Two sides and what is different.

    Attributes
    ----------
    first, second : Side
    difference : MapDifference
    grid : CellGrid
    by_trips : TripComparison or None
        None where the trips of a side are not kept one by one, and the maps alone were compared.
    """

    first: Side
    second: Side
    difference: MapDifference
    grid: CellGrid
    by_trips: TripComparison | None


def compare(session: Session, blobs: Blobs, car_id: str, first: str, second: str) -> Comparison:
    """Compare two choices of `app.maps.sides.read_side`.

    Raises
    ------
    Invalid, NotFound
        When a choice means nothing.
    ScienceError
        When too little is known of both.
    """
    before, after = read_side(session, car_id, first, "first"), read_side(session, car_id, second, "second")
    return compare_sides(session, blobs, before, after)


def compare_sides(session: Session, blobs: Blobs, before: Side, after: Side) -> Comparison:
    """Compare two sides; raises `ScienceError` when too little is known of both."""
    old, new = before.sums, after.sums
    if old is None or new is None:
        one, other = map_of(session, blobs, before), map_of(session, blobs, after)
        return Comparison(before, after, compare_maps(one, other), one.grid, None)
    every = {**old, **new}
    in_old, in_new = (np.array([trip in sums for trip in every], np.bool_) for sums in (old, new))
    found = compare_trips(list(every.values()), in_old, in_new, GRID)
    return Comparison(before, after, found.difference, found.grid, found)


def document(found: Comparison) -> dict[str, Any]:
    """Return a comparison as the API gives it."""
    d, trips = found.difference, found.by_trips
    columns = {
        "rpm": d.rpm,
        "nm": d.nm,
        "first": np.round(d.first, DECIMALS),
        "second": np.round(d.second, DECIMALS),
        "difference": np.round(d.difference, DECIMALS),
        "sd": np.round(d.sd, DECIMALS),
        "significant": d.significant,
    }
    rows = zip(*(column.tolist() for column in columns.values()), strict=True)
    return {
        "first": _side(found.first),
        "second": _side(found.second),
        "level": d.level,
        "level_sd": d.level_sd,
        "level_changed": level_changed(d),
        "cell": {"rpm": found.grid.rpm, "nm": found.grid.nm},
        "common_cells": len(d.rpm),
        "changed_cells": int(d.significant.sum()),
        "better_cells": int((d.significant & (d.difference > 0.0)).sum()),
        "worse_cells": int((d.significant & (d.difference < 0.0)).sum()),
        "only_first": d.only_first,
        "only_second": d.only_second,
        "trips_in_both": None if trips is None else trips.trips_in_both,
        "trip_sd": None if trips is None else trips.trip_sd,
        "points_per_look": None if trips is None else trips.points_per_look,
        "words": words(found),
        "cells": [dict(zip(columns, row, strict=True)) for row in rows],
    }


def level_changed(difference: MapDifference) -> bool:
    """Whether the level differs by more than two standard deviations."""
    return abs(difference.level - 1.0) > SURE_SIGMAS * difference.level_sd


def words(found: Comparison) -> list[str]:
    """Return what a comparison says."""
    d = found.difference
    percent, sd = 100.0 * (d.level - 1.0), 100.0 * d.level_sd
    size = f"{abs(percent):.1f} ± {sd:.1f} %"
    if not level_changed(d):
        said = [f"The level is the same as far as can be told: the second differs by {percent:+.1f} ± {sd:.1f} %."]
    else:
        said = [f"With the same fuel the second does {size} {'more' if percent > 0.0 else 'less'} work."]
    changed = int(d.significant.sum())
    said.append(
        f"Of {len(d.rpm)} cells known in both, {changed} differ by more than chance explains."
        if changed
        else f"None of the {len(d.rpm)} cells known in both differs by more than chance explains."
    )
    trips = found.by_trips
    if trips is None:
        said.append(
            "The trips of one side were run again or removed since, so the maps alone are compared: how much trips "
            "differ as a whole is not in the uncertainty."
        )
    else:
        said.append(
            f"A single trip's level is taken to lie within ±{100.0 * trips.trip_sd:.1f} % of the car's usual one (1σ), "
            f"and {trips.points_per_look:.0f} neighbouring points to tell as much as one."
        )
        if trips.trips_in_both:
            shared = (
                "One trip is in both; what it says"
                if trips.trips_in_both == 1
                else (f"{trips.trips_in_both} trips are in both; what they say")
            )
            said.append(f"{shared} cancels.")
    return [text.replace("-", "−") for text in said]


def draw(found: Comparison, theme: str) -> Json:
    """Return the figure of a comparison."""
    return difference_figure(found.difference, found.grid, theme=theme_named(theme))


def _side(side: Side) -> dict[str, Any]:
    return {
        "car_id": side.car_id,
        "car_name": side.car_name,
        "title": side.title,
        "version": None if side.version is None else side.version.version,
        "trips": len(side.trips),
    }
