"""A table whose thrust nothing measures is not called healthy."""

from __future__ import annotations

import numpy as np
import pytest

from app.science.logger.recording import Recording, series
from app.science.observer.observe import observe
from app.science.vehicle.xml import read_vehicle
from app.science.virtualcar.simulate import simulate
from app.science.virtualcar.specification import Simulation

RPM_PER_RADPS = 30.0 / np.pi
TRIP = simulate(Simulation(duration_s=600.0, seed=41))
VEHICLE = read_vehicle(TRIP.car_xml)


def at_every_second(column: str, scale: float = 1.0):
    t = np.arange(0.0, TRIP.truth["t_s"][-1])
    return series(t, scale * np.interp(t, TRIP.truth["t_s"], TRIP.truth[column]))


@pytest.fixture
def table() -> Recording:
    litres_per_hour = 3600.0 / VEHICLE.fuel_energy_j_per_l
    return Recording(
        {
            "speed_mps": at_every_second("speed_mps"),
            "engine_speed_rpm": at_every_second("engine_speed_radps", RPM_PER_RADPS),
            "fuel_rate_lph": at_every_second("fuel_power_w", litres_per_hour),
        }
    )


def test_speed_engine_speed_and_fuel_rate_alone_are_doubtful(table: Recording) -> None:
    seen = observe(table, VEHICLE)
    assert seen.verdict == "doubtful"
    assert "thrust is known too roughly" in seen.reasons[0]
    assert "neither acceleration nor the engine's torque" in seen.reasons[0]


def test_torque_that_the_engine_reports_makes_it_healthy(table: Recording) -> None:
    with_torque = Recording({**table.signals, "engine_torque_nm": at_every_second("torque_nm")})
    assert observe(with_torque, VEHICLE).verdict == "healthy"


def test_without_fuel_there_is_no_efficiency_to_be_vague(table: Recording) -> None:
    assert observe(table.without({"fuel_rate_lph"}), VEHICLE).verdict == "healthy"
