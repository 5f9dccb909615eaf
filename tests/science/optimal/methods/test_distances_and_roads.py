"""The thesis' corner and its shooting over a distance, and what the grid of a road gives beside the polish."""

from __future__ import annotations

from typing import Any

import pytest

from app.science.optimal.answer import Answer
from app.science.optimal.methods.comparing import compare
from app.science.optimal.methods.found import MethodFailed
from app.science.optimal.methods.registry import METHODS, solve_by
from app.science.optimal.reading import read_problem
from tests.science.optimal.documents import SIX_GEARS, SMART, TABLE_4_1

WILLANS = {"willans": [2000.0, 2.6, 2e-5], "power_w": [0.0, 40_000.0], "force_n": [-3000.0, 3000.0]}


def over(**changes: Any) -> dict[str, Any]:
    return {
        "kind": "distance",
        "vehicle": dict(SMART),
        "engine": dict(TABLE_4_1),
        "transmission": {"type": "cvt"},
        "from_speed_mps": 8.5,
        "distance_m": 700.0,
    } | changes


def test_the_least_fuel_power_all_the_way_is_rejected_with_the_better_competitor_named() -> None:
    # the thesis' own corner (4.5), at 1000 rpm and 10 Nm, is checked beside the usual answer in test_distance.py
    found = solve_by(read_problem(over(engine=WILLANS, distance_m=300.0)), "corner")
    assert isinstance(found, Answer)
    certificate = found.certificate
    assert certificate.verdict == "rejected"
    assert certificate.max_h_minus_mu_w > 1e4
    assert "pontryagin's drive" in certificate.notes[0]
    assert certificate.more["controllable"]
    assert found.costates["speed"][-1] == 0.0


def test_shooting_reaches_the_end_of_a_short_road_and_says_that_it_is_hopeless_on_a_long_one() -> None:
    short = solve_by(read_problem(over(engine=WILLANS, distance_m=200.0)), "single_shooting")
    assert isinstance(short, Answer)
    assert short.certificate.verdict == "extremal"
    other = short.certificate.independent
    assert other is not None
    assert abs(other.relative_gap) < 1e-7
    with pytest.raises(MethodFailed, match="hopelessly sensitive"):
        solve_by(read_problem(over(engine=WILLANS, distance_m=3000.0)), "single_shooting")


def test_the_grid_of_a_road_is_a_little_above_the_polish() -> None:
    road = {"distance_m": [0, 300, 600, 900], "elevation_m": [0, 6, 3, 3], "speed_limit_mps": [25, 25, 25, 25]}
    posed = over(kind="route", road=road, to_speed_mps=8.5, min_speed_mps=3.0, max_time_s=75.0, brake_max_n=4e3) | {
        "engine": {**TABLE_4_1, "idle_fuel_power_w": 4000.0},
        "transmission": {**SIX_GEARS, "neutral": True, "shift_cost_j": 2000.0},
    }
    del posed["distance_m"]
    told = compare(read_problem(posed), ["dp_distance_energy_gear", "polish", "pontryagin", "corner"])
    grid, best, no, neither = told.rows
    assert best.verdict in ("optimal", "extremal", "best found")
    above = (grid.cost_j + grid.shift_charges_j) / (best.cost_j + best.shift_charges_j) - 1.0
    assert -1e-6 < above < 0.03
    assert grid.time_s <= 75.0 * (1.0 + 1e-9)
    assert "costate jumps" in no.reason
    assert "distances" in neither.reason


def test_every_method_has_a_title_and_a_source() -> None:
    for one in METHODS.values():
        assert one.title
        assert one.source.startswith("Sebesta 2010")
