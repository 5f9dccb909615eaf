"""From the plane around the start to latitude and longitude."""

from __future__ import annotations

from dataclasses import dataclass

from pyproj import Transformer

from app.science.arrays import FloatArray


@dataclass(frozen=True, slots=True)
class Place:
    """Latitude and longitude, degrees, arrays of shape (n,)."""

    lat_deg: FloatArray
    lon_deg: FloatArray


def place_of(north_m: FloatArray, east_m: FloatArray, lat0_deg: float, lon0_deg: float) -> Place:
    """Geographic place of points on the transverse Mercator plane (scale 1, WGS 84) at a centre."""
    plane = f"+proj=tmerc +lat_0={lat0_deg!r} +lon_0={lon0_deg!r} +k=1 +ellps=WGS84 +units=m"
    lon, lat = Transformer.from_crs(plane, "EPSG:4326", always_xy=True).transform(east_m, north_m)
    return Place(lat, lon)
