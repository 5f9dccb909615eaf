"""The Hamiltonian of a drive and of its alternatives, against the formula worked out by hand."""

from __future__ import annotations

import numpy as np
import pytest

from app.science.optimal.alternatives import Moments, best_of_gears_w, hamiltonian_w
from app.science.optimal.problem import Accelerate, Distance, Route
from app.science.optimal.reading import read_problem
from tests.science.optimal.documents import SIX_GEARS, SMART, TABLE_4_1, thesis

ROAD = {"distance_m": [0, 1000], "elevation_m": [0, 60], "speed_limit_mps": [30, 30]}
UPHILL = {"kind": "route", "road": ROAD, "from_speed_mps": 20.0, "to_speed_mps": 20.0, "min_speed_mps": 5.0}
SPEED, LAMBDA_V, LAMBDA_X, SINE = 20.0, 30_000.0, 500.0, 0.06


def moment(**changed: float) -> Moments:
    """One point of a drive, in neutral unless changed."""
    numbers = {
        "speed_mps": SPEED, "slope": SINE, "gear": 0, "engine_speed_radps": np.nan, "torque_nm": np.nan,
        "fuel_power_w": 6000.0, "brake_n": 0.0, "lambda_v": LAMBDA_V, "lambda_x": LAMBDA_X,
    }  # fmt: skip
    return Moments(**{name: np.array([value]) for name, value in (numbers | changed).items()})


def by_hand(pull_n: float, fuel_w: float) -> float:
    """H = λ_x v + λ_v v' − P with the car of the thesis up a slope of 6 %."""
    drag = 0.5 * 1.2 * 0.39 * 1.93 * SPEED**2
    weight = 920.0 * 9.805
    rate = (pull_n - drag - 0.010 * weight * np.sqrt(1.0 - SINE**2) - weight * SINE) / 948.0
    return float(LAMBDA_X * SPEED + LAMBDA_V * rate - fuel_w)


def uphill() -> Route:
    gears = SIX_GEARS | {"neutral": True}
    engine = TABLE_4_1 | {"idle_fuel_power_w": 6000.0}
    problem = read_problem({"vehicle": SMART, "engine": engine, "transmission": gears, "brake_max_n": 3000.0, **UPHILL})
    assert isinstance(problem, Route)
    return problem


def fuel_w(omega: float, torque: float) -> float:
    p = np.array(TABLE_4_1["phi"])
    return float(omega * torque * (p @ [1.0, omega, torque, omega * torque, omega**2, torque**2]))


def test_neutral_and_brakes_up_a_slope() -> None:
    assert hamiltonian_w(uphill(), moment()) == pytest.approx([by_hand(0.0, 6000.0)], rel=1e-12)
    assert hamiltonian_w(uphill(), moment(brake_n=800.0)) == pytest.approx([by_hand(-800.0, 6000.0)], rel=1e-12)
    assert best_of_gears_w(uphill(), moment())["neutral"] == pytest.approx([by_hand(0.0, 6000.0)], rel=1e-12)
    assert best_of_gears_w(uphill(), moment(lambda_v=-1000.0))["neutral"] > hamiltonian_w(
        uphill(), moment(lambda_v=-1000.0)
    ), "with a negative costate braking is better"


def test_a_gear_at_its_best_torque() -> None:
    omega = SPEED * 5.796 / 0.2954
    torque = np.linspace(10.0, 100.0, 20_001)
    best = max(by_hand(5.796 / 0.2954 * t, fuel_w(omega, t)) for t in torque)
    found = best_of_gears_w(uphill(), moment())
    assert found["gear 4"] == pytest.approx([best], rel=1e-3)
    assert np.isnan(found["gear 1"]).all(), "20 m/s in first gear would be 8567 rpm"
    pulling = moment(gear=4, engine_speed_radps=omega, torque_nm=60.0, fuel_power_w=fuel_w(omega, 60.0))
    assert hamiltonian_w(uphill(), pulling) == pytest.approx(
        [by_hand(60.0 * 5.796 / 0.2954, fuel_w(omega, 60.0))], rel=1e-12
    )


def test_drives_known_from_the_wheels() -> None:
    line = {"willans": [5000.0, 2.2, 1e-5], "power_w": [0.0, 40_000.0], "force_n": [-3000.0, 4000.0]}
    whole = {name: value for name, value in thesis(engine=line).items() if name != "transmission"}
    problem = read_problem(whole)
    assert isinstance(problem, Accelerate)
    power = 20_000.0
    fuel = 5000.0 + 2.2 * power + 1e-5 * power**2
    level = moment(fuel_power_w=fuel, slope=0.0)
    drag = 0.5 * 1.2 * 0.39 * 1.93 * SPEED**2 + 0.010 * 920.0 * 9.805
    expected = LAMBDA_X * SPEED + LAMBDA_V * (power / SPEED - drag) / 948.0 - fuel
    assert hamiltonian_w(problem, level) == pytest.approx([expected], rel=1e-12)
    assert best_of_gears_w(problem, level)["any power"] >= hamiltonian_w(problem, level)


def test_a_cvt_is_no_worse_than_any_gear() -> None:
    posed = {"kind": "distance", "vehicle": SMART, "engine": TABLE_4_1, "transmission": {"type": "cvt"}}
    problem = read_problem(posed | {"from_speed_mps": 10.0, "distance_m": 1000.0})
    assert isinstance(problem, Distance)
    (free,) = best_of_gears_w(problem, moment(slope=0.0)).values()
    geared = read_problem(
        posed | {"kind": "accelerate", "transmission": SIX_GEARS, "from_speed_mps": 10.0, "to_speed_mps": 20.0}
    )
    assert isinstance(geared, Accelerate)
    best = np.nanmax(list(best_of_gears_w(geared, moment(slope=0.0)).values()))
    assert free[0] >= best - 1e-3 * abs(best)
