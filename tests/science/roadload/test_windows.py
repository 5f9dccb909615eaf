"""Windows of steady driving, against the virtual car's truth and a drive made by hand."""

from __future__ import annotations

import numpy as np
import pytest

from app.exports.parquet import road_load_parquet
from app.imports.results import read_road_load
from app.science.logger.decode import ImageDecoder
from app.science.logger.recording import Recording, Series
from app.science.observer.observe import observe
from app.science.roadload.windows import (
    SETTLE_S,
    SHORTEST_S,
    WINDOW_COLUMNS,
    WINDOW_SCALARS,
    Regime,
    windows,
)
from app.science.vehicle.model import Vehicle
from app.science.virtualcar.simulate import simulate
from app.science.virtualcar.specification import Simulation
from tests.synthetic import RATIOS, drive

CAR = Vehicle(gear_ratios=RATIOS)
MADE_UP = drive()


def test_the_specific_force_is_the_true_balance_of_forces() -> None:
    trip = simulate(Simulation(duration_s=600.0, seed=41))
    (recording,) = ImageDecoder().trips([trip.image])
    found = windows(observe(recording, trip.vehicle), trip.vehicle)
    driving = found.where(found.kind == Regime.DRIVE)
    t, thrust = trip.truth["t_s"], trip.truth["thrust_n"]
    true_thrust = np.array(
        [
            thrust[np.abs(t - middle) <= length / 2].mean()
            for middle, length in zip(driving.t_s, driving.length_s, strict=True)
        ]
    )
    car = trip.vehicle
    resistance = car.drag_area_kgpm * driving.speed_squared_m2ps2 / car.mass_kg + car.crr * driving.normal_mps2
    error = driving.specific_force_mps2 - (true_thrust / car.mass_kg - resistance)
    assert len(driving) > 100
    assert abs(np.median(error)) < 0.01
    assert np.std(error / driving.specific_force_sd_mps2) == pytest.approx(0.8, abs=0.4)


def test_windows_keep_clear_of_gear_changes() -> None:
    found = windows(MADE_UP, CAR)
    t, gear = MADE_UP.columns["t_s"], MADE_UP.columns["gear"]
    changes = t[1:][np.diff(gear) != 0]
    begin, end = found.t_s - found.length_s / 2, found.t_s + found.length_s / 2
    for change in changes:
        assert not np.any((begin < change + SETTLE_S - 0.11) & (end > change - SETTLE_S + 0.11))
    assert np.all(found.length_s >= SHORTEST_S / 2)
    assert set(found.kind.tolist()) == {Regime.DRIVE, Regime.OVERRUN}


def test_a_car_without_known_gears_is_driven_wherever_fuel_burns() -> None:
    found = windows(MADE_UP, Vehicle())
    assert set(found.kind.tolist()) == {Regime.DRIVE, Regime.OVERRUN}
    assert len(found) > len(windows(MADE_UP, CAR))


def test_the_torque_of_the_engine_control_unit_is_taken_where_it_is_reported() -> None:
    at = np.arange(100.0, 200.0, 0.5)
    recording = Recording({"engine_torque_nm": Series(at, 0.5 * at)})
    found = windows(MADE_UP, CAR, recording)
    inside = (found.t_s > 102.0) & (found.t_s < 198.0)
    assert found.torque_nm[inside] == pytest.approx(0.5 * found.t_s[inside], abs=0.01)
    assert np.isnan(found.torque_nm[found.t_s > 202.0]).all()


def test_windows_come_back_from_their_file() -> None:
    found = windows(MADE_UP, CAR)
    back = read_road_load(road_load_parquet(found))
    for name in WINDOW_COLUMNS:
        np.testing.assert_array_equal(getattr(back, name), getattr(found, name))
        assert getattr(back, name).dtype == getattr(found, name).dtype
    for name in WINDOW_SCALARS:
        assert getattr(back, name) == getattr(found, name)


def test_fuel_that_is_asked_for_too_seldom_tells_no_mean() -> None:
    seldom, often = (Series(np.arange(0.0, 600.0, step), np.full(round(600.0 / step), 3.0)) for step in (6.0, 1.0))
    assert np.isnan(windows(MADE_UP, CAR, Recording({"fuel_rate_lph": seldom})).fuel_power_w).all()
    assert np.isfinite(windows(MADE_UP, CAR, Recording({"fuel_rate_lph": often})).fuel_power_w).all()
