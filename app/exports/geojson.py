"""A trip as GeoJSON (RFC 7946)."""

from __future__ import annotations

import json
from datetime import UTC, datetime
from typing import Any

import numpy as np

from app.exports.track import track
from app.science.observer.result import Observation

STEP_S = 1.0


def trip_geojson(observation: Observation, *, name: str, started_at_utc_s: float | None = None) -> bytes:
    """Write the track as a line with time and speed of every vertex, and its two ends as points.

    Parameters
    ----------
    observation : Observation
    name : str
        Of the trip.
    started_at_utc_s : float, optional
        Seconds since 1970-01-01 at time zero.

    Raises
    ------
    TooLittleData
        When no position is known.
    """
    way = track(observation.columns, STEP_S)
    vertices = np.column_stack((way.lon_deg.round(7), way.lat_deg.round(7), way.alt_m.round(2))).tolist()
    about = {
        "name": name,
        "started_at": _utc(started_at_utc_s),
        "duration_s": round(float(way.t_s[-1] - way.t_s[0]), 3),
        "t_s": way.t_s.round(3).tolist(),
        "speed_mps": way.speed_mps.round(3).tolist(),
    }
    if np.isfinite(observation.distance_m):
        about["distance_m"] = round(observation.distance_m, 1)
    features = [
        _feature("LineString", vertices, about),
        _feature("Point", vertices[0], {"name": "Start", "t_s": about["t_s"][0]}),
        _feature("Point", vertices[-1], {"name": "Stop", "t_s": about["t_s"][-1]}),
    ]
    corners = [
        min(v[0] for v in vertices),
        min(v[1] for v in vertices),
        max(v[0] for v in vertices),
        max(v[1] for v in vertices),
    ]
    return json.dumps({"type": "FeatureCollection", "bbox": corners, "features": features}, allow_nan=False).encode()


def _feature(kind: str, coordinates: list[Any], properties: dict[str, Any]) -> dict[str, Any]:
    return {"type": "Feature", "geometry": {"type": kind, "coordinates": coordinates}, "properties": properties}


def _utc(seconds: float | None) -> str | None:
    return None if seconds is None else datetime.fromtimestamp(seconds, UTC).isoformat()
