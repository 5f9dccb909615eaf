"""Fuel from wheel power: a known truth is found again, and real tests predict one another."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

from app.imports.cycle import read_cycle
from app.science.engine.wheel_fuel import WARM_UP_S, Demand, WheelFuelModel, hot_terms, predict
from app.science.engine.wheel_fuel_fit import fit_wheel_fuel
from app.science.engine.wheel_power import DrivingCycle, RoadLoad, engine_runs, propulsion_n
from app.science.errors import ScienceError, TooLittleData
from app.science.vehicle.fuels import FUELS
from app.science.vehicle.model import Vehicle

LOAD = RoadLoad(1200.0, 110.0, 1.0, 0.4)
CAMRY = RoadLoad(1644.3 * 1.03, 117.918, 1.97525, 0.366729)
"""Camry XLE 2.5 l of 2018 in the EPA's list of test cars: 3625 lb, 26.509 lbf, 0.19851 lbf/mph, 0.016476 lbf/mph²."""


def trace(seconds: int, seed: int, standing: int = 40) -> np.ndarray:
    """Speeds of a drive that begins and ends at rest."""
    random = np.random.default_rng(seed)
    knots = np.arange(0, seconds, 30)
    speeds = random.choice([0.0, 8.0, 14.0, 25.0], size=len(knots))
    moving = np.interp(np.arange(seconds), knots, speeds)
    return np.concatenate([np.zeros(20), np.convolve(moving, np.ones(8) / 8, "same"), np.zeros(standing)])


def burnt(speed: np.ndarray, warm_up_j: float) -> np.ndarray:
    """Fuel power of a car without slip: 6 kW idle, 1 kW dragged along, 7 kW + 2.5 P, written out second by second."""
    power = propulsion_n(speed, LOAD) * speed
    fuel = []
    for v, p in zip(speed, power, strict=True):
        if v < 0.3:
            fuel.append(6000.0)
        elif v < 4.0:
            force = p / v
            fuel.append(max(6000.0, 7000.0 + 2.5 * (force * 4.0 if force > 0 else p)))
        else:
            fuel.append(max(1000.0, 7000.0 + 2.5 * p))
    return np.array(fuel) + warm_up_j / WARM_UP_S * np.exp(-np.arange(len(speed)) / WARM_UP_S)


@pytest.fixture(scope="module")
def known() -> WheelFuelModel:
    cold, hot = trace(1500, 1), trace(1500, 2)
    drives = [DrivingCycle("cold", cold, burnt(cold, 2e6)), DrivingCycle("hot", hot, burnt(hot, 0.0))]
    return fit_wheel_fuel(drives, LOAD)


def test_a_known_truth_is_found(known: WheelFuelModel) -> None:
    assert known.coefficients == pytest.approx([6000.0, 1000.0, 7000.0, 2.5, 0.0], rel=0.01, abs=1e-6)
    assert (known.creep_mps, known.gaining_share, known.quadratic) == (4.0, 0.0, False)
    assert known.warm_up_j == pytest.approx(2e6, rel=0.01)


def test_a_prediction_is_the_known_truth_and_knows_cold_from_hot(known: WheelFuelModel) -> None:
    speed = trace(900, 3, standing=10)
    for cold, warm_up_j in ((True, 2e6), (False, 0.0)):
        found = predict(known, DrivingCycle("x", speed), LOAD, cold=cold)
        assert found.energy_j == pytest.approx(burnt(speed, warm_up_j).sum(), rel=0.005)
        assert found.warm_up_j == pytest.approx(warm_up_j, rel=0.01, abs=1.0)


def test_what_was_measured_of_a_predicted_drive_is_not_looked_at(known: WheelFuelModel) -> None:
    speed = trace(900, 3)
    blind, seeing = DrivingCycle("x", speed), DrivingCycle("x", speed, np.full(len(speed), 1e6))
    assert predict(known, seeing, LOAD).energy_j == predict(known, blind, LOAD).energy_j


