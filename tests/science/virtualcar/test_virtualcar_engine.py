"""The virtual engine burns what its map says."""

from __future__ import annotations

import csv
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from scipy.interpolate import RegularGridInterpolator
from scipy.optimize import minimize

from app.science.errors import ScienceError
from app.science.vehicle.model import Injection
from app.science.virtualcar.engine import EngineModel
from app.science.virtualcar.specification import DEFAULT_CAR


def test_best_efficiency_is_the_papers() -> None:
    engine = EngineModel()
    best = minimize(
        lambda x: -engine.map_efficiency(np.array([1000.0 * x[0]]), np.array([100.0 * x[1]]))[0],
        [3.0, 0.8],
        method="Nelder-Mead",
        options={"xatol": 1e-6, "fatol": 1e-12},
    )
    assert -best.fun == pytest.approx(0.3896, abs=5e-5)
    assert best.x == pytest.approx([3.867, 0.929], abs=5e-4)


def test_polynomial_by_hand() -> None:
    omega, torque = 300.0, 60.0
    phi = 9.4360 - 0.018136 * 300 - 0.068797 * 60 + 3.7201e-6 * 300 * 60 + 2.1965e-5 * 300**2 + 3.6204e-4 * 60**2
    power = EngineModel().fuel_power_w(np.array(omega), np.array(torque))
    assert float(power) == pytest.approx(omega * torque * phi, rel=1e-12)


def test_idle_floor_is_out_of_sight_where_a_map_looks() -> None:
    engine = EngineModel()
    rpm, nm = np.meshgrid(np.arange(900.0, 6200.0, 25.0), np.arange(1.0, 111.0, 0.5))
    omega = rpm * np.pi / 30
    propelling = omega * nm > 2000.0
    assert np.all(engine.fuel_power_w(omega, nm)[propelling] > engine.idle_fuel_power_w)
    assert engine.fuel_power_w(np.array(90.0), np.array(-3.0)) == engine.idle_fuel_power_w


def test_full_load_meets_the_ratings() -> None:
    engine = EngineModel()
    assert engine.full_load_nm(np.array(4500.0)) == 110.0
    assert engine.full_load_nm(np.array(5250.0)) * 5250 * np.pi / 30 == pytest.approx(60e3, rel=1e-3)
    assert np.isnan(engine.map_efficiency(np.array(1500.0), np.array(90.0)))


def test_the_default_car_has_the_papers_engine() -> None:
    engine = EngineModel.for_vehicle(DEFAULT_CAR)
    assert engine.phi == EngineModel().phi
    assert np.array(engine.full_load) == pytest.approx(np.array(EngineModel().full_load), rel=5e-4)
    assert engine.limited_by_injectors(DEFAULT_CAR) is engine


def test_a_stretched_engine_keeps_its_map_over_relative_load() -> None:
    van = replace(DEFAULT_CAR, max_torque_nm=330.0, max_torque_rpm=1800.0, max_power_rpm=3500.0, max_power_w=110e3)
    engine, smart = EngineModel.for_vehicle(van), EngineModel()
    rpm, nm = np.meshgrid(np.arange(1200.0, 5200.0, 400.0), np.arange(10.0, 60.0, 10.0))
    stretched = engine.map_efficiency(rpm * 3500.0 / 5250.0, nm * 3.0)
    assert stretched == pytest.approx(smart.map_efficiency(rpm, nm), rel=1e-9)
    assert engine.full_load_nm(np.array(3500.0)) * 3500 * np.pi / 30 == pytest.approx(110e3, rel=1e-3)


def test_injectors_bound_the_full_load() -> None:
    small = replace(DEFAULT_CAR, injection=Injection(litres_per_second=0.006))
    engine = EngineModel.for_vehicle(small).limited_by_injectors(small)
    rpm = np.arange(900.0, 6200.0, 10.0)
    omega = rpm * np.pi / 30
    torque = engine.full_load_nm(rpm)
    per_cycle = engine.fuel_power_w(omega, torque) * 4 * np.pi / omega
    pulse_s = per_cycle / (0.006 * 32e6) + 0.0004
    assert 0.0161 < pulse_s.max() < 65535 * 250e-9
    assert np.all(torque <= EngineModel().full_load_nm(rpm) * 1.001)


@pytest.fixture
def geo(shared_data: Callable[[str], Path]) -> dict[str, np.ndarray]:
    with (shared_data("engine-maps-nrel") / "geo_1.0L_SI_41kW.csv").open(newline="") as file:
        rows = [{key: float(value) for key, value in row.items()} for row in csv.DictReader(file)]
    rpm = np.unique([row["rpm"] for row in rows])
    nm = np.unique([row["torque_nm"] for row in rows])
    fuel = np.empty((len(rpm), len(nm)))
    full_load = np.empty(len(rpm))
    for row in rows:
        i, j = np.searchsorted(rpm, row["rpm"]), np.searchsorted(nm, row["torque_nm"])
        fuel[i, j] = row["fuel_g_s"]
        full_load[i] = row["max_torque_nm_at_rpm"]
    return {"rpm": rpm, "nm": nm, "fuel": fuel, "full_load": full_load}


def test_measured_table_is_bilinear_and_masked(geo: dict[str, np.ndarray]) -> None:
    engine = EngineModel.from_fuel_rate(geo["rpm"], geo["nm"], geo["fuel"], geo["full_load"], idle_fuel_power_w=1.0)
    oracle = RegularGridInterpolator((geo["rpm"], geo["nm"]), geo["fuel"] * 42600.0)
    rng = np.random.default_rng(3)
    rpm = rng.uniform(geo["rpm"][0], geo["rpm"][-1], 500)
    nm = rng.uniform(geo["nm"][0], geo["nm"][-1], 500)
    assert engine.fuel_power_w(rpm * np.pi / 30, nm) == pytest.approx(oracle((rpm, nm)), rel=1e-9)
    efficiency = engine.map_efficiency(rpm, nm)
    above = nm > np.interp(rpm, geo["rpm"], geo["full_load"])
    assert np.array_equal(np.isnan(efficiency), above)
    assert np.nanmax(efficiency) == pytest.approx(0.341, abs=0.004)


@pytest.mark.parametrize(
    ("change", "words"),
    [
        ({"fuel_gps": np.ones((3, 2))}, "doesn't fit"),
        ({"rpm": np.array([2000.0, 1000.0])}, "must increase"),
        ({"nm": np.array([0.0, 10.0])}, "must increase"),
        ({"fuel_gps": np.array([[1.0, np.nan], [1.0, 2.0]])}, "not finite"),
    ],
)
def test_bad_tables_are_refused(change: dict[str, np.ndarray], words: str) -> None:
    table = {
        "rpm": np.array([1000.0, 2000.0]),
        "nm": np.array([10.0, 20.0]),
        "fuel_gps": np.ones((2, 2)),
        "full_load_nm": np.array([20.0, 20.0]),
    }
    with pytest.raises(ScienceError, match=words):
        EngineModel.from_fuel_rate(**(table | change))
