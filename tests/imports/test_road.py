"""Files as roads: what each form needs, and real ones."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

from app.imports.gpx import read_gpx
from app.imports.hgt import read_hgt
from app.imports.road import RoadWishes, longest, read_roads
from app.science.errors import SignalsError
from app.science.optimal.posing.errors import PoseError

GPX = b"""<?xml version="1.0"?><gpx xmlns="http://www.topografix.com/GPX/1/1" version="1.1"><trk><trkseg>
<trkpt lat="42.5" lon="1.5"><ele>1000</ele><time>2020-01-01T10:00:00Z</time></trkpt>
<trkpt lat="42.501" lon="1.5"><ele>1005</ele><time>2020-01-01T10:00:10+00:00</time></trkpt>
</trkseg></trk></gpx>"""


def test_a_track_is_read_with_heights_and_times() -> None:
    track = read_gpx(GPX)
    assert track.lat_deg.tolist() == [42.5, 42.501]
    assert track.alt_m.tolist() == [1000.0, 1005.0]
    assert np.diff(track.t_s).tolist() == [10.0]
    (road,) = read_roads(GPX, RoadWishes(10.0))
    assert road.length_m == pytest.approx(np.hypot(111.08, 5.0), rel=1e-3)  # a degree at 42.5° is 111.08 km
    with pytest.raises(PoseError, match="A track has no speed limits"):
        read_roads(GPX, RoadWishes())


@pytest.mark.parametrize(
    ("data", "words"),
    [
        (GPX.replace(b'lat="42.501"', b'lat="142.5"'), r"Line 3: latitude 142.5°, longitude 1.5° is no place"),
        (GPX.replace(b"1005", b"high"), r"Line 3: ele 'high' is not a number"),
        (GPX.replace(b"trkpt", b"wpt"), "has no track and no route"),
        (GPX[:-5], "isn't well-formed XML"),
        (b"<!DOCTYPE gpx [<!ENTITY a 'b'>]><gpx/>", "document type"),
        (b"a,b\n1,2\n", "The table is no road: it needs distance_m"),
        (b"distance_m,elevation_m,speed_limit_kmh\n0,1,50\nx,1,50\n", "Row 3: distance_m is no number"),
        (b"distance_m,elevation_m,speed_limit_kmh\n0,1,50\n10,1,\n", "Row 3: speed_limit_kmh is no number"),
    ],
)
def test_what_cannot_be_read_is_named(data: bytes, words: str) -> None:
    with pytest.raises(SignalsError, match=words):
        read_roads(data, RoadWishes())


def test_a_table_of_a_road_is_taken_as_it_is() -> None:
    (found,) = read_roads(b"distance_km;alt_m;speed_limit_kmh\n0;100;36\n0,5;120;72\n1;110;72\n", RoadWishes())
    assert found.road.distance_m == (0.0, 500.0, 1000.0)
    assert found.road.elevation_m == (100.0, 120.0, 110.0)
    assert found.road.speed_limit_mps[:2] == pytest.approx((10.0, 20.0))
    with pytest.raises(PoseError, match="The table has no column speed_limit_mps or"):
        read_roads(b"distance_m,elevation_m\n0,1\n10,1\n", RoadWishes())


def test_tiles_are_known_by_name_and_size() -> None:
    with pytest.raises(SignalsError, match="named by its south-west corner"):
        read_hgt([("tile.hgt", bytes(2 * 1201 * 1201))])
    with pytest.raises(SignalsError, match="has 10 bytes; an elevation tile has 2884802 or 25934402"):
        read_hgt([("N42E001.hgt", bytes(10))])
    data = np.full((1201, 1201), 7, dtype=">i2")
    data[0, 0] = -32768
    heights = read_hgt([("S01W071.hgt", data.tobytes())])
    assert heights.at(np.array([-0.5, 0.5]), np.array([-70.5, -70.5])).tolist() == pytest.approx(
        [7.0, np.nan], nan_ok=True
    )
    assert np.isnan(heights.at(np.array([0.0]), np.array([-71.0]))[0])


def test_a_mountain_road_by_its_own_heights_and_by_radar(shared_data: Callable[[str], Path]) -> None:
    andorra = shared_data("osm-srtm-andorra-monaco")
    track = (andorra / "andorra_for_map_matching.gpx").read_bytes()
    tile = read_hgt([("N42E001.hgt.zip", (andorra / "N42E001.hgt.zip").read_bytes())])
    (own,) = read_roads(track, RoadWishes(50.0 / 3.6))
    (radar,) = read_roads(track, RoadWishes(50.0 / 3.6, heights=tile))
    assert own.length_m == pytest.approx(679.0, abs=3.0)
    assert radar.length_m == pytest.approx(own.length_m, rel=0.01)
    climbs = [road.road.elevation_m[-1] - road.road.elevation_m[0] for road in (own, radar)]
    assert climbs[1] == pytest.approx(climbs[0], abs=10.0)  # posts 90 m apart on a mountain side
    assert np.abs(np.diff(radar.road.elevation_m) / np.diff(radar.road.distance_m)).max() < 0.2


@pytest.mark.parametrize(
    ("name", "parts", "longest_m", "km_in_all"),
    [("udds", 17, 3143.7, 11.99), ("wltc_3b", 8, 8235.7, 23.27), ("us06", 5, 10026.4, 12.89)],
)
def test_real_cycles_fall_into_their_trips_between_stops(
    shared_data: Callable[[str], Path], name: str, parts: int, longest_m: float, km_in_all: float
) -> None:
    roads = read_roads((shared_data("drive-cycles-fastsim") / f"{name}.csv").read_bytes(), RoadWishes())
    assert len(roads) == parts
    assert roads[longest(roads)].length_m == pytest.approx(longest_m, abs=0.1)
    covered = sum(road.length_m for road in roads) / 1000.0
    assert 0.98 * km_in_all < covered < km_in_all  # what is slower than 3 m/s is left out
