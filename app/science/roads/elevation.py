"""How high the road lies, and which way it runs, wherever the car was near it (Sebesta 2010, 2.5.2)."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, field

import numpy as np

from app.science.arrays import FloatArray, IntArray
from app.science.errors import SignalsError
from app.science.roads.pieces import RoadPieces, cut_into_pieces
from app.science.roads.quadtiles import LARGEST_LATITUDE_DEG

REACH_M = 25.0
"""A road further away than this is another road."""
RIVAL_M = 5.0
"""Roads whose distances differ by less than this can't be told apart by a receiver."""
RIVAL_CLIMB_M = 2.0
RIVAL_TURN_DEG = 15.0
COLUMNS = ("lat_deg", "lon_deg", "alt_m", "way")
_HIGHEST_M, _LOWEST_M = 9000.0, -500.0


@dataclass(frozen=True, slots=True)
class RoadMatch:
    """The nearest road at each point, arrays of shape (n,), NaN where there is none within 25 m.

    Attributes
    ----------
    alt_m : array
        Altitude of the road at the nearest point of it; also NaN where another road equally near lies at another
        height, as at a bridge.
    heading_deg : array
        Direction of the road, 0 to 180: north is 0, east 90, and a road has no forward. NaN where roads equally near
        run otherwise, as at a junction.
    distance_m : array
        To the nearest point of the road.
    """

    alt_m: FloatArray
    heading_deg: FloatArray
    distance_m: FloatArray


@dataclass(frozen=True, slots=True)
class Bounds:
    """The area of a table, degrees."""

    south_deg: float
    west_deg: float
    north_deg: float
    east_deg: float


@dataclass(frozen=True, slots=True, eq=False)
class RoadElevation:
    """Roads as nodes with altitude; neighbouring nodes of one way are joined by straight lines of steady slope.

    Nodes of one way more than 10 km apart are not joined. Distances are taken on a plane tangent to WGS 84 at the point
    in question: within the 25 m that matter their error is about a millimetre. Altitudes are as good as the table: on
    the virtual road, with nodes at most 40 m apart and rounded to 0.1 m, they are right to 0.03 m rms, and to 0.07 m
    when the position scatters by 2.5 m.

    Parameters
    ----------
    lat_deg, lon_deg, alt_m : array, shape (n,)
        The nodes in order along each way.
    way : array of int, shape (n,)
        Which way each node belongs to; a way ends where the number changes.

    Raises
    ------
    SignalsError
        When there are fewer than two nodes or one can't be. `row` is the node's row in a table with a header.
    """

    lat_deg: FloatArray
    lon_deg: FloatArray
    alt_m: FloatArray
    way: IntArray
    _pieces: RoadPieces = field(init=False, repr=False)

    def __post_init__(self) -> None:
        for name, dtype in zip(COLUMNS, (np.float64, np.float64, np.float64, np.int64), strict=True):
            object.__setattr__(self, name, np.ascontiguousarray(getattr(self, name), dtype=dtype))
        _check(self)
        object.__setattr__(self, "_pieces", cut_into_pieces(self.lat_deg, self.lon_deg, self.alt_m, self.way, REACH_M))

    @property
    def node_count(self) -> int:
        """Number of nodes."""
        return len(self.lat_deg)

    @property
    def bounds(self) -> Bounds:
        """The smallest rectangle of latitudes and longitudes that holds all nodes."""
        return Bounds(
            float(self.lat_deg.min()), float(self.lon_deg.min()), float(self.lat_deg.max()), float(self.lon_deg.max())
        )

    def lookup(self, lat_deg: FloatArray, lon_deg: FloatArray) -> RoadMatch:
        """Find the road at each point.

        Parameters
        ----------
        lat_deg, lon_deg : array, shape (n,)
            Degrees on WGS 84; NaN gives NaN.

        Returns
        -------
        RoadMatch
        """
        lat, lon = np.atleast_1d(np.asarray(lat_deg, np.float64)), np.atleast_1d(np.asarray(lon_deg, np.float64))
        alt, heading, distance = (np.full(lat.shape, np.nan) for _ in range(3))
        near = self._pieces.near(lat, lon)
        if len(near.distance_m):
            best, group = near.nearest()
            best_of = best[group]
            rival = near.distance_m <= near.distance_m[best_of] + RIVAL_M
            turn = np.abs((near.heading_deg - near.heading_deg[best_of] + 90.0) % 180.0 - 90.0)
            crossing = np.bincount(group[rival & (turn > RIVAL_TURN_DEG)], minlength=len(best)) > 0
            apart = near.far_along_the_way(best_of) & (np.abs(near.alt_m - near.alt_m[best_of]) > RIVAL_CLIMB_M)
            stacked = np.bincount(group[rival & apart], minlength=len(best)) > 0
            point = near.point[best]
            distance[point] = near.distance_m[best]
            alt[point] = np.where(stacked, np.nan, near.alt_m[best])
            heading[point] = np.where(crossing, np.nan, near.heading_deg[best])
            beyond = ~(distance <= REACH_M)
            alt[beyond] = heading[beyond] = distance[beyond] = np.nan
        return RoadMatch(alt, heading, distance)

    def to_csv(self) -> bytes:
        """Return the table as CSV with the columns ``lat_deg,lon_deg,alt_m,way``; every number reads back exactly."""
        columns = (self.lat_deg.tolist(), self.lon_deg.tolist(), self.alt_m.tolist(), self.way.tolist())
        rows = (f"{lat!r},{lon!r},{alt!r},{way}\n" for lat, lon, alt, way in zip(*columns, strict=True))
        return (",".join(COLUMNS) + "\n" + "".join(rows)).encode()


def join_tables(tables: Iterable[RoadElevation]) -> RoadElevation:
    """Return one table with the roads of all; ways of different tables stay apart.

    Raises
    ------
    SignalsError
        When there is no table.
    """
    parts = list(tables)
    if not parts:
        raise SignalsError("There is no elevation table to join.")
    ways, first = [], 0
    for part in parts:
        _, numbers = np.unique(part.way, return_inverse=True)
        ways.append(numbers + first)
        first += int(numbers.max()) + 1
    return RoadElevation(
        np.concatenate([part.lat_deg for part in parts]),
        np.concatenate([part.lon_deg for part in parts]),
        np.concatenate([part.alt_m for part in parts]),
        np.concatenate(ways),
    )


def _check(road: RoadElevation) -> None:
    if len({len(road.lat_deg), len(road.lon_deg), len(road.alt_m), len(road.way)}) > 1 or road.lat_deg.ndim != 1:
        raise SignalsError("The columns of an elevation table must be equally long.")
    if road.node_count < 2:
        raise SignalsError(f"An elevation table needs at least two nodes; this one has {road.node_count}.")
    limits = {
        "lat_deg": (-LARGEST_LATITUDE_DEG, LARGEST_LATITUDE_DEG),
        "lon_deg": (-180.0, 180.0),
        "alt_m": (_LOWEST_M, _HIGHEST_M),
    }
    for name, (low, high) in limits.items():
        values: FloatArray = getattr(road, name)
        wrong = np.flatnonzero(~((values >= low) & (values <= high)))
        if len(wrong):
            row = int(wrong[0]) + 2
            raise SignalsError(
                f"Row {row}: {name} is {values[wrong[0]]:g}; it must lie between {low:g} and {high:g}.", row, name
            )
