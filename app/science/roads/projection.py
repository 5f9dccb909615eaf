"""The local plane: north and east in metres around a place, and back."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from pyproj import Proj

from app.science.arrays import FloatArray

ArrayLike = FloatArray | float


@dataclass(frozen=True, slots=True)
class PlanePosition:
    """Positions in the local plane, metres; arrays of one shape."""

    north_m: FloatArray
    east_m: FloatArray


@dataclass(frozen=True, slots=True)
class GeographicPosition:
    """Positions on WGS 84, degrees; arrays of one shape."""

    lat_deg: FloatArray
    lon_deg: FloatArray


@dataclass(frozen=True, slots=True)
class LocalPlane:
    """Transverse Mercator projection of WGS 84 around a place, with scale 1 on its meridian.

    It is conformal, so headings are kept. At x metres east or west of the origin lengths grow by x²/2R²: one part in
    a million at 9 km, 31 parts at 50 km, and a trip's heights play no part in it.

    Parameters
    ----------
    lat_deg, lon_deg : float
        The origin.

    Raises
    ------
    ValueError
        When the origin isn't on Earth.
    """

    lat_deg: float
    lon_deg: float

    def __post_init__(self) -> None:
        if not (abs(self.lat_deg) <= 90.0 and abs(self.lon_deg) <= 360.0):
            raise ValueError(f"latitude {self.lat_deg}°, longitude {self.lon_deg}° is not a place on Earth")

    def forward(self, lat_deg: ArrayLike, lon_deg: ArrayLike) -> PlanePosition:
        """Project; NaN stays NaN.

        Parameters
        ----------
        lat_deg, lon_deg : array or float
            Degrees on WGS 84.
        """
        projection = _projection()
        _, origin_m = projection(0.0, self.lat_deg)
        lat, lon = _arrays(lat_deg, lon_deg)
        east, north = projection((lon - self.lon_deg + 180.0) % 360.0 - 180.0, lat)
        return PlanePosition(_finite(north) - origin_m, _finite(east))

    def inverse(self, north_m: ArrayLike, east_m: ArrayLike) -> GeographicPosition:
        """Go back from metres to degrees; NaN stays NaN."""
        projection = _projection()
        _, origin_m = projection(0.0, self.lat_deg)
        north, east = _arrays(north_m, east_m)
        lon, lat = projection(east, north + origin_m, inverse=True)
        return GeographicPosition(_finite(lat), (_finite(lon) + self.lon_deg + 180.0) % 360.0 - 180.0)


def _projection() -> Proj:
    """Return the projection around 0° north, 0° east.

    It is made anew each time (0.1 ms), because a projection object must not be shared between threads. The origin is
    left to `LocalPlane`, because the library moves one that lies within 1e-8° of a whole degree.
    """
    return Proj(proj="tmerc", lat_0=0.0, lon_0=0.0, k=1.0, ellps="WGS84", units="m")


def _arrays(first: ArrayLike, second: ArrayLike) -> tuple[FloatArray, FloatArray]:
    """Return both as arrays of one shape; copies, because the projection may write into what it is given."""
    one, other = np.broadcast_arrays(np.asarray(first, np.float64), np.asarray(second, np.float64))
    return one.copy(), other.copy()


def _finite(value: object) -> FloatArray:
    result = np.asarray(value, dtype=np.float64)
    return np.where(np.isfinite(result), result, np.nan)
