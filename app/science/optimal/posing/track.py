"""A track of positions as distances along a road."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from app.science.arrays import FloatArray, IntArray
from app.science.optimal.posing.cleaning import Cleaning, PosedRoad, clean_road
from app.science.optimal.posing.errors import PoseError
from app.science.optimal.posing.heights import Heights, tile_name
from app.science.optimal.posing.highways import Highways
from app.science.roads.pieces import metres_per_degree

SCATTER_M = 3.0
"""Points of a track nearer to the one before tell more about the receiver than about the road."""
BETWEEN_M = 30.0
"""With an elevation model, heights are also looked up between points, that often."""
JUMP_MPS = 70.0
MEASURED_SMOOTH_M, MODEL_SMOOTH_M = 30.0, 100.0


@dataclass(frozen=True, slots=True)
class Track:
    """Positions in order, arrays of shape (n,).

    Attributes
    ----------
    lat_deg, lon_deg : array
        On WGS 84.
    alt_m : array
        NaN where unknown.
    t_s : array
        NaN where unknown.
    """

    lat_deg: FloatArray
    lon_deg: FloatArray
    alt_m: FloatArray
    t_s: FloatArray


def along_m(lat_deg: FloatArray, lon_deg: FloatArray) -> FloatArray:
    """Return horizontal distances along positions, m, shape (n,)."""
    north, east = metres_per_degree(0.5 * (lat_deg[:-1] + lat_deg[1:]))
    step = np.hypot(np.diff(lat_deg) * north, ((np.diff(lon_deg) + 180.0) % 360.0 - 180.0) * east)
    return np.concatenate(([0.0], np.cumsum(step)))


def road_of_track(
    track: Track,
    speed_limit_mps: float | FloatArray | None,
    *,
    roads: Highways | None = None,
    heights: Heights | None = None,
    level: bool = False,
    smooth_m: float | None = None,
    cleaning: Cleaning | None = None,
) -> PosedRoad:
    """Make a road of a track.

    Parameters
    ----------
    track : Track
    speed_limit_mps : float, array of shape (n,), or None
        Holds everywhere, or from each point of the track on; NaN or None where unknown.
    roads : Highways or None
        A map whose limits hold wherever it knows one.
    heights : Heights or None
        An elevation model, which then takes the place of the track's own heights.
    level : bool
        Leave all heights out.
    smooth_m : float or None
        Standard deviation of the Gaussian for heights; None for 30 m, with an elevation model 100 m.
    cleaning : Cleaning or None
        The rest of the cleaning.

    Raises
    ------
    PoseError
        For a jump or a gap, with its place and length, and for what `clean_road` refuses.
    """
    ordinary = cleaning or Cleaning()
    rows = _apart(track)
    kept = Track(track.lat_deg[rows], track.lon_deg[rows], track.alt_m[rows], track.t_s[rows])
    if kept.lat_deg.size < 2:
        raise PoseError("The track has no two points that lie apart; there is no road in it.")
    _no_jumps(kept, ordinary.longest_gap_m)
    notes = []
    if kept.lat_deg.size < track.lat_deg.size:
        left = track.lat_deg.size - kept.lat_deg.size
        notes.append(f"{left} of {track.lat_deg.size} points lie within {SCATTER_M:g} m of the one before: left out.")
    flat = along_m(kept.lat_deg, kept.lon_deg)
    given = np.nan if speed_limit_mps is None else speed_limit_mps
    limits = np.broadcast_to(np.asarray(given, dtype=np.float64), track.lat_deg.shape)[rows]
    alt = kept.alt_m
    if heights is not None or roads is not None:
        places = _between(flat)
        lat = np.interp(places, flat, kept.lat_deg)
        lon = (np.interp(places, flat, np.unwrap(kept.lon_deg, period=360.0)) + 180.0) % 360.0 - 180.0
        alt = np.interp(places, flat, alt)
        limits = limits[np.searchsorted(flat, places, side="right") - 1]
        flat = places
        if heights is not None and not level:
            alt = _looked_up(heights, lat, lon)
            notes.append(f"Heights are those of {heights.name}, every {BETWEEN_M:g} m and at each point.")
        if roads is not None:
            limits = _of_map(roads.limits_along(lat, lon), limits, notes)
    if level:
        alt = np.zeros(flat.shape)
        notes.append("The road is taken as level.")
    _limits_known(flat, limits)
    smooth = smooth_m
    if smooth is None:
        smooth = 0.0 if level else MEASURED_SMOOTH_M if heights is None else MODEL_SMOOTH_M
    found = clean_road(flat, alt, limits, replace(ordinary, smooth_m=smooth))
    sloped = _along_slope(found)
    return replace(sloped, notes=(*notes, *found.notes))


def _along_slope(found: PosedRoad) -> PosedRoad:
    """Turn horizontal distances into distances along the road, which are longer where it is steep."""
    flat, z = np.array(found.road.distance_m), np.array(found.road.elevation_m)
    along = np.concatenate(([0.0], np.cumsum(np.hypot(np.diff(flat), np.diff(z)))))
    return replace(found, road=replace(found.road, distance_m=tuple(along.tolist())))


def _looked_up(heights: Heights, lat: FloatArray, lon: FloatArray) -> FloatArray:
    alt = heights.at(lat, lon)
    if not np.isfinite(alt).any():
        raise PoseError(
            f"{heights.name} has no height along this track, which runs from {lat[0]:.3f}°, {lon[0]:.3f}° to "
            f"{lat[-1]:.3f}°, {lon[-1]:.3f}°; its tile would be {tile_name(float(lat[0]), float(lon[0]))}."
        )
    return alt


def _of_map(of_map: FloatArray, otherwise: FloatArray, notes: list[str]) -> FloatArray:
    """Return the limits of a map, and others where it knows none."""
    known = np.isfinite(of_map)
    notes.append(f"The map knows the speed limit on {100.0 * known.mean():.0f} % of the way.")
    return np.where(known, of_map, otherwise)


def _limits_known(flat: FloatArray, limits: FloatArray) -> None:
    unknown = np.flatnonzero(np.isnan(limits))
    if unknown.size:
        share = 100.0 * unknown.size / limits.size
        raise PoseError(
            f"On {share:.0f} % of the way no speed limit is known, first at {flat[unknown[0]]:.0f} m; say which one "
            "holds there."
        )


def _apart(track: Track) -> IntArray:
    """Return which points to keep: not those that hardly differ from the one before."""
    north, east = metres_per_degree(track.lat_deg)
    kept = [0]
    for k in range(1, track.lat_deg.size):
        last = kept[-1]
        turned = (track.lon_deg[k] - track.lon_deg[last] + 180.0) % 360.0 - 180.0
        if np.hypot((track.lat_deg[k] - track.lat_deg[last]) * north[k], turned * east[k]) >= SCATTER_M:
            kept.append(k)
    return np.array(kept)


def _no_jumps(track: Track, longest_m: float) -> None:
    s = along_m(track.lat_deg, track.lon_deg)
    step, seconds = np.diff(s), np.diff(track.t_s)
    with np.errstate(invalid="ignore", divide="ignore"):
        speed = np.where(seconds > 0.0, step / seconds, 0.0)
    for k in (int(step.argmax()), int(speed.argmax())):
        place = f"({track.lat_deg[k]:.5f}°, {track.lon_deg[k]:.5f}°), {s[k] / 1000.0:.2f} km from the start"
        if step[k] > longest_m:
            raise PoseError(
                f"After {place}, the track has no points for {step[k]:.0f} m; {longest_m:.0f} m are allowed. Fill the "
                "gap in, split the track there, or allow longer ones."
            )
        if speed[k] > JUMP_MPS and step[k] > BETWEEN_M:
            raise PoseError(
                f"After {place}, the track jumps by {step[k]:.0f} m in {seconds[k]:.0f} s, {3.6 * speed[k]:.0f} km/h. "
                "Leave out the points that are off, or split the track there."
            )


def _between(flat: FloatArray) -> FloatArray:
    """Return the distances of the points and of places between them."""
    parts = np.maximum(np.ceil(np.diff(flat) / BETWEEN_M).astype(np.int64), 1)
    return np.interp(np.concatenate(([0.0], np.cumsum(np.repeat(1.0 / parts, parts)))), np.arange(flat.size), flat)