def test_beyond_what_was_driven_it_stays_monotone_and_convex(known: WheelFuelModel) -> None:
    bent = WheelFuelModel(
        **{name: getattr(known, name) for name in known.__slots__ if name != "curvature_1pw"}, curvature_1pw=2e-5
    )
    power, never, always = np.linspace(-50e3, 4.0 * known.top_w, 2000), np.zeros(2000, bool), np.ones(2000, bool)
    rolling = Demand(power, standing=never, creeping=never, runs=always)
    for model in (known, bent):
        steps = np.diff(hot_terms(rolling, model.coefficients, model.top_w) @ model.coefficients)
        assert steps.min() >= 0.0
        assert np.diff(steps).min() >= -1e-6
        assert steps[power[:-1] > model.top_w].std() < 1e-6


@pytest.fixture(scope="module")
def camry(shared_data: Callable[[str], Path]) -> dict[str, DrivingCycle]:
    folder = shared_data("dyno-camry-fuelflow")
    names = ("61811011", "61811012", "61811013")
    return {name: read_cycle((folder / f"{name}.csv").read_bytes(), name, FUELS["petrol"]) for name in names}


@pytest.mark.parametrize("held_out", ["61811011", "61811012", "61811013"])
def test_two_tests_of_a_real_car_predict_the_third(camry: dict[str, DrivingCycle], held_out: str) -> None:
    """61811011 alone starts cold, so that what its start costs is not to be learned from the other two."""
    model = fit_wheel_fuel([cycle for name, cycle in camry.items() if name != held_out], CAMRY)
    found = predict(model, camry[held_out], CAMRY, cold=held_out == "61811011")
    measured = camry[held_out].fuel_power_w
    assert measured is not None
    assert found.energy_j / measured.sum() == pytest.approx(1.0, abs=0.03)
    assert abs(found.energy_j - measured.sum()) < 2.0 * found.energy_sd_j
    assert 0.30 < 1.0 / model.slope < 0.50  # of a watt more in the tank, so much more reaches the wheels
    assert (model.warm_up_j is None) == (held_out == "61811011")


def test_the_engine_is_off_while_parked_and_at_the_end() -> None:
    speed = np.concatenate([np.zeros(20), np.full(60, 10.0), np.zeros(600), np.full(60, 10.0), np.zeros(60)])
    runs = engine_runs(DrivingCycle("x", speed), by_fuel=False)
    off = np.flatnonzero(~runs)
    assert (off[0], off[-1]) == (90, 799)
    assert runs[660:750].all()
    assert runs[:90].all()
    assert not runs[90:660].any()


@pytest.mark.parametrize(
    ("cycle", "words"),
    [
        (DrivingCycle("blind", trace(900, 1)), "No fuel was measured in blind"),
        (DrivingCycle("short", trace(200, 1), np.full(260, 7e3)), "260 s in all"),
        (DrivingCycle("still", np.zeros(900), np.full(900, 7e3)), "At most 0.0 kW reach the wheels"),
    ],
)
def test_too_little_to_learn_from_is_said_so(cycle: DrivingCycle, words: str) -> None:
    with pytest.raises(TooLittleData, match=words):
        fit_wheel_fuel([cycle], LOAD)


def test_a_road_load_is_that_of_the_cars_file() -> None:
    load = RoadLoad.of(Vehicle(mass_wet_kg=900.0, load_kg=100.0, crr=0.01, gravity_mps2=9.8))
    assert load.a_n == pytest.approx(98.0)
    assert load.c_npmps2 == pytest.approx(0.5 * 1.2 * 0.39 * 1.93)
    assert load.accelerated_mass_kg == pytest.approx(1000.0 + 4.0 * 0.62 / 0.2954**2)
    for bad in ((-1.0, 1.0, 0.0, 1.0), (1.0, 1.0, float("nan"), 1.0)):
        with pytest.raises(ScienceError, match="a mass above zero"):
            RoadLoad(*bad)
