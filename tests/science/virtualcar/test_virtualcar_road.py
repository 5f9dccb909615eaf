"""The virtual road is smooth, hilly, curving and of one piece."""

from __future__ import annotations

from typing import get_args

import numpy as np
import pytest
from scipy.spatial import cKDTree

from app.science.virtualcar.road import ROAD_STEP_M, Road, build_road
from app.science.virtualcar.specification import RouteName

ROUTES = get_args(RouteName)


@pytest.fixture(scope="module", params=ROUTES)
def road(request: pytest.FixtureRequest) -> Road:
    return build_road(request.param, 3600.0, np.random.default_rng(11))


def test_curvatures_are_the_derivatives_of_the_angles(road: Road) -> None:
    middle = 0.5 * (road.curvature_h_radpm[1:] + road.curvature_h_radpm[:-1])
    assert np.abs(np.diff(road.heading_rad) / ROAD_STEP_M - middle).max() < 2e-3
    turned = np.concatenate([[0.0], np.cumsum(middle) * ROAD_STEP_M])
    assert np.abs(road.heading_rad - road.heading_rad[0] - turned).max() < 0.01
    climbed = np.cumsum(road.curvature_v_radpm) * ROAD_STEP_M
    assert np.abs(np.diff(road.pitch_rad) - np.diff(climbed)).max() < 2e-4


def test_positions_follow_the_angles(road: Road) -> None:
    """Sebesta 2010, (1.7); in the tightest bends a chord of half a metre is 0.2 mm shorter than its arc."""
    length = np.diff(np.column_stack([road.north_m, road.east_m, road.alt_m]), axis=0)
    assert np.abs(np.linalg.norm(length, axis=1) / ROAD_STEP_M - 1.0).max() < 4e-4
    middle = 0.5 * (road.pitch_rad[1:] + road.pitch_rad[:-1])
    assert np.abs(np.arcsin(length[:, 2] / ROAD_STEP_M) - middle).max() < 1e-4


def test_grades_are_those_of_hills(road: Road) -> None:
    grade = np.tan(road.pitch_rad)
    assert 0.015 < grade.std() < 0.03
    assert 0.05 < np.abs(grade).max() < 0.11
    assert np.abs(road.curvature_v_radpm).max() < 0.006


def test_it_stays_around_home(road: Road) -> None:
    assert np.hypot(road.north_m, road.east_m).max() < 30_000.0


def test_limits_can_be_kept_with_gentle_brakes_and_tyres(road: Road) -> None:
    squared = road.limit_mps**2
    assert np.all(np.diff(squared) > -2 * 1.2 * ROAD_STEP_M - 1e-6)
    assert np.all(squared * np.abs(road.curvature_h_radpm) < 2.6 + 1e-6)
    assert 25 / 3.6 < np.median(road.limit_mps) <= 130 / 3.6
    assert np.sum(ROAD_STEP_M / road.limit_mps) > 3600.0


def test_crossings_are_level() -> None:
    road = build_road("town", 3600.0, np.random.default_rng(4))
    place = np.column_stack([road.north_m, road.east_m])[::2]
    pairs = cKDTree(place).query_pairs(1.0, output_type="ndarray") * 2
    crossing = pairs[np.abs(pairs[:, 0] - pairs[:, 1]) * ROAD_STEP_M > 100.0]
    assert len(crossing) > 10
    assert np.abs(road.alt_m[crossing[:, 0]] - road.alt_m[crossing[:, 1]]).max() < 0.15
