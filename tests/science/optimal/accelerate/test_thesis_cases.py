"""The thesis' accelerations, and what must hold for every solution, on its car."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from app.science.optimal.accelerate.answering import answer
from app.science.optimal.accelerate.solve import Solution, solve
from app.science.optimal.answer import Answer
from app.science.optimal.problem import RADPS_PER_RPM, Accelerate, Infeasible
from app.science.optimal.reading import read_problem
from tests.science.optimal.documents import SIX_GEARS, TABLE_4_1, thesis

WILLANS = {"willans": [8000.0, 2.6, 1e-6], "power_w": [0.0, 60_000.0], "force_n": [0.0, 4000.0]}

CONVEX = {
    "p_in": [900.0, 20.0, 2.5, 0.004],
    "terms": ["1", "w", "wT", "wT2"],
    "speed_rpm": [900, 6000],
    "torque_nm": [0, 120],
}


def posed(**changes: Any) -> Accelerate:
    problem = read_problem(thesis(**changes))
    assert isinstance(problem, Accelerate)
    return problem


def solved(**changes: Any) -> Solution:
    return solve(posed(**changes))


def test_the_free_time_case_takes_9_3_s_with_shifts_near_4500_rpm() -> None:
    # Sebesta 2010, 4.4.2.1: 36 to 100 km/h in 9.3 s, shifts around 4500 rpm; a torque limit near 94 Nm reproduces it
    found = answer(posed(engine={**TABLE_4_1, "torque_nm": [10, 94]}))
    assert found.time_s == pytest.approx(9.3, abs=0.05)
    assert found.gears == (1, 2, 3, 4, 5)
    ratios = np.array(SIX_GEARS["ratios"][:4])
    rpm = np.array(found.switch_speeds_mps) * ratios / 0.2954 / RADPS_PER_RPM
    assert int((np.abs(rpm - 4500.0) < 100.0).sum()) == 3
    assert found.certificate.verdict == "optimal"
    assert "shift up at" in found.advice[-1]


def test_140_km_per_h_in_30_s_slows_down_in_sixth_gear_first() -> None:
    # Sebesta 2010, 4.4.2.2: the lowest N_spd (PAPERS mends "max") and the lowest torque first, then the free profile
    found = answer(posed(to_speed_mps=140.0 / 3.6, time_s=30.0))
    assert found.time_s == pytest.approx(30.0, rel=1e-9)
    assert found.gears[0] == 6
    assert found.trajectory.torque_nm[0] == pytest.approx(10.0)
    assert found.multiplier_w < 0.0
    assert found.certificate.verdict in ("optimal", "extremal")


def test_a_driver_who_pulses_is_told_the_shifts_of_the_rise_only() -> None:
    found = answer(posed(**CASES["pulse and glide"]))
    assert len(found.gears) > 20
    assert any("pull, roll, pull" in words for words in found.advice)
    shifts = found.advice[-1].removeprefix("shift up at ").removesuffix(" rpm").split(", ")
    assert 1 <= len(shifts) <= len(SIX_GEARS["ratios"]) - 1


CASES: dict[str, dict[str, Any]] = {
    "free": {},
    "hurried": {"time_s": 7.8},
    "unhurried": {"time_s": 15.0},
    "cvt": {"transmission": {"type": "cvt"}},
    "cvt hurried": {"transmission": {"type": "cvt"}, "time_s": 8.0},
    "neutral": {"transmission": {**SIX_GEARS, "neutral": True}, "from_speed_mps": 20.0, "time_s": 30.0},
    "charged": {"transmission": {**SIX_GEARS, "shift_cost_j": 3000.0}, "time_s": 8.3},
    "full load": {"engine": {**TABLE_4_1, "full_load": [[1000, 60], [3000, 95], [4500, 90], [6000, 75]]}},
    "willans": {"engine": WILLANS, "transmission": {"type": "cvt"}},
    "from standstill": {"transmission": {"type": "cvt"}, "from_speed_mps": 0.0},
    "nearly flat out": {"time_s": 6.6695},
    "pulse and glide": {"time_s": 60.0, "to_speed_mps": 20.0},
    "gear limit in the way": {"engine": CONVEX, "time_s": 25.0},
    "willans unhurried": {"engine": WILLANS, "transmission": {"type": "cvt"}, "time_s": 30.0},
    "willans with brakes": {"engine": WILLANS, "transmission": {"type": "cvt"}, "time_s": 20.0, "brake_max_n": 3000.0},
}


@pytest.fixture(scope="module", params=CASES)
def case(request: pytest.FixtureRequest) -> tuple[Accelerate, Answer]:
    problem = posed(**CASES[request.param])
    return problem, answer(problem)


def test_the_trajectory_obeys_the_cars_equation(case: tuple[Accelerate, Answer]) -> None:
    problem, found = case
    t, load = found.trajectory, problem.load
    assert t.speed_mps[0] == pytest.approx(problem.from_speed_mps)
    assert t.speed_mps[-1] == pytest.approx(problem.to_speed_mps)
    assert t.t_s[-1] == pytest.approx(found.time_s, rel=1e-8)
    assert float(np.trapezoid(t.speed_mps, t.t_s)) == pytest.approx(found.distance_m, rel=1e-3)
    assert float(np.trapezoid(t.fuel_power_w, t.t_s)) == pytest.approx(found.fuel_energy_j, rel=1e-3)
    moving = t.speed_mps > 1.0  # below, a CVT's force has no bound
    force = t.torque_nm * t.engine_speed_radps / np.where(moving, t.speed_mps, np.nan)
    accel = (force - t.brake_n - load.drag_kgpm * t.speed_mps**2 - load.rolling_n) / load.accelerated_mass_kg
    step = np.diff(t.t_s)
    known = np.isfinite(accel[1:] + accel[:-1]) & (step > 0.0)
    gained = 0.5 * (accel[1:] + accel[:-1]) * step
    assert np.diff(t.speed_mps)[known] == pytest.approx(gained[known], rel=0.05, abs=2e-4)


def test_the_maximum_principle_holds_along_it(case: tuple[Accelerate, Answer]) -> None:
    problem, found = case
    power = float(np.abs(found.trajectory.fuel_power_w).max())
    assert found.certificate.hamiltonian_drift_w <= 1e-6 * power
    assert found.certificate.max_h_minus_mu_w <= 1e-6 * power
    assert found.certificate.transversality <= 1e-6 * power
    assert found.certificate.independent is not None
    if problem.time_s is None or found.multiplier_w >= 0.0:
        assert abs(found.certificate.independent.relative_gap) <= 1e-5
        assert found.certificate.verdict == "optimal"
    else:
        assert found.certificate.verdict in ("extremal", "best found")
        assert found.certificate.independent.relative_gap >= -1e-5  # nothing beats the bound
    if problem.time_s is not None:
        assert found.time_s == pytest.approx(problem.time_s, rel=1e-8)


def test_time_has_the_price_that_it_costs() -> None:
    # μ is what another second is worth: dE/dT = −μ, by central differences
    for seconds in (8.0, 8.5, 9.5):
        step = 1e-3
        less, here, more = (solved(time_s=seconds + k * step) for k in (-1, 0, 1))
        assert (more.fuel_j - less.fuel_j) / (2.0 * step) == pytest.approx(-here.mu_w, rel=1e-4, abs=0.5)


def test_a_charge_for_shifts_leaves_gears_out_and_stays_out_of_the_fuel() -> None:
    free, dear = solved(), solved(transmission={**SIX_GEARS, "shift_cost_j": 3000.0})
    assert len(dear.rising.phases) < len(free.rising.phases)
    assert dear.fuel_j > free.fuel_j
    one = solved(transmission={**SIX_GEARS, "shift_cost_j": 1e6})
    assert len(one.rising.phases) == 1


@pytest.mark.parametrize(
    ("changes", "words"),
    [
        ({"time_s": 5.0}, "too short by 1.669"),
        ({"from_speed_mps": 1.0}, "below the lowest speed of first gear, 2.335 m/s"),
        ({"to_speed_mps": 70.0}, "the ratios never reach 70 m/s: the last gear ends at 57.4"),
        ({"to_speed_mps": 57.0}, "57 m/s can't be reached: from 10 m/s the car gets to"),
        ({"engine": {**TABLE_4_1, "torque_nm": [60, 100]}, "time_s": 60.0}, "too long by"),
        ({"transmission": {**SIX_GEARS, "ratios": [13.25, 2.0]}, "to_speed_mps": 20.0}, "20 m/s can't be reached"),
    ],
)
def test_what_is_impossible_is_said_with_its_size(changes: dict[str, Any], words: str) -> None:
    with pytest.raises(Infeasible) as refused:
        solved(**changes)
    assert words in str(refused.value)
