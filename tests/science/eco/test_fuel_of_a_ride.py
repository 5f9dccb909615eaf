"""What a ride takes: work adds up, the known engine's fuel is found again, and the trip corrects a wrong formula."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from app.science.eco.correction import learn
from app.science.eco.driven import driven_trip, slowest_mps, stretches
from app.science.eco.fuel_model import FuelModel, fuel_model_of_map
from app.science.eco.full_load import upper_hull
from app.science.eco.result import NotScored
from app.science.eco.ride import burnt
from app.science.eco.search_engine import engine_near, field
from app.science.optimal.fuel_checks import fuel_power_w
from tests.science.eco.trips import CAR, COEFFICIENTS, FULL_LOAD, IDLE_W, driven, map_document
from tests.science.eco.trips import fuel_w as known_w


def known_model() -> FuelModel:
    model = fuel_model_of_map(map_document())
    assert model is not None
    return model


def test_the_formula_is_the_known_engine() -> None:
    model = known_model()
    assert model.coefficients == pytest.approx(COEFFICIENTS, rel=0.05, abs=0.01)
    assert model.idle_w == IDLE_W
    omega = np.array([150.0, 400.0])
    assert model.fuel_power_w(omega, model.overrun_nm(omega)) == pytest.approx([0.0, 0.0], abs=1e-6)
    assert model.fuel_power_w(omega, np.array([-80.0, -80.0])) == pytest.approx([0.0, 0.0], abs=1e-6)


def test_work_is_kinetic_energy_and_what_is_lost_on_the_way() -> None:
    model = known_model()
    trip = driven_trip(driven(3000.0), CAR, model.idle_w)
    rolling = trip.ride.speed_mps > 1.0
    ride = trip.ride.part(rolling)
    took = burnt(ride, trip.load, model)
    grip = trip.load.rolling_n * ride.speed_mps
    gained = trip.load.accelerated_mass_kg * ride.accel_mps2 * ride.speed_mps
    assert took.engine_w - took.brake_w == pytest.approx(gained + grip + took.air_w, rel=1e-9, abs=1e-6)
    assert took.brake_w.min() >= -1e-9


def test_the_fuel_of_a_trip_is_found_again() -> None:
    model = known_model()
    trip = driven_trip(driven(3000.0), CAR, model.idle_w)
    rows = trip.ride.gear > 0
    took = burnt(trip.ride.part(rows), trip.load, model)
    ours = float(took.fuel_w @ trip.ride.dt_s[rows])
    assert ours == pytest.approx(trip.measured_j(rows), rel=0.01)


def test_a_trip_corrects_a_formula_that_is_wrong_at_low_load() -> None:
    model = known_model()
    trip = driven_trip(driven(3000.0), CAR, model.idle_w)
    wrong = replace(model, coefficients=model.coefficients * np.array([5.0, 1.0, 1.0, 1.0, 1.0]))
    took = burnt(trip.ride, trip.load, wrong)
    moving = (trip.ride.gear > 0) & (trip.ride.speed_mps > 3.0)
    measured = trip.measured_j(moving)
    before = float(took.fuel_w[moving] @ trip.ride.dt_s[moving])
    learnt = learn(wrong, trip.ride, took, trip.measured_w, (9.0, 100.0))
    after = burnt(trip.ride, trip.load, learnt.model)
    left = float(after.fuel_w[moving] @ trip.ride.dt_s[moving]) - measured
    assert before - measured > 0.1 * measured
    assert abs(left) < 0.25 * (before - measured)


def test_the_engine_to_look_with_is_the_known_one() -> None:
    model = known_model()
    engine = engine_near(model, (1200.0, 5000.0), FULL_LOAD)
    omega, torque = field((1200.0, 5000.0), FULL_LOAD)
    assert fuel_power_w(engine, omega, torque) == pytest.approx(known_w(omega, torque), rel=0.01)
    assert -25.0 < engine.torque_nm[0] < -5.0


def test_what_an_engine_gave_at_two_speeds_it_gives_between() -> None:
    hull = upper_hull(np.array([1000.0, 2000.0, 3000.0, 4000.0]), np.array([50.0, 60.0, 100.0, 90.0]))
    assert hull == ((1000.0, 50.0), (3000.0, 100.0), (4000.0, 90.0))


def test_stretches_lie_between_stops() -> None:
    model = known_model()
    trip = driven_trip(driven(3000.0), CAR, model.idle_w)
    found = stretches(trip.ride, slowest_mps(CAR, 1150.0))
    assert [one.reason for one in found] == [""]
    assert trip.ride.speed_mps[found[0].rows].min() >= 1150.0 * np.pi / 30.0 * CAR.wheel_radius_m / 13.25


def test_a_trip_without_what_a_score_stands_on_is_refused() -> None:
    columns = driven(3000.0)
    with pytest.raises(NotScored, match="gear ratios"):
        driven_trip({**columns, "gear": np.zeros_like(columns["gear"])}, CAR, IDLE_W)
    with pytest.raises(NotScored, match="lack thrust_n"):
        driven_trip({name: values for name, values in columns.items() if name != "thrust_n"}, CAR, IDLE_W)


def test_a_car_that_drives_without_its_engine_is_refused() -> None:
    columns = driven(3000.0)
    off = np.where(columns["t_s"] > 20.0, 0.0, columns["engine_speed_radps"])
    with pytest.raises(NotScored, match="a motor drives the car, too"):
        driven_trip({**columns, "engine_speed_radps": off}, CAR, IDLE_W)


def test_a_map_of_a_few_cells_carries_no_formula() -> None:
    document = map_document()
    assert fuel_model_of_map({**document, "cells": document["cells"][:6]}) is None
