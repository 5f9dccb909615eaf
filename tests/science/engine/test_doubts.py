"""When pulses don't tell the fuel, or more work came out than fuel went in, it is said."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from app.science.engine.doubts import engine_doubts
from app.science.engine.points import OperatingPoints
from app.science.logger.recording import Recording, Series
from app.science.vehicle.model import Injection, Vehicle
from tests.science.engine.test_full_load import drive as sweeps
from tests.synthetic import drive

ONE = Series(np.array([0.0]), np.array([0.004]))
PULSES = Recording({"injector_pulse_s": ONE})
CAR = Vehicle()


def loads(seed: int = 1) -> OperatingPoints:
    return sweeps(np.random.default_rng(seed).uniform(0.6, 1.0, 120), seed=seed, noise=0.04)


def second_group(points: OperatingPoints, factor: float = 1.4) -> OperatingPoints:
    """Every other sweep gets more torque out of the pulses that are logged."""
    helped = np.where(np.floor(points.t_s / 20.0) % 2 == 0, factor, 1.0)
    return replace(points, torque_nm=points.torque_nm * helped, power_w=points.power_w * helped)


def test_ordinary_scatter_raises_no_doubt() -> None:
    for seed in range(5):
        assert engine_doubts(drive(), loads(seed), PULSES, CAR) == ()


def test_a_second_group_of_injectors_shows_in_the_data() -> None:
    (doubt,) = engine_doubts(drive(), second_group(loads()), PULSES, CAR)
    assert doubt.startswith("Pulses of the same length brought two clearly different torques")
    assert "fuel_rate_lph" in doubt


def test_it_does_not_matter_where_the_engine_control_unit_tells_the_fuel() -> None:
    told = Recording({"injector_pulse_s": ONE, "fuel_rate_lph": ONE})
    assert engine_doubts(drive(), second_group(loads()), told, CAR) == ()


@pytest.mark.parametrize(("system", "words"), [("direct", "injects directly"), ("dual", "second group of injectors")])
def test_what_the_car_file_says_is_warned_about(system: str, words: str) -> None:
    car = replace(CAR, injection=Injection(system=system))
    (doubt,) = engine_doubts(drive(), loads(), PULSES, car)
    assert words in doubt
    assert engine_doubts(drive(), loads(), Recording({"fuel_rate_lph": ONE}), car) == ()


def test_more_work_than_fuel_is_told_with_what_to_check() -> None:
    seen = drive()
    columns = dict(seen.columns) | {"fuel_power_w": 0.3 * seen.columns["fuel_power_w"]}
    (doubt,) = engine_doubts(replace(seen, columns=columns), loads(), PULSES, CAR)
    assert "more work came out than the energy of its fuel" in doubt
    assert "injectors' flow" in doubt
    by_ecu = replace(loads(), torque_source="ecu")
    assert engine_doubts(replace(seen, columns=columns), by_ecu, Recording({"fuel_rate_lph": ONE}), CAR) == ()
