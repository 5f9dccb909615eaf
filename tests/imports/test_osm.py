"""OpenStreetMap extracts: a small one made here byte by byte, and Andorra's."""

from __future__ import annotations

import zlib
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

from app.imports.hgt import read_hgt
from app.imports.osm import read_osm
from app.imports.road import RoadWishes, read_roads
from app.science.errors import SignalsError
from app.science.optimal.posing.errors import PoseError
from app.science.optimal.posing.track import Track, road_of_track


def varint(value: int) -> bytes:
    out = b""
    while value > 127:
        out += bytes([value & 127 | 128])
        value >>= 7
    return out + bytes([value])


def field(number: int, value: int | bytes) -> bytes:
    if isinstance(value, int):
        return varint(number << 3) + varint(value)
    return varint(number << 3 | 2) + varint(len(value)) + value


def deltas(values: list[int]) -> bytes:
    steps = np.diff([0, *values])
    return b"".join(varint(int(step) << 1 if step >= 0 else (-int(step) << 1) - 1) for step in steps)


def block(kind: bytes, content: bytes) -> bytes:
    blob = field(2, len(content)) + field(3, zlib.compress(content))
    head = field(1, kind) + field(3, len(blob))
    return len(head).to_bytes(4, "big") + head + blob


def extract(ways: list[tuple[dict[str, str], list[int]]], places: dict[int, tuple[float, float]]) -> bytes:
    """Return a file with nodes at places (degrees) and ways through them."""
    words = sorted({word for tags, _ in ways for pair in tags.items() for word in pair})
    strings = b"".join(field(1, word.encode()) for word in ["", *words])
    lat, lon = ([round(place[k] * 1e7) for place in places.values()] for k in (0, 1))
    dense = field(1, deltas(list(places))) + field(8, deltas(lat)) + field(9, deltas(lon))
    told = b""
    for number, (tags, refs) in enumerate(ways, start=1):
        keys, values = (b"".join(varint(words.index(word) + 1) for word in column) for column in (tags, tags.values()))
        told += field(3, field(1, number) + field(2, keys) + field(3, values) + field(8, deltas(refs)))
    data = field(1, strings) + field(2, field(2, dense)) + field(2, told)
    return block(b"OSMHeader", b"") + block(b"OSMData", data)


PLACES = {7: (42.50, 1.50), 8: (42.51, 1.50), 3: (42.52, 1.51), 900: (42.52, 1.52), 5: (42.525, 1.50)}
WAYS = [
    ({"highway": "primary", "ref": "N 1", "maxspeed": "80"}, [3, 8, 7]),
    ({"highway": "primary", "ref": "N 1", "maxspeed": "30 mph"}, [3, 900]),
    ({"highway": "primary", "ref": "N 1"}, [5, 3]),
    ({"highway": "footway", "ref": "N 1"}, [7, 900]),
]


def test_a_road_is_followed_from_end_to_end() -> None:
    course = read_osm(extract(WAYS, PLACES)).course("N 1")
    there = course if course.lat_deg[0] == pytest.approx(42.5) else course.backwards()
    assert there.lat_deg == pytest.approx([42.50, 42.51, 42.52, 42.525], abs=1e-9)  # the branch to 900 is shorter
    assert there.limit_mps[:2] == pytest.approx(80.0 / 3.6)
    assert np.isnan(there.limit_mps[2])
    again = there.backwards().backwards()
    assert again.limit_mps[:3] == pytest.approx(there.limit_mps[:3], nan_ok=True)


def test_limits_hold_along_a_track_near_the_road() -> None:
    roads = read_osm(extract(WAYS, PLACES))
    lat, lon = np.array([42.501, 42.5095, 42.52, 42.52]), np.array([1.5001, 1.5001, 1.512, 1.519])
    unknown = np.full(4, np.nan)
    found = road_of_track(Track(lat, lon, unknown, unknown), 10.0, roads=roads, level=True)
    limits = np.array(found.road.speed_limit_mps)
    assert limits[0] == pytest.approx(80.0 / 3.6)
    assert limits[-1] == pytest.approx(30.0 * 0.44704)
    assert "The map knows the speed limit on" in found.notes[0]
    with pytest.raises(PoseError, match="no speed limit is known"):
        road_of_track(Track(lat + 1.0, lon, unknown, unknown), None, roads=roads, level=True)


@pytest.mark.parametrize(
    ("data", "words"),
    [
        (extract(WAYS, PLACES)[:-9], "or it is damaged"),
        (len(field(1, b"OSMHeader")).to_bytes(4, "big") + field(1, b"OSMHeader"), "or it is damaged"),
        (extract(WAYS, PLACES).replace(b"OSMData", b"OSMDato"), "holds no road that cars drive on"),
        (b"\x00\x00\x00\x0dOSMHeader, but nothing else", "no OpenStreetMap extract"),
    ],
)
def test_what_is_no_extract_is_said(data: bytes, words: str) -> None:
    with pytest.raises(SignalsError, match=words):
        read_osm(data)


def test_a_road_of_andorra_with_its_limits_and_heights(shared_data: Callable[[str], Path]) -> None:
    andorra = shared_data("osm-srtm-andorra-monaco")
    tile = read_hgt([("N42E001.hgt.zip", (andorra / "N42E001.hgt.zip").read_bytes())])
    wishes = RoadWishes(50.0 / 3.6, heights=tile, way="CG-2")
    (road,) = read_roads((andorra / "andorra.osm.pbf").read_bytes(), wishes)
    assert road.length_m == pytest.approx(17_570.0, abs=5.0)
    assert set(np.round(3.6 * np.array(road.road.speed_limit_mps))) == {30.0, 50.0, 60.0, 70.0, 80.0, 90.0}
    slope = np.diff(road.road.elevation_m) / np.diff(road.road.distance_m)
    assert np.abs(slope).max() < 0.2
    with pytest.raises(PoseError, match="No road is called 'CG-9' in this map; it has CG-2, CG-3, CG-1"):
        read_roads((andorra / "andorra.osm.pbf").read_bytes(), RoadWishes(10.0, way="CG-9"))
