"""Tracks, cycles and trips as roads."""

from __future__ import annotations

import numpy as np
import pytest
from pyproj import Geod

from app.science.optimal.posing.cycle import roads_of_cycle
from app.science.optimal.posing.errors import PoseError
from app.science.optimal.posing.heights import RoadHeights, Tile, TileHeights, tile_name
from app.science.optimal.posing.track import Track, along_m, road_of_track
from app.science.optimal.posing.trip import road_of_states
from app.science.roads.elevation import RoadElevation

LAT = 42.5 + np.linspace(0.0, 0.05, 101)
LON = 1.5 + 0.01 * np.sin(np.linspace(0.0, 6.0, 101))
UNKNOWN = np.full(101, np.nan)


def track(alt_m: np.ndarray = UNKNOWN, t_s: np.ndarray = UNKNOWN) -> Track:
    return Track(LAT, LON, alt_m, t_s)


def test_lengths_are_those_of_the_ellipsoid() -> None:
    truth = np.cumsum(Geod(ellps="WGS84").inv(LON[:-1], LAT[:-1], LON[1:], LAT[1:])[2])
    assert along_m(LAT, LON)[1:] == pytest.approx(truth, rel=1e-6)


def test_a_steep_road_is_longer_than_its_map() -> None:
    flat = along_m(LAT, LON)
    road = road_of_track(track(0.12 * flat), 15.0, smooth_m=0.0).road
    assert road.distance_m[-1] == pytest.approx(flat[-1] * np.hypot(1.0, 0.12), rel=1e-9)
    assert road.elevation_m[-1] == pytest.approx(0.12 * flat[-1], rel=1e-9)


def test_heights_come_from_the_model() -> None:
    north = np.linspace(43.0, 42.0, 1201)[:, None]
    east = np.linspace(1.0, 2.0, 1201)[None, :]
    plane = TileHeights("a plane", (Tile(42, 1, 1000.0 * (north - 42.0) + 300.0 * (east - 1.0)),))
    found = road_of_track(track(), 15.0, heights=plane, smooth_m=0.0)
    ends = [1000.0 * (lat - 42.0) + 300.0 * (lon - 1.0) for lat, lon in ((LAT[0], LON[0]), (LAT[-1], LON[-1]))]
    assert [found.road.elevation_m[0], found.road.elevation_m[-1]] == pytest.approx(ends, abs=1e-6)
    assert "Heights are those of a plane" in found.notes[0]
    elsewhere = Track(LAT + 5.0, LON, UNKNOWN, UNKNOWN)
    with pytest.raises(PoseError, match=r"its tile would be N47E001\.hgt"):
        road_of_track(elsewhere, 15.0, heights=plane)
    assert tile_name(-0.5, -70.2) == "S01W071.hgt"


def test_heights_come_from_a_table_of_roads() -> None:
    table = RoadElevation(LAT, LON, 500.0 + 0.05 * along_m(LAT, LON), np.zeros(101, dtype=np.int64))
    found = road_of_track(track(), 15.0, heights=RoadHeights("a survey", table), smooth_m=0.0)
    assert found.road.elevation_m[-1] - found.road.elevation_m[0] == pytest.approx(
        0.05 * along_m(LAT, LON)[-1], abs=0.1
    )
    assert "Heights are those of a survey" in found.notes[0]


def test_standing_still_adds_no_road() -> None:
    rng = np.random.default_rng(7)
    jitter = Track(
        np.concatenate((LAT[:50], LAT[49] + rng.normal(0.0, 5e-6, 500), LAT[50:])),
        np.concatenate((LON[:50], LON[49] + rng.normal(0.0, 5e-6, 500), LON[50:])),
        np.full(601, 1.0),
        np.full(601, np.nan),
    )
    found = road_of_track(jitter, 15.0, smooth_m=0.0)
    assert found.length_m == pytest.approx(along_m(LAT, LON)[-1], rel=2e-3)
    assert "of 601 points lie within 3 m" in found.notes[0]


def test_gaps_and_jumps_are_named() -> None:
    kept = np.r_[0:20, 80:101]
    gap = Track(LAT[kept], LON[kept], UNKNOWN[kept], UNKNOWN[kept])
    with pytest.raises(PoseError, match=r"After \(42\.50950°, .* the start, the track has no points for \d{4} m"):
        road_of_track(gap, 15.0, level=True)
    t = np.arange(101.0) * 10.0
    t[60:] -= 9.5
    with pytest.raises(PoseError, match=r"the track jumps by \d+ m in 0 s"):
        road_of_track(track(t_s=t), 15.0, level=True)


def test_a_cycle_is_cut_at_its_stops_and_keeps_to_its_own_limit() -> None:
    t = np.arange(200.0)
    v = np.clip(15.0 * np.sin(np.pi * t / 60.0), 0.0, None)
    roads = roads_of_cycle(t, v)
    assert len(roads) == 2
    first = roads[0]
    driven = v[(t < 60.0) & (v >= 3.0)]
    along = np.concatenate(([0.0], np.cumsum(0.5 * (driven[1:] + driven[:-1]))))
    assert first.length_m == pytest.approx(along[-1])
    held = np.array(first.road.speed_limit_mps)[np.searchsorted(first.road.distance_m, along, side="right") - 1]
    assert (held >= driven - 1e-12).all()
    assert (first.from_speed_mps, first.to_speed_mps) == (driven[0], driven[-1])
    assert first.time_s == driven.size - 1
    with pytest.raises(PoseError, match="never keeps above 11 km/h"):
        roads_of_cycle(t, np.full(200, 1.0))


def test_the_road_of_a_trip_lets_it_be_as_fast_as_it_was_nearby() -> None:
    t = np.arange(0.0, 300.0, 0.5)
    v = 15.0 + 5.0 * np.sin(t / 20.0)
    s = np.concatenate(([0.0], np.cumsum(0.5 * (v[1:] + v[:-1]) * 0.5)))
    states = {"t_s": t, "distance_m": s, "down_m": -0.01 * s, "speed_mps": v}
    found = road_of_states(states)
    held = np.array(found.road.speed_limit_mps)[np.searchsorted(found.road.distance_m, s, side="right") - 1]
    near = [v[np.abs(s - place) <= 300.0].max() for place in s]
    assert (held >= v - 1e-9).all()
    assert np.abs(held[1:-1] - near[1:-1]).max() < 0.6
    assert found.road.elevation_m[-1] == pytest.approx(0.01 * s[-1], abs=0.05)
    assert found.time_s == t[-1]
    part = road_of_states(states, 30.0, from_t_s=100.0, to_t_s=200.0)
    assert part.length_m == pytest.approx(s[400] - s[200])
    assert set(part.road.speed_limit_mps) == {30.0}
    with pytest.raises(PoseError, match="has no down_m"):
        road_of_states({name: states[name] for name in ("t_s", "distance_m", "speed_mps")})
