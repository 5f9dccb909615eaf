"""What follows from a car's numbers."""

from __future__ import annotations

import numpy as np
import pytest

from app.science.vehicle.model import Injection, Vehicle


@pytest.mark.parametrize(
    ("pattern", "groups", "share"), [("sequential", 1, 1), ("grouped", 2, 2), ("simultaneous", 1, 1)]
)
def test_a_pulse_holds_the_fuel_of_the_injectors_it_stands_for(pattern: str, groups: int, share: int) -> None:
    vehicle = Vehicle(injection=Injection(0.008, -0.0004, pattern, groups))
    energy = vehicle.fuel_energy_of_pulse_j(np.array([0.0054, 0.0004, 0.0001]))
    # 5 ms open at 8 ml/s is 0.04 ml, which holds 1280 J; a pulse shorter than the lag opens nothing
    np.testing.assert_allclose(energy, [1280.0 / share, 0.0, 0.0], atol=1e-9)


def test_the_drag_area_is_that_of_table_3_1() -> None:
    assert Vehicle().drag_area_kgpm == pytest.approx(0.5 * 1.2 * 0.39 * 1.93)
    assert Vehicle().engine_angle_per_pulse_rad == pytest.approx(4.0 * np.pi)


def test_a_car_has_a_title_whatever_is_known() -> None:
    assert Vehicle(make="Smart", year="2004").title == "Smart 2004"
    assert Vehicle().title == "Unnamed car"
