"""Quad-tiles (Sebesta 2010, App. C.1.1): the world halved and halved again, two bits a level.

Of each pair the first bit says left (0) or right (1), the second top (0) or bottom (1), on the square Web Mercator map.
The thesis leaves open which end level 1 stands at (note 31); here it is the most significant pair, so that a tile's
parent is the tile shifted right by two, and the tiles inside a tile are a range of numbers. A tile of zoom z has 2z
bits: 16 fills a 32-bit number (611 m on the equator, less beyond), 32 a 64-bit one (9 mm).

A point on a dividing line, which the thesis says cannot be placed (note 29), belongs to the right and the bottom tile.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from app.science.arrays import FloatArray

TileArray = NDArray[np.uint64]

DEEPEST_ZOOM = 32
LARGEST_LATITUDE_DEG = 85.0511287798066
"""Where the square Web Mercator map ends."""

_SPREAD = (
    (16, 0x0000FFFF0000FFFF),
    (8, 0x00FF00FF00FF00FF),
    (4, 0x0F0F0F0F0F0F0F0F),
    (2, 0x3333333333333333),
    (1, 0x5555555555555555),
)


@dataclass(frozen=True, slots=True)
class TileGrid:
    """Column (from the left) and row (from the top) of tiles, arrays of one shape."""

    column: TileArray
    row: TileArray


@dataclass(frozen=True, slots=True)
class TileBounds:
    """Edges of tiles in degrees, arrays of one shape. North and west edges belong to the tile."""

    south_deg: FloatArray
    west_deg: FloatArray
    north_deg: FloatArray
    east_deg: FloatArray


def grid_of(lat_deg: FloatArray | float, lon_deg: FloatArray | float, zoom: int) -> TileGrid:
    """Return column and row of the tiles that hold the points.

    Parameters
    ----------
    lat_deg, lon_deg : array or float
        Degrees; latitudes within ±85.0511°, longitudes from −180 to 180 (180 is −180).
    zoom : int
        1 to 32: the map has 2^zoom columns and rows.

    Raises
    ------
    ValueError
        When the zoom or a point is outside the map.
    """
    _check_zoom(zoom)
    lat, lon = np.broadcast_arrays(np.asarray(lat_deg, dtype=np.float64), np.asarray(lon_deg, dtype=np.float64))
    if not (np.all(np.abs(lat) <= LARGEST_LATITUDE_DEG) and np.all(np.abs(lon) <= 180.0)):
        raise ValueError(f"quad-tiles reach from −{LARGEST_LATITUDE_DEG:.4f}° to {LARGEST_LATITUDE_DEG:.4f}° north")
    side = 2.0**zoom
    across = np.where(lon == 180.0, 0.0, (lon + 180.0) / 360.0)  # just below 180° it rounds to 1: the last column
    down = 0.5 - np.arcsinh(np.tan(np.radians(lat))) / (2.0 * np.pi)
    column = np.minimum(np.floor(across * side), side - 1.0)
    row = np.clip(np.floor(down * side), 0.0, side - 1.0)
    return TileGrid(column.astype(np.uint64), row.astype(np.uint64))


def tile_of(lat_deg: FloatArray | float, lon_deg: FloatArray | float, zoom: int) -> TileArray:
    """Return the quad-tiles that hold the points; parameters and errors as for `grid_of`."""
    grid = grid_of(lat_deg, lon_deg, zoom)
    return (_spread(grid.column) << np.uint64(1)) | _spread(grid.row)


def grid_of_tile(tile: TileArray | int, zoom: int) -> TileGrid:
    """Return column and row of quad-tiles.

    Raises
    ------
    ValueError
        When a number is too large for a tile of that zoom.
    """
    _check_zoom(zoom)
    tiles = np.asarray(tile, dtype=np.uint64)
    if zoom < DEEPEST_ZOOM and np.any(tiles >> np.uint64(2 * zoom)):
        raise ValueError(f"a tile of zoom {zoom} has no more than {2 * zoom} bits")
    return TileGrid(_gather(tiles >> np.uint64(1)), _gather(tiles))


def bounds_of(tile: TileArray | int, zoom: int) -> TileBounds:
    """Return the edges of quad-tiles; errors as for `grid_of_tile`."""
    grid = grid_of_tile(tile, zoom)
    side = 2.0**zoom
    left, top = grid.column / side, grid.row / side
    return TileBounds(
        south_deg=_latitude(top + 1.0 / side),
        west_deg=left * 360.0 - 180.0,
        north_deg=_latitude(top),
        east_deg=(left + 1.0 / side) * 360.0 - 180.0,
    )


def bits_of(tile: int, zoom: int) -> str:
    """Return a tile as its pairs of bits, level 1 first: Australia lies in ``11``."""
    grid_of_tile(tile, zoom)
    return f"{int(tile):0{2 * zoom}b}"


def _check_zoom(zoom: int) -> None:
    if not 1 <= zoom <= DEEPEST_ZOOM:
        raise ValueError(f"zoom {zoom} is outside 1 to {DEEPEST_ZOOM}")


def _latitude(down: FloatArray) -> FloatArray:
    return np.asarray(np.degrees(np.arctan(np.sinh((0.5 - down) * 2.0 * np.pi))))


def _spread(value: TileArray) -> TileArray:
    """Put a zero before every bit."""
    for shift, mask in _SPREAD:
        value = (value | (value << np.uint64(shift))) & np.uint64(mask)
    return value


def _gather(value: TileArray) -> TileArray:
    """Keep every second bit: the inverse of `_spread`."""
    value = value & np.uint64(_SPREAD[-1][1])
    for (shift, _), (_, mask) in zip(_SPREAD[:0:-1], _SPREAD[-2::-1], strict=True):
        value = (value | (value >> np.uint64(shift))) & np.uint64(mask)
    return (value | (value >> np.uint64(16))) & np.uint64(0xFFFFFFFF)
