"""Random cars against collocation and a general solver, where CasADi is there to be asked."""

from __future__ import annotations

import os

import numpy as np
import pytest

from app.science.optimal.accelerate.solve import solve
from app.science.optimal.problem import Accelerate
from app.science.optimal.reading import read_problem
from tests.science.optimal.accelerate.cars import random_problem
from tests.science.optimal.accelerate.nlp_reference import best_of_all

casadi = pytest.importorskip("casadi", reason="CasADi is not installed; pip install casadi to compare")
CARS = int(os.environ.get("NLP_CARS", "4"))


@pytest.mark.parametrize("seed", range(CARS))
def test_energy_gears_and_shift_speeds_agree(seed: int) -> None:
    document, rng = random_problem(seed), np.random.default_rng(1000 + seed)
    problem = read_problem(document)
    assert isinstance(problem, Accelerate)
    if seed % 3:
        document["time_s"] = solve(problem).time_s * float(rng.uniform(0.93, 0.995))
    if seed % 3 == 2:
        document["transmission"]["shift_cost_j"] = float(rng.uniform(500.0, 6000.0))
    problem = read_problem(document)
    assert isinstance(problem, Accelerate)
    ours = solve(problem)
    other = best_of_all(casadi, problem, ours.rising.sequence)
    charge = problem.transmission.shift_cost_j
    taken = [found.fuel_j + charge * (len(gears) - 1) for found, gears in (
        (ours, ours.rising.sequence), (other, other.sequence))]  # fmt: skip
    assert taken[0] <= taken[1] * (1.0 + 1e-6)
    if taken[1] <= taken[0] * (1.0 + 1e-6):  # else the solver stopped at something worse
        assert ours.rising.sequence == other.sequence
        ours_mps = [phase.from_mps for phase in ours.rising.phases[1:]]
        assert ours_mps == pytest.approx(other.switch_speeds_mps, abs=1e-3)
