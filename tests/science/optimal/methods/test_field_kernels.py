"""The compiled control with the greatest H against a dense grid of controls, and its costate against −∂H/∂v."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from app.science.optimal.accelerate.numbers import drive_numbers
from app.science.optimal.methods.field_kernels import rates_in
from app.science.optimal.methods.model import resistance_n, wheels
from app.science.optimal.problem import Accelerate
from app.science.optimal.reading import read_problem
from tests.science.optimal.documents import TABLE_4_1, thesis

CASES: dict[str, dict[str, Any]] = {
    "gears": {"engine": {**TABLE_4_1, "full_load": [[1000, 60], [3000, 95], [4500, 90], [6000, 75]]}},
    "cvt": {"transmission": {"type": "cvt"}},
    "willans": {
        "engine": {"willans": [8000.0, 2.6, 2e-5], "power_w": [0.0, 60_000.0], "force_n": [0.0, 4000.0]},
        "transmission": {"type": "cvt"},
    },
}
STEP_MPS = 1e-5


@pytest.mark.parametrize("changes", CASES.values(), ids=CASES)
@pytest.mark.parametrize(("v", "costate"), [(13.0, 2.0e4), (13.0, 4.5e4), (22.0, 9.0e4)])
def test_no_control_of_a_grid_is_better_and_the_costate_obeys_its_equation(
    changes: dict[str, Any], v: float, costate: float
) -> None:
    problem = read_problem(thesis(**changes))
    assert isinstance(problem, Accelerate)
    drive = drive_numbers(problem)
    gear = 2 if len(drive.spd_1pm) > 1 else 0
    best = rates_in(gear, v, costate, drive)
    share, turn = np.meshgrid(np.linspace(0.0, 1.0, 801), np.linspace(0.0, 1.0, 801 if "cvt" in str(changes) else 1))
    at = wheels(drive, gear, np.array(v), share, turn)
    h = costate * (at.force_n - resistance_n(drive, np.array(v))) / drive.accelerated_kg - at.fuel_w
    assert best.h_w >= h.max() - 1e-9 * abs(best.h_w)
    assert best.h_w == pytest.approx(float(h.max()), rel=1e-4)
    # along the best control ∂H/∂u vanishes or follows a limit, so −dH/dv at steady λ is the costate's rate
    beside = [rates_in(gear, v + sign * STEP_MPS, costate, drive).h_w for sign in (1.0, -1.0)]
    assert best.costate_rate == pytest.approx(-(beside[0] - beside[1]) / (2.0 * STEP_MPS), rel=1e-5)
