"""Measured engines are found again from driving."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from app.cli.bench.engine_cars import ENGINE_CARS, EngineCar
from app.cli.bench.engines import GRID, compared, drive, found_map, layout, plain
from app.cli.bench.figure import Figure
from app.science.engine.cells import accumulate, build_map
from app.science.engine.full_load import FullLoad
from app.science.engine.points import OperatingPoints

GEO = ENGINE_CARS[0]


def test_an_hour_finds_the_map_the_full_load_and_the_idle_of_an_engine(shared_data: Callable[[str], Path]) -> None:
    driven = drive(GEO, shared_data("engine-maps-nrel"), [("full-load", 7201), ("mixed", 7202)], duration_s=1800.0)
    found = found_map(GEO, driven)
    error = compared(found, driven.engine)
    assert error.rmse <= 0.010
    assert error.full_load <= 0.04
    assert error.full_load < 0.5 * plain(GEO, driven, found).full_load
    assert found.full_load_reached is not None
    assert found.full_load_sd is not None
    assert found.full_load_reached.sum() >= 15
    off = np.abs(found.full_load_nm - driven.engine.full_load_nm(found.full_load_rpm)) / found.full_load_sd
    assert np.mean(off[found.full_load_reached] < 2.0) >= 0.8
    assert found.idle is not None
    assert found.idle.fuel_power_w == pytest.approx(GEO.idle_fuel_power_w, rel=0.03)
    assert found.idle.rpm == pytest.approx(GEO.vehicle.idle_rpm, rel=0.02)


@pytest.mark.parametrize("car", ENGINE_CARS, ids=lambda car: car.name)
def test_the_best_point_of_a_well_known_field_gives_nothing_away(
    car: EngineCar, shared_data: Callable[[str], Path]
) -> None:
    engine, rng = car.engine(shared_data("engine-maps-nrel")), np.random.default_rng(4)
    low, high = engine.full_load[0][0], engine.full_load[-1][0]
    rpm = rng.uniform(low, high, 400_000)
    nm = rng.uniform(0.1, 1.0, len(rpm)) * engine.full_load_nm(rpm)
    power = nm * rpm * np.pi / 30.0
    fuel = power / engine.map_efficiency(rpm, nm)
    noisy = nm * (1.0 + 0.03 * rng.standard_normal(len(rpm)))
    points = OperatingPoints(
        np.arange(len(rpm)) * 0.05, rpm, noisy, power * noisy / nm, fuel, power * noisy / nm / fuel, nm, "observer"
    )
    speeds = np.linspace(low, high, 60)
    ceiling = FullLoad(speeds, engine.full_load_nm(speeds), np.full(60, 0.5), np.ones(60, np.bool_))
    error = compared(build_map(accumulate(points, GRID), GRID, car.vehicle, ceiling), engine)
    assert error.given_away < 0.005
    assert error.rmse < 0.010


def test_one_row_for_each_engine() -> None:
    one = Figure("Geo 1.0 L: best point, off by", 93.0, "rpm", 400.0, "highest cell")
    rows = layout([one, replace(one, value=0.5, unit="Nm"), replace(one, name="VW 1.9 L: best point, off by")])
    assert rows[0] == ["engine", "best point, off by, rpm", "best point, off by, Nm"]
    assert rows[1] == ["Geo 1.0 L", "93 (400)", "0.5 (400)"]
    assert rows[2] == ["VW 1.9 L", "93 (400)", "-"]
