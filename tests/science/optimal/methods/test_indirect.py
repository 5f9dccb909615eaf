"""Methods that follow the costate agree with the integrals over speed, which know nothing of time or of shooting."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from app.science.optimal.answer import Answer
from app.science.optimal.methods.found import MethodFailed
from app.science.optimal.methods.registry import solve_by
from app.science.optimal.reading import read_problem
from tests.science.optimal.documents import SIX_GEARS, TABLE_4_1, thesis

NINETY_FOUR = {**TABLE_4_1, "torque_nm": [10, 94]}
WILLANS = {"willans": [8000.0, 2.6, 2e-5], "power_w": [0.0, 60_000.0], "force_n": [0.0, 4000.0]}
HURRIED = {"time_s": 8.0136}
"""Nine tenths of the free time."""


def answered(name: str, **changes: Any) -> Answer:
    found = solve_by(read_problem(thesis(**changes)), name)
    assert isinstance(found, Answer)
    return found


@pytest.mark.parametrize(
    "changes",
    [
        {},
        HURRIED,
        {"engine": NINETY_FOUR},
        {"transmission": {"type": "cvt"}},
        {"to_speed_mps": 140.0 / 3.6, "time_s": 30.0},  # 4.4.2.2: first down in sixth gear, then up
        {"transmission": {**SIX_GEARS, "neutral": True}, "from_speed_mps": 20.0, "time_s": 30.0},
        {"engine": {**TABLE_4_1, "full_load": [[1000, 60], [3000, 95], [4500, 90], [6000, 75]]}},
    ],
    ids=["free", "hurried", "94 Nm", "cvt", "140 km/h in 30 s", "neutral", "full load"],
)
def test_single_shooting(changes: dict[str, Any]) -> None:
    found = answered("single_shooting", **changes)
    other = found.certificate.independent
    assert other is not None
    assert abs(other.relative_gap) < 1e-9
    assert found.certificate.verdict == "extremal"
    assert found.certificate.more["controllable"]
    if "time_s" in changes:
        assert found.time_s == pytest.approx(changes["time_s"], rel=1e-9)


@pytest.mark.parametrize("name", ["multiple_shooting", "boundary_value"])
@pytest.mark.parametrize(
    "changes", [{"engine": NINETY_FOUR, "time_s": 8.4}, {"engine": WILLANS, "transmission": {"type": "cvt"}}]
)
def test_methods_with_nodes(name: str, changes: dict[str, Any]) -> None:
    found = answered(name, **changes)
    other = found.certificate.independent
    assert other is not None
    assert abs(other.relative_gap) < 1e-8
    assert found.certificate.verdict == "extremal"


def test_a_drive_that_slows_down_first_is_no_function_of_speed() -> None:
    with pytest.raises(MethodFailed, match="slows down first"):
        answered("boundary_value", time_s=15.0)


def test_the_drive_that_is_told_burns_what_is_said() -> None:
    found = answered("single_shooting", **HURRIED)
    way = found.trajectory
    assert np.trapezoid(way.fuel_power_w, way.t_s) == pytest.approx(found.fuel_energy_j, rel=1e-4)
    assert way.speed_mps[[0, -1]] == pytest.approx([10.0, 100.0 / 3.6], rel=1e-9)
    assert np.trapezoid(way.speed_mps, way.t_s) == pytest.approx(found.distance_m, rel=1e-4)


def test_shooting_does_not_count_charges_and_says_so() -> None:
    with pytest.raises(MethodFailed, match="charges for shifts"):
        answered("single_shooting", transmission={**SIX_GEARS, "shift_cost_j": 3000.0})
