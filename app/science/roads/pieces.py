"""Roads cut into short pieces and sorted into map tiles, so that the pieces near a point are found at once."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from app.science.arrays import BoolArray, FloatArray, IntArray
from app.science.errors import SignalsError
from app.science.roads.quadtiles import LARGEST_LATITUDE_DEG, grid_of

PIECE_M = 30.0
LONGEST_LINE_M = 10_000.0
MOST_PIECES = 5_000_000
SAME_ROAD_M = 100.0
_EQUATOR_M = 40_075_016.686
_AXIS_M, _FLATNESS = 6_378_137.0, 0.00669437999014  # WGS 84: half axis and squared eccentricity


@dataclass(frozen=True, slots=True)
class NearPieces:
    """Pairs of a point and a piece near it, arrays of shape (pairs,), the pairs of one point side by side.

    Attributes
    ----------
    point : array of int
        Index of the point.
    distance_m, alt_m, heading_deg : array
        Distance from the point to the piece, altitude at the nearest place of it, direction of it (0 to 180).
    way, along_m : array
        Which way the piece belongs to and how far along it the nearest place is.
    """

    point: IntArray
    distance_m: FloatArray
    alt_m: FloatArray
    heading_deg: FloatArray
    way: IntArray
    along_m: FloatArray

    def nearest(self) -> tuple[IntArray, IntArray]:
        """Return the nearest pair of each point that has one, shape (groups,), and each pair's group, (pairs,)."""
        begins = np.concatenate([[True], np.diff(self.point) > 0])
        group = np.cumsum(begins) - 1
        least = np.minimum.reduceat(self.distance_m, np.flatnonzero(begins))
        pairs = np.flatnonzero(self.distance_m == least[group])
        _, first = np.unique(group[pairs], return_index=True)
        return pairs[first], group

    def far_along_the_way(self, other: IntArray) -> BoolArray:
        """Tell for each pair whether the pair `other` lies on another road, or far along this one."""
        apart: BoolArray = np.abs(self.along_m - self.along_m[other]) > SAME_ROAD_M
        elsewhere: BoolArray = self.way != self.way[other]
        return apart | elsewhere


@dataclass(frozen=True, slots=True)
class RoadPieces:
    """Pieces of at most 30 m, sorted by the map tile their middle lies in; arrays of shape (pieces,).

    A tile is at least as wide as the reach plus half a piece, so that all pieces within reach of a point have their
    middle in the point's tile or one of its eight neighbours: the search leaves nothing out.
    """

    key: IntArray
    lat_deg: FloatArray
    lon_deg: FloatArray
    d_lat_deg: FloatArray
    d_lon_deg: FloatArray
    alt_m: FloatArray
    climb_m: FloatArray
    way: IntArray
    along_m: FloatArray
    length_m: FloatArray
    zoom: int

    def near(self, lat_deg: FloatArray, lon_deg: FloatArray) -> NearPieces:
        """Return all pieces in the tiles around each point; points off the map or NaN have none."""
        on_map = np.flatnonzero((np.abs(lat_deg) <= LARGEST_LATITUDE_DEG) & (np.abs(lon_deg) <= 180.0))
        lat, lon = lat_deg[on_map], lon_deg[on_map]
        grid = grid_of(lat, lon, self.zoom)
        side = 1 << self.zoom
        columns = (grid.column.astype(np.int64)[:, None] + np.array([-1, 0, 1])) % side
        row = grid.row.astype(np.int64)[:, None]
        first = np.searchsorted(self.key, _key(columns, np.maximum(row - 1, 0)), side="left")
        last = np.searchsorted(self.key, _key(columns, np.minimum(row + 1, side - 1)), side="right")
        count = (last - first).ravel()
        local = np.repeat(np.arange(len(on_map)).repeat(3), count)
        piece = np.arange(count.sum()) + np.repeat(first.ravel() - (np.cumsum(count) - count), count)
        return self._measure(on_map[local], piece, lat[local], lon[local])

    def _measure(self, point: IntArray, piece: IntArray, lat: FloatArray, lon: FloatArray) -> NearPieces:
        north_per_deg, east_per_deg = metres_per_degree(lat)
        north = (self.lat_deg[piece] - lat) * north_per_deg
        east = ((self.lon_deg[piece] - lon + 180.0) % 360.0 - 180.0) * east_per_deg
        d_north, d_east = self.d_lat_deg[piece] * north_per_deg, self.d_lon_deg[piece] * east_per_deg
        squared = d_north**2 + d_east**2
        with np.errstate(invalid="ignore", divide="ignore"):
            share = np.where(squared > 0.0, -(north * d_north + east * d_east) / squared, 0.0)
        share = np.clip(share, 0.0, 1.0)
        return NearPieces(
            point,
            np.hypot(north + share * d_north, east + share * d_east),
            self.alt_m[piece] + share * self.climb_m[piece],
            np.degrees(np.arctan2(d_east, d_north)) % 180.0,
            self.way[piece],
            self.along_m[piece] + share * self.length_m[piece],
        )


