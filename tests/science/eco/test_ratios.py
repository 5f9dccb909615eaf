"""Gear ratios read off a drive whose gears are known."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from app.science.arrays import FloatArray
from app.science.eco.ratios import with_gears
from tests.science.eco.trips import CAR, driven


def test_the_gears_of_a_drive_are_found_again() -> None:
    truth = several_times(driven(2600.0))
    blind = {**truth, "gear": np.zeros_like(truth["gear"])}
    columns, car = with_gears(blind, replace(CAR, gear_ratios=()))
    used = sorted(set(truth["gear"].astype(int)) - {0})
    assert set(np.round(car.gear_ratios, 2)) <= {round(CAR.gear_ratios[k - 1], 2) for k in used}
    assert len(car.gear_ratios) >= 4
    known = columns["gear"] > 0
    mine = np.array((np.nan, *car.gear_ratios))[columns["gear"].astype(int)]
    theirs = np.array((np.nan, *CAR.gear_ratios))[truth["gear"].astype(int)]
    assert mine[known] == pytest.approx(theirs[known], rel=0.01)


def several_times(trip: dict[str, FloatArray], count: int = 5) -> dict[str, FloatArray]:
    """Return a drive driven some times over; a gear must be seen for a few seconds in all."""
    again = {name: np.tile(values, count) for name, values in trip.items()}
    return again | {"t_s": 0.05 * np.arange(len(again["t_s"]))}


def test_a_car_that_sails_at_idle_shows_no_gear() -> None:
    truth = driven(2600.0)
    idle = np.full_like(truth["t_s"], 900.0 * np.pi / 30.0)
    _, car = with_gears({**truth, "engine_speed_radps": idle}, replace(CAR, gear_ratios=()))
    assert car.gear_ratios == ()


def test_a_file_with_gears_is_believed() -> None:
    truth = driven(2600.0)
    assert with_gears(truth, CAR) == (truth, CAR)
