"""The elevation table of the virtual road, as a surveyor would deliver it."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from app.science.arrays import FloatArray, IntArray
from app.science.virtualcar.geography import place_of
from app.science.virtualcar.road import ROAD_STEP_M, Road

_MOST_M = 40.0
_MOST_TURN_RAD = 0.15
_BEYOND_M = 300.0


@dataclass(frozen=True, slots=True)
class ElevationNodes:
    """Nodes along the road, arrays of shape (n,); consecutive nodes of one way are connected.

    A node where the way changes stands in both ways.
    """

    lat_deg: FloatArray
    lon_deg: FloatArray
    alt_m: FloatArray
    way: IntArray


def elevation_nodes(
    road: Road, driven_m: float, start_lat_deg: float, start_lon_deg: float, rounding_m: float
) -> ElevationNodes:
    """Nodes at most 40 m apart, closer in bends, along the driven road and a little beyond.

    Parameters
    ----------
    rounding_m : float
        Altitudes are rounded to this; 0 leaves them as they are.
    """
    last = min(int((driven_m + _BEYOND_M) / ROAD_STEP_M), len(road.distance_m) - 1)
    turned = np.cumsum(np.abs(road.curvature_h_radpm[: last + 1])) * ROAD_STEP_M
    progress = road.distance_m[: last + 1] / _MOST_M + turned / _MOST_TURN_RAD
    index = np.searchsorted(progress, np.arange(0.0, progress[-1]))
    index = np.union1d(index, [last])
    way = road.way[index]
    border = np.flatnonzero(np.diff(way)) + 1
    index = np.insert(index, border, index[border])
    way = np.insert(way, border, way[border - 1])
    place = place_of(road.north_m[index], road.east_m[index], start_lat_deg, start_lon_deg)
    altitude = road.alt_m[index]
    if rounding_m > 0:
        altitude = np.rint(altitude / rounding_m) * rounding_m
    return ElevationNodes(place.lat_deg, place.lon_deg, np.round(altitude, 6), way)


def elevation_csv(nodes: ElevationNodes) -> bytes:
    """Write ``lat_deg,lon_deg,alt_m,way`` rows with a header."""
    rows = [
        f"{lat:.7f},{lon:.7f},{alt:.6g},{way}"
        for lat, lon, alt, way in zip(nodes.lat_deg, nodes.lon_deg, nodes.alt_m, nodes.way, strict=True)
    ]
    return "\n".join(["lat_deg,lon_deg,alt_m,way", *rows, ""]).encode("ascii")
