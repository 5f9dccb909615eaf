"""What grids and regulators give: real drives, above the least by what the grid, or not asking for fuel, costs."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from app.science.optimal.accelerate.numbers import drive_numbers
from app.science.optimal.answer import Answer
from app.science.optimal.methods.held_kernels import nearest_force, pushed
from app.science.optimal.methods.model import wheels
from app.science.optimal.methods.registry import solve_by
from app.science.optimal.problem import Accelerate
from app.science.optimal.reading import read_problem
from tests.science.optimal.documents import SIX_GEARS, TABLE_4_1, thesis

FULL_LOAD = {**TABLE_4_1, "full_load": [[1000, 60], [3000, 95], [4500, 90], [6000, 75]]}


@pytest.mark.parametrize(
    ("name", "changes", "most"),
    [
        ("dp_speed", {"transmission": {**SIX_GEARS, "shift_cost_j": 3000.0}, "time_s": 8.3}, 2e-5),
        ("dp_speed_time", {"time_s": 8.3}, 3e-3),
        ("hjb_upwind", {}, 2e-5),
        ("hjb_upwind", {"time_s": 8.3}, 5e-3),
        ("lqr", {"time_s": 8.3}, 0.15),
        ("dlqr", {"time_s": 8.3}, 0.15),
    ],
)
def test_above_the_least_by_no_more_than_the_grid_leaves(name: str, changes: dict[str, Any], most: float) -> None:
    found = solve_by(read_problem(thesis(**changes)), name)
    assert isinstance(found, Answer)
    other = found.certificate.independent
    assert other is not None
    assert 0.0 < other.relative_gap < most
    assert found.certificate.verdict == ("rejected" if "lqr" in name else "best found")
    way = found.trajectory
    assert way.speed_mps[[0, -1]] == pytest.approx([10.0, 100.0 / 3.6], rel=1e-8)
    assert way.torque_nm.max() <= 100.0 + 1e-6
    if "time_s" in changes:
        assert found.time_s == pytest.approx(8.3, rel=1e-8)
    # the drive that is told obeys the car's equation of motion
    assert np.trapezoid(way.speed_mps, way.t_s) == pytest.approx(found.distance_m, rel=1e-4)
    assert np.trapezoid(way.fuel_power_w, way.t_s) == pytest.approx(found.fuel_energy_j, rel=1e-3)


def test_the_compiled_step_is_the_plain_model() -> None:
    for document in (
        thesis(engine=FULL_LOAD),
        thesis(engine=FULL_LOAD, transmission={"type": "cvt"}),
        thesis(engine={"willans": [8e3, 2.6, 2e-5], "power_w": [0.0, 6e4], "force_n": [0.0, 4e3]}),
    ):
        problem = read_problem(
            {k: v for k, v in document.items() if k != "transmission" or "phi" in document["engine"]}
        )
        assert isinstance(problem, Accelerate)
        drive = drive_numbers(problem)
        for v, share, turn in ((11.0, 0.0, 0.1), (17.0, 0.6, 0.5), (23.0, 1.0, 0.9)):
            plain = wheels(drive, len(drive.spd_1pm) // 2, np.array(v), np.array(share), np.array(turn))
            fast = pushed(len(drive.spd_1pm) // 2, v, share, turn, drive)
            assert fast == pytest.approx((float(plain.force_n), float(plain.fuel_w)), rel=1e-12)
            gear, *again = nearest_force(v, fast[0], drive)  # what gives this force takes no more than what gave it
            force, fuel = pushed(gear, v, *again, drive)
            assert force == pytest.approx(fast[0], rel=1e-9)
            assert fuel <= fast[1] * (1.0 + 1e-9) or document["transmission"]["type"] == "cvt"