def cut_into_pieces(
    lat_deg: FloatArray, lon_deg: FloatArray, alt_m: FloatArray, way: IntArray, reach_m: float
) -> RoadPieces:
    """Cut the lines between neighbouring nodes of one way into pieces.

    Parameters
    ----------
    lat_deg, lon_deg, alt_m, way : array, shape (n,)
        The nodes.
    reach_m : float
        How far from a point pieces must be found.

    Raises
    ------
    SignalsError
        When the roads are too long for one table.
    """
    north_per_deg, east_per_deg = metres_per_degree((lat_deg[:-1] + lat_deg[1:]) / 2.0)
    d_lat, d_lon = np.diff(lat_deg), (np.diff(lon_deg) + 180.0) % 360.0 - 180.0
    length = np.hypot(d_lat * north_per_deg, d_lon * east_per_deg)
    along = np.concatenate([[0.0], np.cumsum(length)[:-1]])
    line = np.flatnonzero((np.diff(way) == 0) & (length <= LONGEST_LINE_M) & (length > 0.0))
    parts = np.ceil(length[line] / PIECE_M).astype(np.int64)
    if parts.sum() > MOST_PIECES:
        raise SignalsError(
            f"The roads of this elevation table are {length[line].sum() / 1000.0:.0f} km long, more than one table "
            f"takes; split it by region."
        )
    of, step = np.repeat(line, parts), 1.0 / np.repeat(parts, parts)
    share = (np.arange(parts.sum()) - np.repeat(np.cumsum(parts) - parts, parts)) * step
    lat, climb = lat_deg[of] + share * d_lat[of], np.diff(alt_m)[of]
    lon = (lon_deg[of] + share * d_lon[of] + 180.0) % 360.0 - 180.0
    zoom = _zoom(float(np.abs(lat_deg).max()), reach_m)
    middle_lon = (lon + 0.5 * step * d_lon[of] + 180.0) % 360.0 - 180.0
    grid = grid_of(lat + 0.5 * step * d_lat[of], middle_lon, zoom)
    key = _key(grid.column.astype(np.int64), grid.row.astype(np.int64))
    order = np.argsort(key, kind="stable")
    of, share, step = of[order], share[order], step[order]
    return RoadPieces(
        key=key[order],
        lat_deg=lat[order],
        lon_deg=lon[order],
        d_lat_deg=step * d_lat[of],
        d_lon_deg=step * d_lon[of],
        alt_m=alt_m[of] + share * climb[order],
        climb_m=step * climb[order],
        way=way[of],
        along_m=along[of] + share * length[of],
        length_m=step * length[of],
        zoom=zoom,
    )


def _zoom(largest_lat_deg: float, reach_m: float) -> int:
    """Return the deepest zoom whose tiles are wide enough wherever the table reaches."""
    smallest = _EQUATOR_M * np.cos(np.radians(min(largest_lat_deg + 0.1, 89.0)))
    return max(1, int(np.floor(np.log2(smallest / (reach_m + PIECE_M / 2.0)))))


def _key(column: IntArray, row: IntArray) -> IntArray:
    return (column << 32) | row


def metres_per_degree(lat_deg: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Return how many metres a degree of latitude and one of longitude are on WGS 84."""
    lat = np.radians(lat_deg)
    w = 1.0 - _FLATNESS * np.sin(lat) ** 2
    one_degree = np.pi / 180.0
    north = one_degree * _AXIS_M * (1.0 - _FLATNESS) / w**1.5
    east = one_degree * _AXIS_M / np.sqrt(w) * np.cos(lat)
    return north, east
