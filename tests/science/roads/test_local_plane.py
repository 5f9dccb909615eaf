"""The local plane against geodesics on the ellipsoid."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from pyproj import Geod

from app.science.roads.projection import LocalPlane

WGS84 = Geod(ellps="WGS84")


@given(st.floats(-80, 80), st.floats(-180, 180), st.floats(0, 360), st.floats(1, 9_000))
def test_distance_and_azimuth_from_the_origin_are_those_of_the_geodesic(
    lat: float, lon: float, azimuth_deg: float, distance_m: float
) -> None:
    to_lon, to_lat, _ = WGS84.fwd(lon, lat, azimuth_deg, distance_m)
    place = LocalPlane(lat, lon).forward(to_lat, to_lon)
    assert float(np.hypot(place.north_m, place.east_m)) == pytest.approx(distance_m, rel=1e-6, abs=1e-6)
    turn = np.degrees(np.arctan2(place.east_m, place.north_m)) - azimuth_deg
    assert (float(turn) + 180.0) % 360.0 - 180.0 == pytest.approx(0.0, abs=1e-3)


@given(st.floats(-80, 80), st.floats(-180, 180), st.floats(-1e5, 1e5), st.floats(-1e5, 1e5))
def test_there_and_back(lat: float, lon: float, north_m: float, east_m: float) -> None:
    plane = LocalPlane(lat, lon)
    there = plane.inverse(north_m, east_m)
    back = plane.forward(there.lat_deg, there.lon_deg)
    assert float(back.north_m) == pytest.approx(north_m, abs=1e-4)
    assert float(back.east_m) == pytest.approx(east_m, abs=1e-4)


def test_arrays_keep_their_shape_and_their_gaps() -> None:
    plane = LocalPlane(49.6, 6.1)
    lat = np.array([49.6, np.nan, 49.61])
    place = plane.forward(lat, np.full(3, 6.1))
    np.testing.assert_allclose(place.north_m, [0.0, np.nan, 1112.2], atol=0.1)
    np.testing.assert_allclose(place.east_m, [0.0, np.nan, 0.0], atol=1e-6)
    np.testing.assert_array_equal(lat, [49.6, np.nan, 49.61])
    np.testing.assert_allclose(plane.inverse(np.array([0.0, np.nan]), 0.0).lon_deg, [6.1, np.nan])


@pytest.mark.parametrize(("lat", "lon"), [(49.000000001, 7.000000001), (1e-9, 179.9999999999), (49.6, 6.1)])
def test_the_origin_is_exactly_the_origin(lat: float, lon: float) -> None:
    place = LocalPlane(lat, lon).forward(lat, lon)
    assert abs(float(place.north_m)) < 1e-8
    assert abs(float(place.east_m)) < 1e-8


@pytest.mark.parametrize(("lat", "lon"), [(91.0, 0.0), (float("nan"), 0.0), (0.0, 400.0)])
def test_an_origin_off_the_earth_is_refused(lat: float, lon: float) -> None:
    with pytest.raises(ValueError, match="not a place"):
        LocalPlane(lat, lon)
