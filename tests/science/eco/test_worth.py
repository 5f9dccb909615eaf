"""What speed is worth, read from a drive, against the costate of Pontryagin's principle for the same drive."""

from __future__ import annotations

import numpy as np
import pytest

from app.science.eco.best import Car, ride_of_trajectory
from app.science.eco.fuel_model import FuelModel
from app.science.eco.losses import Drive
from app.science.eco.ride import burnt
from app.science.eco.worth import costate
from app.science.engine.fitting.willans import WILLANS
from app.science.optimal.accelerate.answering import answer
from app.science.optimal.problem import Accelerate, PolynomialEngine, RoadLoad, Transmission
from tests.science.eco.trips import CAR, COEFFICIENTS, FULL_LOAD, IDLE_W

LOAD = RoadLoad(CAR.mass_kg, CAR.mass_kg + 30.0, 0.39, 1.93, CAR.crr, 1.2, CAR.gravity_mps2, CAR.wheel_radius_m)
STEEP = (*COEFFICIENTS[:4], 0.012)
"""The last coefficient makes high torque dear, so that the best torque lies below full load."""


def test_it_is_the_costate_where_torque_is_chosen_freely() -> None:
    engine = PolynomialEngine(WILLANS.terms, STEEP, (900.0, 5400.0), (5.0, 105.0), FULL_LOAD, IDLE_W)
    ratios = CAR.gear_ratios
    found = answer(Accelerate(LOAD, engine, Transmission("gears", ratios), 10.0, 25.0))
    model = FuelModel(np.array(STEEP), IDLE_W, 0.02, 50.0, 2.0, (900.0, 5400.0))
    car = Car(LOAD, engine, model, ratios, 0.0, False)
    ride = ride_of_trajectory(found.trajectory, car)
    told = costate(Drive(ride, burnt(ride, LOAD, model)), car)
    wanted = np.interp(ride.t_s + 0.5 * ride.dt_s, found.trajectory.t_s, found.costates["speed"])
    torque = burnt(ride, LOAD, model).torque_nm
    freely = torque < np.interp(ride.engine_radps * 30.0 / np.pi, *zip(*FULL_LOAD, strict=True)) - 2.0
    assert freely.mean() > 0.5
    assert told[freely] == pytest.approx(wanted[freely], rel=2e-3)
    assert np.isfinite(told).all()
