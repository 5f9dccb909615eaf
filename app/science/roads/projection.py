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
        east, north = self._projection()(_array(lon_deg), _array(lat_deg))
        return PlanePosition(_finite(north), _finite(east))

    def inverse(self, north_m: ArrayLike, east_m: ArrayLike) -> GeographicPosition:
        """Go back from metres to degrees; NaN stays NaN."""
        lon, lat = self._projection()(_array(east_m), _array(north_m), inverse=True)
        return GeographicPosition(_finite(lat), _finite(lon))

    def _projection(self) -> Proj:
        # Made anew each time (0.1 ms), because a projection object must not be shared between threads.
        return Proj(proj="tmerc", lat_0=self.lat_deg, lon_0=self.lon_deg, k=1.0, ellps="WGS84", units="m")


def _array(value: ArrayLike) -> FloatArray:
    return np.array(value, dtype=np.float64)  # a copy: the projection may write into what it is given


def _finite(value: object) -> FloatArray:
    result = np.asarray(value, dtype=np.float64)
    return np.where(np.isfinite(result), result, np.nan)
