"""Road lookup against a plain search over every line with geodesic distances."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from pyproj import Geod

from app.science.arrays import FloatArray
from app.science.errors import SignalsError
from app.science.roads.elevation import RoadElevation, join_tables
from app.science.roads.projection import LocalPlane

WGS84 = Geod(ellps="WGS84")


def roads(lat0: float, lon0: float, north_m: list[float], east_m: list[float], alt_m: list[float], way: list[int]):
    place = LocalPlane(lat0, lon0).inverse(np.array(north_m), np.array(east_m))
    lon = (place.lon_deg + 180.0) % 360.0 - 180.0
    return RoadElevation(place.lat_deg, lon, np.array(alt_m), np.array(way))


def slow_lookup(road: RoadElevation, lat: float, lon: float) -> list[tuple[float, float]]:
    """Distance to, and altitude of, the nearest of many points set densely along each line."""
    found = []
    share = np.linspace(0.0, 1.0, 2001)
    for i in np.flatnonzero(np.diff(road.way) == 0):
        d_lon = (road.lon_deg[i + 1] - road.lon_deg[i] + 180.0) % 360.0 - 180.0
        lats = road.lat_deg[i] + share * (road.lat_deg[i + 1] - road.lat_deg[i])
        lons = road.lon_deg[i] + share * d_lon
        _, _, distance = WGS84.inv(np.full_like(lats, lon), np.full_like(lats, lat), lons, lats)
        nearest = int(np.argmin(distance))
        altitude = road.alt_m[i] + share[nearest] * (road.alt_m[i + 1] - road.alt_m[i])
        found.append((float(distance[nearest]), float(altitude)))
    return found


@settings(max_examples=20, deadline=None)
@given(st.floats(-75, 75), st.sampled_from([6.1, 179.9999, -122.4]), st.integers(0, 2**32 - 1))
def test_the_nearest_road_is_found_wherever_it_is(lat0: float, lon0: float, seed: int) -> None:
    random = np.random.default_rng(seed)
    north, east, way = [], [], []
    for number in range(3):
        lengths = random.choice([3.0, 40.0, 300.0], 5)
        angle = random.uniform(0, 2 * np.pi) + np.cumsum(random.normal(0, 0.5, 5))
        north += list(random.uniform(-150, 150) + np.cumsum(lengths * np.cos(angle)))
        east += list(random.uniform(-150, 150) + np.cumsum(lengths * np.sin(angle)))
        way += [number] * 5
    road = roads(lat0, lon0, north, east, list(random.uniform(0, 5, 15)), way)
    points = LocalPlane(lat0, lon0).inverse(random.uniform(-200, 200, 10), random.uniform(-200, 200, 10))
    match = road.lookup(points.lat_deg, points.lon_deg)
    for i in range(10):
        lines = slow_lookup(road, float(points.lat_deg[i]), float(points.lon_deg[i]))
        distance = min(lines)[0]
        if distance > 25.1:
            assert np.isnan(match.distance_m[i])
            assert np.isnan(match.alt_m[i])
        elif distance < 24.9:
            assert match.distance_m[i] == pytest.approx(distance, abs=0.05)
            candidates = [altitude for reached, altitude in lines if reached < distance + 0.05]
            assert np.isnan(match.alt_m[i]) or min(abs(a - match.alt_m[i]) for a in candidates) < 0.3


def climb(way: list[int] | None = None) -> RoadElevation:
    """A road of 2 km towards 30° that climbs by 5 m in 100 m, with nodes 500 m apart."""
    along = np.arange(5) * 500.0
    angle = np.radians(30.0)
    return roads(
        49.6, 6.1, list(along * np.cos(angle)), list(along * np.sin(angle)), list(100 + 0.05 * along), way or [7] * 5
    )


def beside(along_m: FloatArray, aside_m: float) -> tuple[FloatArray, FloatArray]:
    angle = np.radians(30.0)
    place = LocalPlane(49.6, 6.1).inverse(
        along_m * np.cos(angle) - aside_m * np.sin(angle), along_m * np.sin(angle) + aside_m * np.cos(angle)
    )
    return place.lat_deg, place.lon_deg


def test_altitude_heading_and_distance_on_a_straight_climb() -> None:
    along = np.linspace(1.0, 1999.0, 333)
    match = climb().lookup(*beside(along, -8.0))
    np.testing.assert_allclose(match.alt_m, 100 + 0.05 * along, atol=0.01)
    np.testing.assert_allclose(match.distance_m, 8.0, atol=0.01)
    np.testing.assert_allclose(match.heading_deg, 30.0, atol=0.05)


def test_out_of_reach_there_is_no_road() -> None:
    match = climb().lookup(*beside(np.array([500.0, 500.0, -24.0, -26.0]), 0.0))
    np.testing.assert_array_equal(np.isnan(match.distance_m), [False, False, False, True])
    far = climb().lookup(*beside(np.array([500.0]), 25.5))
    assert np.isnan([far.distance_m[0], far.alt_m[0], far.heading_deg[0]]).all()
    nothing = climb().lookup(np.array([np.nan, 89.9, -49.6]), np.array([6.1, 6.1, 6.1]))
    assert np.isnan(nothing.distance_m).all()


def test_nodes_of_different_ways_are_not_joined() -> None:
    match = climb([1, 1, 2, 2, 2]).lookup(*beside(np.array([250.0, 750.0, 1250.0]), 0.0))
    np.testing.assert_array_equal(np.isnan(match.alt_m), [False, True, False])


def test_a_gap_of_more_than_ten_kilometres_is_no_road() -> None:
    road = roads(49.6, 6.1, [0.0, 100.0, 12_100.0], [0.0, 0.0, 0.0], [10.0, 20.0, 30.0], [1, 1, 1])
    between = LocalPlane(49.6, 6.1).inverse(np.array([50.0, 6000.0]), np.zeros(2))
    np.testing.assert_array_equal(np.isnan(road.lookup(between.lat_deg, between.lon_deg).alt_m), [False, True])


def test_a_junction_has_an_altitude_but_no_direction() -> None:
    cross = roads(49.6, 6.1, [-200, 200, 0, 0], [0, 0, -200, 200], [50.0, 50.0, 50.0, 50.0], [1, 1, 2, 2])
    place = LocalPlane(49.6, 6.1).inverse(np.array([1.0, 60.0]), np.array([2.0, 2.0]))
    match = cross.lookup(place.lat_deg, place.lon_deg)
    np.testing.assert_allclose(match.alt_m, 50.0)
    assert np.isnan(match.heading_deg[0])
    assert match.heading_deg[1] == pytest.approx(0.0, abs=0.01)


def test_under_a_bridge_the_altitude_is_left_open() -> None:
    bridge = roads(49.6, 6.1, [-200, 200, 0, 0], [0, 0, -200, 200], [50.0, 50.0, 57.0, 57.0], [1, 1, 2, 2])
    place = LocalPlane(49.6, 6.1).inverse(np.array([1.0, 60.0]), np.array([2.0, 2.0]))
    match = bridge.lookup(place.lat_deg, place.lon_deg)
    assert np.isnan(match.alt_m[0])
    assert match.alt_m[1] == pytest.approx(50.0)
    assert match.distance_m[0] == pytest.approx(1.0, abs=0.01)


def test_a_steep_road_does_not_stand_in_its_own_way() -> None:
    match = climb().lookup(*beside(np.linspace(480.0, 520.0, 41), 20.0))
    assert not np.isnan(match.alt_m).any()
    assert not np.isnan(match.heading_deg).any()


def test_tables_are_described_and_joined() -> None:
    one, other = climb(), roads(50.6, 6.1, [0, 100], [0, 0], [1.0, 2.0], [7, 7])
    assert one.node_count == 5
    assert one.bounds.south_deg == pytest.approx(49.6)
    assert one.bounds.north_deg > 49.61
    both = join_tables([one, other])
    assert both.node_count == 7
    assert len(np.unique(both.way)) == 2
    assert both.lookup(*beside(np.array([250.0]), 0.0)).alt_m[0] == pytest.approx(112.5, abs=0.01)
    with pytest.raises(SignalsError):
        join_tables([])


def test_the_table_is_written_to_the_last_digit() -> None:
    rows = climb().to_csv().decode().splitlines()
    assert rows[0] == "lat_deg,lon_deg,alt_m,way"
    read = np.array([row.split(",") for row in rows[1:]], dtype=np.float64)
    np.testing.assert_array_equal(read[:, 0], climb().lat_deg)
    np.testing.assert_array_equal(read[:, 2], climb().alt_m)


@pytest.mark.parametrize(
    ("lat", "lon", "alt", "row", "field"),
    [
        ([49.0, 91.0], [6.0, 6.0], [1.0, 2.0], 3, "lat_deg"),
        ([49.0, 49.1], [6.0, 200.0], [1.0, 2.0], 3, "lon_deg"),
        ([49.0, 49.1], [6.0, 6.0], [np.nan, 2.0], 2, "alt_m"),
        ([49.0, 49.1], [6.0, 6.0], [1.0, 12_000.0], 3, "alt_m"),
        ([49.0], [6.0], [1.0], 0, ""),
    ],
)
def test_nodes_that_can_not_be_are_refused_with_their_row(
    lat: list[float], lon: list[float], alt: list[float], row: int, field: str
) -> None:
    with pytest.raises(SignalsError) as caught:
        RoadElevation(np.array(lat), np.array(lon), np.array(alt), np.zeros(len(lat), np.int64))
    assert (caught.value.row, caught.value.field) == (row, field)


def test_roads_beyond_measure_are_refused() -> None:
    zigzag = np.tile([49.0, 49.08], 20_000)
    with pytest.raises(SignalsError, match="split it by region"):
        RoadElevation(zigzag, np.full(40_000, 6.0), np.zeros(40_000), np.zeros(40_000, np.int64))
