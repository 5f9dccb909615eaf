"""A car's file and its map as a problem: the numbers of the file arrive, and the problem can be read and solved."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from app.science.optimal.posing.car import Wishes, problem_of_car
from app.science.optimal.posing.errors import PoseError
from app.science.optimal.problem import Distance, Route
from app.science.optimal.reading import read_problem
from app.science.optimal.solve import solve
from app.science.vehicle.model import Vehicle
from tests.science.optimal.documents import TABLE_4_1

ROADSTER = Vehicle(gear_ratios=(13.25, 9.604, 7.37, 5.796, 4.208, 3.23))
ROAD = {"distance_m": [0.0, 800.0, 2000.0], "elevation_m": [100.0, 120.0, 90.0], "speed_limit_mps": [13.9, 25.0, 25.0]}


def map_of_table_4_1() -> dict[str, Any]:
    """Return the map.json of the thesis' engine between 1500 and 5000 rpm, without noise."""
    cells = []
    for rpm in np.arange(1525.0, 5000.0, 50.0):
        for nm in np.arange(21.0, 101.0, 2.0):
            w = rpm * np.pi / 30.0
            phi = float(np.dot(TABLE_4_1["phi"], [1.0, w, nm, w * nm, w * w, nm * nm]))
            cells.append({"rpm": rpm, "nm": nm, "n": 400, "efficiency": 1.0 / phi, "sd": 0.01, "bsfc_gpkwh": None})
    return {"cell": {"rpm": 50, "nm": 2}, "cells": cells, "full_load": []}


def test_the_numbers_of_the_file_arrive() -> None:
    posed = problem_of_car(ROADSTER, map_of_table_4_1(), fit="phi")
    problem = posed.problem
    assert problem["vehicle"]["mass_kg"] == 844.0 + 75.0
    turning = 4.0 * 0.62 / 0.2954**2 + 0.061 * (5.796 / 0.2954) ** 2  # wheels, and the engine in fourth gear
    assert problem["vehicle"]["accelerated_mass_kg"] == pytest.approx(919.0 + turning, rel=1e-12)
    assert problem["transmission"]["ratios"] == list(ROADSTER.gear_ratios)
    assert problem["engine"]["phi"] == pytest.approx(TABLE_4_1["phi"], rel=1e-6)
    assert "2800 cells of the map by 0.0 % rms of the time" in posed.notes[0]
    assert "gear 4" in posed.notes[1]


def test_an_acceleration_is_solved_as_it_is_posed() -> None:
    posed = problem_of_car(ROADSTER, map_of_table_4_1(), wishes=Wishes(from_speed_mps=12.0, to_speed_mps=25.0))
    answer = solve(read_problem(posed.problem)).document()
    assert answer["trajectory"]["speed_mps"][-1] == 25.0
    assert answer["certificate"]["verdict"] == "optimal"


def test_a_route_is_complete_and_may_roll_and_brake() -> None:
    posed = problem_of_car(ROADSTER, map_of_table_4_1(), ROAD, wishes=Wishes(max_time_s=130.0))
    route = read_problem(posed.problem)
    assert isinstance(route, Route)
    assert route.transmission.neutral
    assert route.brake_max_n == 6.0 * 919.0
    assert route.transmission.shift_cost_j == 2000.0
    assert any("charged 2 kJ" in note for note in posed.notes)
    assert (route.from_speed_mps, route.to_speed_mps, route.max_time_s) == (13.9, 25.0, 130.0)
    assert route.min_speed_mps == pytest.approx(1.001 * 1525.0 * np.pi / 30.0 * 0.2954 / 13.25)


def test_what_is_missing_is_said() -> None:
    with pytest.raises(PoseError, match="no gear ratios; fill in its transmission"):
        problem_of_car(Vehicle(), map_of_table_4_1())
    with pytest.raises(PoseError, match="needs a road"):
        problem_of_car(ROADSTER, map_of_table_4_1(), kind="route")


def test_a_distance_is_driven_with_a_free_ratio() -> None:
    posed = problem_of_car(ROADSTER, map_of_table_4_1(), kind="distance", wishes=Wishes(distance_m=500.0))
    assert posed.problem["transmission"]["type"] == "cvt"
    assert "gears are left out" in posed.notes[-1]
    posed_again = read_problem(posed.problem)
    assert isinstance(posed_again, Distance)
    assert posed_again.distance_m == 500.0
