"""Elevation tables as files."""

from __future__ import annotations

import gzip

import numpy as np
import pytest

from app.imports.elevation import read_elevation
from app.science.errors import SignalsError

TABLE = b"lat_deg,lon_deg,alt_m,way\n49.6,6.1,300,7\n49.601,6.1,301.5,7\n49.61,6.2,310,A1\n49.611,6.2,311,A1\n"


def test_nodes_and_ways_are_read() -> None:
    road = read_elevation(TABLE)
    assert road.node_count == 4
    np.testing.assert_array_equal(road.alt_m, [300.0, 301.5, 310.0, 311.0])
    np.testing.assert_array_equal(road.way, [0, 0, 1, 1])
    match = road.lookup(np.array([49.6005, 49.605]), np.array([6.1, 6.15]))
    assert match.alt_m[0] == pytest.approx(300.75)
    assert np.isnan(match.alt_m[1])


def test_other_forms_of_the_table_mean_the_same() -> None:
    for data in (gzip.compress(TABLE), TABLE.replace(b",", b";").replace(b".", b","), TABLE + b"\n\n"):
        np.testing.assert_array_equal(read_elevation(data).lat_deg, read_elevation(TABLE).lat_deg)
    without_ways = b"\n".join(line.rpartition(b",")[0] for line in TABLE.splitlines())
    np.testing.assert_array_equal(read_elevation(without_ways).way, np.zeros(4))


def test_a_written_table_reads_back() -> None:
    road = read_elevation(TABLE)
    again = read_elevation(road.to_csv())
    for name in ("lat_deg", "lon_deg", "alt_m", "way"):
        np.testing.assert_array_equal(getattr(again, name), getattr(road, name))


@pytest.mark.parametrize(
    ("data", "row", "field", "words"),
    [
        (TABLE.replace(b"alt_m", b"height"), 1, "alt_m", "is missing"),
        (TABLE.replace(b"301.5", b"high"), 3, "alt_m", "isn't a number"),
        (TABLE.replace(b"49.61,", b","), 4, "lat_deg", "is empty"),
        (TABLE.replace(b"49.6,", b"149.6,"), 2, "lat_deg", "between"),
        (b"lat_deg,lon_deg,alt_m\n\n49,6,1\n\n49.1,6,99999\n", 5, "alt_m", "Row 5"),
        (TABLE.replace(b"300,7", b"300,7,8"), 0, "", "must be whole"),
        (b"lat_deg,lon_deg,alt_m\n49,6,300\n", 0, "", "at least two nodes"),
        (b"", 0, "", "empty"),
    ],
)
def test_a_table_that_is_not_whole_is_refused(data: bytes, row: int, field: str, words: str) -> None:
    with pytest.raises(SignalsError, match=words) as caught:
        read_elevation(data)
    assert (caught.value.row, caught.value.field) == (row, field)
