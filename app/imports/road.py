"""Files as roads: a GPX track, a road of a map, a table of a road or of positions, a driving cycle."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from app.imports.cycle import SPEED_NAMES, TIME_NAMES, read_cycle
from app.imports.gpx import read_gpx
from app.imports.osm import looks_like_osm, read_osm
from app.imports.table import Table, read_table
from app.science.arrays import FloatArray
from app.science.errors import SignalsError
from app.science.optimal.posing.cleaning import AS_GIVEN, Cleaning, PosedRoad, clean_road
from app.science.optimal.posing.cycle import roads_of_cycle
from app.science.optimal.posing.errors import PoseError
from app.science.optimal.posing.heights import Heights
from app.science.optimal.posing.highways import Highways
from app.science.optimal.posing.track import Track, road_of_track
from app.science.vehicle.fuels import FUELS

DISTANCES = {"distance_m": 1.0, "distance_km": 1000.0}
HEIGHTS = {"elevation_m": 1.0, "alt_m": 1.0, "altitude_m": 1.0}
LIMITS = {"speed_limit_mps": 1.0, "speed_limit_kmh": 1.0 / 3.6, "speed_limit_mph": 0.44704}
LATITUDES, LONGITUDES = ("lat_deg", "latitude", "lat"), ("lon_deg", "longitude", "lon")


@dataclass(frozen=True, slots=True)
class RoadWishes:
    """How a file is to be taken.

    Attributes
    ----------
    speed_limit_mps : float or None
        Holds wherever the file says nothing.
    heights : Heights or None
        An elevation model for tracks and maps.
    level : bool
        Leave heights out.
    smooth_m : float or None
        Standard deviation of the Gaussian for heights; None for what is ordinary for the file.
    cleaning : Cleaning
        The rest.
    roads : Highways or None
        A map with speed limits for tracks.
    way : str or None
        Of a file that is a map: the number or name of the road.
    backwards : bool
        Of a file that is a map: drive that road the other way.
    """

    speed_limit_mps: float | None = None
    heights: Heights | None = None
    level: bool = False
    smooth_m: float | None = None
    cleaning: Cleaning = AS_GIVEN
    roads: Highways | None = None
    way: str | None = None
    backwards: bool = False


def read_roads(data: bytes, wishes: RoadWishes) -> tuple[PosedRoad, ...]:
    """Read a file as roads: one, or those between the stops of a driving cycle.

    Raises
    ------
    SignalsError
        When the file can't be read; with line or row.
    PoseError
        When what it holds is no road that can be driven.
    """
    if looks_like_osm(data):
        return (_of_map(data, wishes),)
    if data[:2000].lstrip(b"\xef\xbb\xbf\x00 \t\r\n").startswith(b"<"):
        return (_of_track(read_gpx(data), wishes),)
    table = read_table(data)
    names = {name.strip().lower(): name for name in table.names}
    if any(name in names for name in DISTANCES):
        return (_of_table(table, names, wishes),)
    lat, lon = (next((names[name] for name in known if name in names), None) for known in (LATITUDES, LONGITUDES))
    if lat is not None and lon is not None:
        return (_of_track(_positions(table, names, lat, lon), wishes),)
    if any(name in names for name in TIME_NAMES) and any(name in names for name in SPEED_NAMES):
        speed = read_cycle(data, "", FUELS["petrol"]).speed_mps
        return roads_of_cycle(np.arange(float(speed.size)), speed, cleaning=wishes.cleaning)
    raise SignalsError(
        "The table is no road: it needs distance_m, elevation_m and speed_limit_kmh, or lat_deg and lon_deg, or the "
        f"time_s and speed_mps of a driving cycle; it has {', '.join(table.names[:12])}."
    )


def longest(roads: tuple[PosedRoad, ...]) -> int:
    """Return the index of the longest road."""
    return max(range(len(roads)), key=lambda k: roads[k].length_m)


def told(roads: tuple[PosedRoad, ...], chosen: int) -> dict[str, Any]:
    """Return one of a file's roads with all that is known about it, and what tells it from the others."""
    names = ("length_m", "from_speed_mps", "to_speed_mps", "time_s")
    parts = [{name: getattr(road, name) for name in names} for road in roads]
    return roads[chosen].document() | {"part": chosen + 1, "parts": parts}


