"""Quad-tiles: the thesis' continents, and a plain bit-by-bit construction."""

from __future__ import annotations

from math import log, pi, radians, tan

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from app.science.roads.quadtiles import LARGEST_LATITUDE_DEG, bits_of, bounds_of, grid_of, grid_of_tile, tile_of

zooms = st.integers(1, 32)
latitudes = st.floats(-LARGEST_LATITUDE_DEG, LARGEST_LATITUDE_DEG)
longitudes = st.floats(-180, 180, exclude_max=True)


def halved(lat: float, lon: float, zoom: int) -> int:
    """The construction of App. C.1.1: halve the map left/right and top/bottom, level by level."""
    x, y = (lon + 180.0) / 360.0, 0.5 - log(tan(pi / 4 + radians(lat) / 2)) / (2 * pi)
    tile = 0
    for _ in range(zoom):
        x, y = 2 * x, 2 * y
        right, bottom = x >= 1, y >= 1
        x, y = x - right, y - bottom
        tile = tile << 2 | right << 1 | bottom
    return tile


@pytest.mark.parametrize(
    ("place", "lat", "lon", "bits"),
    [
        ("Steep Point, Australia", -26.15, 113.16, "11"),
        ("Cape York, Australia", -10.69, 142.53, "11"),
        ("South East Cape, Australia", -43.64, 146.83, "11"),
        ("Cape Farewell, Greenland", 59.77, -43.92, "00"),
        ("Cape Morris Jesup, Greenland", 83.63, -32.5, "00"),
        ("Colombia, South America", 4.6, -74.1, "00"),
        ("Argentina, South America", -34.6, -58.4, "01"),
        ("Luxembourg", 49.6, 6.1, "10"),
    ],
)
def test_continents_lie_where_the_thesis_says(place: str, lat: float, lon: float, bits: str) -> None:
    assert bits_of(int(tile_of(lat, lon, 1)), 1) == bits, place


@given(st.floats(-84, 84), longitudes, st.integers(1, 24))
def test_the_bits_are_those_of_halving_the_map(lat: float, lon: float, zoom: int) -> None:
    edge = 2.0**zoom * (0.5 - log(tan(pi / 4 + radians(lat) / 2)) / (2 * pi))
    if abs(edge - round(edge)) > 1e-6:
        assert int(tile_of(lat, lon, zoom)) == halved(lat, lon, zoom)


@given(latitudes, longitudes, zooms)
def test_a_tile_holds_its_point(lat: float, lon: float, zoom: int) -> None:
    bounds = bounds_of(tile_of(lat, lon, zoom), zoom)
    rounding = 1e-12
    assert bounds.south_deg - rounding <= lat <= bounds.north_deg + rounding
    assert bounds.west_deg - rounding <= lon <= bounds.east_deg + rounding


@given(latitudes, longitudes, st.integers(2, 32))
def test_a_parent_is_its_child_shifted_right_by_two(lat: float, lon: float, zoom: int) -> None:
    assert int(tile_of(lat, lon, zoom)) >> 2 == int(tile_of(lat, lon, zoom - 1))


@given(st.data(), zooms)
def test_every_tile_is_the_tile_of_its_middle(data: st.DataObject, zoom: int) -> None:
    tile = data.draw(st.integers(0, 4**zoom - 1))
    bounds = bounds_of(tile, zoom)
    grid = grid_of_tile(tile, zoom)
    assert bits_of(tile, zoom)[::2] == f"{int(grid.column):0{zoom}b}"
    assert bits_of(tile, zoom)[1::2] == f"{int(grid.row):0{zoom}b}"
    if zoom <= 28:  # deeper, the middle of a tile is a matter of rounding
        middle_lat = (bounds.south_deg + bounds.north_deg) / 2
        assert int(tile_of(middle_lat, (bounds.west_deg + bounds.east_deg) / 2, zoom)) == tile


def test_tiles_have_the_sizes_of_the_thesis() -> None:
    equator_m = 40_075_016.7
    assert equator_m / 2**16 == pytest.approx(611.5, abs=0.1)
    assert equator_m / 2**32 < 0.01
    wide = bounds_of(tile_of(49.6, 6.1, 16), 16)
    assert float(wide.north_deg - wide.south_deg) * 111_200 == pytest.approx(611.5 * np.cos(np.radians(49.6)), rel=0.01)
    assert int(tile_of(-85.0, 179.99, 16)) < 2**32
    assert int(tile_of(-85.0511, 179.9999999, 32)) < 2**64


def test_arrays_go_through_at_once() -> None:
    tiles = tile_of(np.array([-25.0, 70.0]), np.array([133.0, -40.0]), 1)
    np.testing.assert_array_equal(tiles, [3, 0])
    assert float(bounds_of(tiles, 1).south_deg[1]) == 0.0


def test_lines_of_division_belong_to_the_right_and_the_bottom() -> None:
    assert bits_of(int(tile_of(0.0, 0.0, 1)), 1) == "11"
    assert int(grid_of(10.0, 180.0, 8).column) == 0
    assert int(grid_of(10.0, 179.99999999999997, 8).column) == 255


@pytest.mark.parametrize(("lat", "lon", "zoom"), [(86.0, 0.0, 3), (0.0, 181.0, 3), (float("nan"), 0.0, 3), (0, 0, 0)])
def test_what_is_off_the_map_is_refused(lat: float, lon: float, zoom: int) -> None:
    with pytest.raises(ValueError, match=r"quad-tiles reach|zoom"):
        tile_of(lat, lon, zoom)
    with pytest.raises(ValueError, match="bits"):
        bits_of(4**5, 5)
