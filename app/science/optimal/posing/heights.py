"""Elevation models: grids of degrees, and tables of roads."""

from __future__ import annotations

from dataclasses import dataclass
from math import floor
from typing import Protocol

import numpy as np

from app.science.arrays import FloatArray
from app.science.roads.elevation import RoadElevation


@dataclass(frozen=True, slots=True, eq=False)
class Tile:
    """One square degree of heights, rows from north to south, edges included.

    Attributes
    ----------
    south_deg, west_deg : int
        Its corner.
    alt_m : array, shape (n, n)
        NaN where unknown.
    """

    south_deg: int
    west_deg: int
    alt_m: FloatArray


def tile_name(lat_deg: float, lon_deg: float) -> str:
    """Return the usual name of the tile that a position lies in, by its south-west corner."""
    south, west = floor(lat_deg), floor(lon_deg)
    return f"{'N' if south >= 0 else 'S'}{abs(south):02d}{'E' if west >= 0 else 'W'}{abs(west):03d}.hgt"


class Heights(Protocol):
    """Heights of places under a name."""

    @property
    def name(self) -> str:
        """What a note calls them."""
        ...

    def at(self, lat_deg: FloatArray, lon_deg: FloatArray) -> FloatArray:
        """Return the heights at positions, m, shape (n,); NaN where unknown."""
        ...


@dataclass(frozen=True, slots=True, eq=False)
class RoadHeights:
    """The heights of a table of roads, within 25 m of them."""

    name: str
    roads: RoadElevation

    def at(self, lat_deg: FloatArray, lon_deg: FloatArray) -> FloatArray:
        """Return the height of the nearest road, m, shape (n,); NaN where there is none, or another one above it."""
        return self.roads.lookup(lat_deg, lon_deg).alt_m


@dataclass(frozen=True, slots=True, eq=False)
class TileHeights:
    """Tiles under a name, bilinear between their posts."""

    name: str
    tiles: tuple[Tile, ...]

    def at(self, lat_deg: FloatArray, lon_deg: FloatArray) -> FloatArray:
        """Return the heights at positions, m, shape (n,); NaN where no tile has them."""
        found = np.full(np.shape(lat_deg), np.nan)
        for tile in self.tiles:
            size = tile.alt_m.shape[0] - 1
            row = (tile.south_deg + 1.0 - lat_deg) * size
            column = (lon_deg - tile.west_deg) * size
            inside = (row >= 0.0) & (row <= size) & (column >= 0.0) & (column <= size)
            i, k = (np.minimum(x[inside].astype(np.int64), size - 1) for x in (row, column))
            u, v = row[inside] - i, column[inside] - k
            north = tile.alt_m[i, k] * (1.0 - v) + tile.alt_m[i, k + 1] * v
            south = tile.alt_m[i + 1, k] * (1.0 - v) + tile.alt_m[i + 1, k + 1] * v
            found[inside] = north * (1.0 - u) + south * u
        return found