def _of_track(track: Track, wishes: RoadWishes) -> PosedRoad:
    if wishes.speed_limit_mps is None and wishes.roads is None:
        raise PoseError("A track has no speed limits; say which one holds, or give a map of the roads.")
    return _along(track, wishes.speed_limit_mps, wishes)


def _of_map(data: bytes, wishes: RoadWishes) -> PosedRoad:
    """Return a road of a map by its name."""
    if wishes.way is None:
        raise PoseError("The file is a map of roads; say which one is to be driven, by its number or name.")
    course = read_osm(data).course(wishes.way)
    course = course.backwards() if wishes.backwards else course
    unknown = np.full(course.lat_deg.shape, np.nan)
    otherwise = np.nan if wishes.speed_limit_mps is None else wishes.speed_limit_mps
    limit = np.where(np.isnan(course.limit_mps), otherwise, course.limit_mps)
    found = _along(Track(course.lat_deg, course.lon_deg, unknown, unknown), limit, replace(wishes, roads=None))
    return replace(found, notes=(course.ends, *found.notes))


def _along(track: Track, limit_mps: float | FloatArray | None, wishes: RoadWishes) -> PosedRoad:
    return road_of_track(
        track,
        limit_mps,
        roads=wishes.roads,
        heights=wishes.heights,
        level=wishes.level,
        smooth_m=wishes.smooth_m,
        cleaning=wishes.cleaning,
    )


def _positions(table: Table, names: dict[str, str], lat: str, lon: str) -> Track:
    latitude, longitude = _whole(table, lat), _whole(table, lon)
    alt, _ = _scaled(table, names, HEIGHTS)
    time = next((table.numbers(names[name]) for name in TIME_NAMES if name in names), None)
    unknown = np.full(latitude.shape, np.nan)
    return Track(latitude, longitude, unknown if alt is None else alt, unknown if time is None else time)


def _of_table(table: Table, names: dict[str, str], wishes: RoadWishes) -> PosedRoad:
    distance_name = next(names[name] for name in DISTANCES if name in names)
    distance = _whole(table, distance_name) * DISTANCES[distance_name.strip().lower()]
    alt, _ = _scaled(table, names, HEIGHTS)
    limit, limit_name = _scaled(table, names, LIMITS)
    if limit is None:
        if wishes.speed_limit_mps is None:
            raise PoseError(f"The table has no column {' or '.join(LIMITS)}; add one, or say which limit holds.")
        limit = np.full(distance.shape, wishes.speed_limit_mps)
    empty = np.flatnonzero(np.isnan(limit))
    if empty.size:
        if wishes.speed_limit_mps is None:
            row = int(table.row[empty[0]])
            words = f"Row {row}: {limit_name} is no number; fill it in, or say which limit holds."
            raise SignalsError(words, row, limit_name)
        limit = np.where(np.isnan(limit), wishes.speed_limit_mps, limit)
    if wishes.level or alt is None:
        alt = np.zeros(distance.shape) if wishes.level else np.full(distance.shape, np.nan)
    return clean_road(distance, alt, limit, replace(wishes.cleaning, smooth_m=wishes.smooth_m or 0.0))


def _whole(table: Table, name: str) -> FloatArray:
    """Return a column that must have a number in every row."""
    values = table.numbers(name)
    empty = np.flatnonzero(np.isnan(values))
    if empty.size:
        row = int(table.row[empty[0]])
        raise SignalsError(f"Row {row}: {name} is no number; fill it in or leave the row out.", row, name)
    return values


def _scaled(table: Table, names: dict[str, str], known: dict[str, float]) -> tuple[FloatArray | None, str]:
    """Return the first of some columns in SI units with its name; None where none is there."""
    found = next((name for name in known if name in names), None)
    return (None, "") if found is None else (table.numbers(names[found]) * known[found], names[found])
