"""Roads from measured points: nothing steeper, no limit stricter, no height further off than is said."""

from __future__ import annotations

import numpy as np
import pytest

from app.science.optimal.posing.cleaning import Cleaning, clean_road
from app.science.optimal.posing.errors import PoseError
from app.science.optimal.posing.profile import smoothed, thinned

S = np.linspace(0.0, 5000.0, 1001)
HILLS = 100.0 + 20.0 * np.sin(2.0 * np.pi * S / 1000.0)
LEVEL = np.zeros(S.shape)
FAST = np.full(S.shape, 25.0)


def test_thinning_keeps_every_height_within_the_tolerance() -> None:
    kept = thinned(S, HILLS, 0.25, np.zeros(S.shape, dtype=bool))
    assert np.abs(np.interp(S, S[kept], HILLS[kept]) - HILLS).max() <= 0.25
    # a chord of length L over a curvature k misses by k L² / 8, and the mean of sqrt(k) here is some 0.68 / sqrt(m)
    assert 60 < kept.size < 140


def test_smoothing_damps_a_wave_as_a_gaussian_does() -> None:
    width = 100.0
    grid, z = smoothed(S, HILLS, width)
    inside = (grid > 500.0) & (grid < 4500.0)
    factor = np.exp(-0.5 * (2.0 * np.pi * width / 1000.0) ** 2)
    wanted = 100.0 + 20.0 * factor * np.sin(2.0 * np.pi * grid / 1000.0)
    assert np.abs(z - wanted)[inside].max() < 0.01


def test_smoothing_keeps_slopes_and_ends() -> None:
    grid, z = smoothed(S, 3.0 + 0.08 * S, 60.0)
    assert z == pytest.approx(3.0 + 0.08 * grid, abs=1e-9)


def test_a_road_has_no_more_points_than_asked_for() -> None:
    rng = np.random.default_rng(1)
    s = np.arange(0.0, 100_000.0, 5.0)
    z = np.cumsum(rng.normal(0.0, 0.3, s.size))
    found = clean_road(s, z, np.full(s.shape, 20.0), Cleaning(most_points=2000))
    road = found.road
    assert len(road.distance_m) <= 2000
    off = np.abs(np.interp(s, road.distance_m, road.elevation_m) - z).max()
    told = next(note for note in found.notes if "points are left" in note)
    tolerance = float(told.split("more than ")[1].split(" m")[0])
    assert 0.5 * tolerance < off <= 1.05 * tolerance


def test_limits_hold_where_they_held() -> None:
    limit = np.where((S >= 1000.0) & (S < 1500.0), 50.0 / 3.6, 80.0 / 3.6)
    road = clean_road(S, LEVEL, limit).road
    assert road.distance_m == (0.0, 1000.0, 1500.0, 5000.0)
    assert road.speed_limit_mps[:3] == pytest.approx([80.0 / 3.6, 50.0 / 3.6, 80.0 / 3.6])


def test_wavering_limits_are_joined_and_none_gets_stricter() -> None:
    limit = 20.0 + 5.0 * np.sin(S / 200.0)
    road = clean_road(S, LEVEL, limit).road
    held = np.array(road.speed_limit_mps)[np.searchsorted(road.distance_m, S[:-1], side="right") - 1]
    assert (held >= limit[:-1] - 1e-12).all()
    assert (held - limit[:-1]).max() <= 0.3
    assert len(road.distance_m) < S.size / 3


def test_missing_heights_are_filled_in_and_told() -> None:
    holes = np.where((S > 2000.0) & (S < 2300.0), np.nan, 0.02 * S)
    found = clean_road(S, holes, FAST)
    assert found.road.elevation_m[-1] == pytest.approx(100.0)
    assert "the longest such stretch, 300 m, begins at 2000 m" in found.notes[0]


@pytest.mark.parametrize(
    ("s", "z", "limit", "words"),
    [
        (np.delete(S, slice(300, 800)), None, 25.0, "From 1495 m to 4000 m the road has no points for 2505 m"),
        (S, np.where(S > 3000.0, 9.0, 0.0), 25.0, "From 3000 m to 3005 m the road rises by 180 m per 100 m"),
        (S, np.full(S.shape, np.nan), 25.0, "No height is known anywhere"),
        (S, None, 0.0, "The speed limit at 0 m is 0 m/s; it must be above 0"),
        (S[::-1], None, 25.0, "Point 2 lies at 4995.0 m, before the 5000.0 m of the point before it"),
        (np.zeros(5), None, 25.0, "The road is 0 m long"),
    ],
)  # fmt: skip
def test_what_is_no_road_is_refused_with_its_place(
    s: np.ndarray, z: np.ndarray | None, limit: float, words: str
) -> None:
    with pytest.raises(PoseError, match=words):
        clean_road(s, np.zeros(s.shape) if z is None else z, np.full(s.shape, limit))


def test_a_very_steep_road_is_doubted() -> None:
    found = clean_road(np.array([0.0, 100.0, 200.0]), np.array([0.0, 0.0, 30.0]), np.full(3, 10.0))
    assert "From 100 m to 200 m the road rises by 30 m per 100 m; roads seldom do" in found.notes[-1]
