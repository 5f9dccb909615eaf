"""Elevation tiles of the Shuttle Radar Topography Mission (.hgt, packed or not)."""

from __future__ import annotations

import io
import re
import zipfile
from collections.abc import Iterable
from math import isqrt
from pathlib import PurePath

import numpy as np

from app.science.errors import SignalsError
from app.science.optimal.posing.heights import Tile, TileHeights

SIZES = (1201, 3601)
VOID = -32768
NAME = re.compile(r"([NS])(\d{2})([EW])(\d{3})", re.IGNORECASE)
LARGEST_BYTES = 2 * max(SIZES) ** 2


def read_hgt(files: Iterable[tuple[str, bytes]]) -> TileHeights:
    """Read tiles; the name of each tells its south-west corner, such as ``N42E001.hgt`` or ``N42E001.hgt.zip``.

    Parameters
    ----------
    files : iterable of (name, bytes)

    Raises
    ------
    SignalsError
        When a name or a size isn't that of a tile.
    """
    tiles, names = [], []
    for name, data in files:
        plain = PurePath(name).name
        tiles.append(_tile(plain, _unpacked(plain, data)))
        names.append(plain)
    return TileHeights(", ".join(names), tuple(tiles))


def _unpacked(name: str, data: bytes) -> bytes:
    if not data.startswith(b"PK\x03\x04"):
        return data
    try:
        with zipfile.ZipFile(io.BytesIO(data)) as archive:
            inside = [entry for entry in archive.infolist() if entry.filename.lower().endswith(".hgt")]
            if len(inside) != 1 or inside[0].file_size > LARGEST_BYTES:
                raise SignalsError(f"{name} holds no single elevation tile (.hgt).")
            return archive.read(inside[0])
    except zipfile.BadZipFile as error:
        raise SignalsError(f"{name} is a damaged ZIP archive.") from error


def _tile(name: str, data: bytes) -> Tile:
    corner = NAME.search(name)
    size = isqrt(len(data) // 2)
    if corner is None:
        raise SignalsError(f"{name}: an elevation tile is named by its south-west corner, such as N42E001.hgt.")
    if size not in SIZES or len(data) != 2 * size * size:
        expected = " or ".join(str(2 * side * side) for side in SIZES)
        raise SignalsError(f"{name} has {len(data)} bytes; an elevation tile has {expected}.")
    values = np.frombuffer(data, dtype=">i2").reshape(size, size).astype(np.float64)
    values[values == VOID] = np.nan
    north, lat, east, lon = corner.groups()
    return Tile(int(lat) if north.upper() == "N" else -int(lat), int(lon) if east.upper() == "E" else -int(lon), values)
