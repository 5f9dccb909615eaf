"""Trips of the same virtual car, and of one whose engine got worse."""

from __future__ import annotations

from dataclasses import replace
from functools import cache

import numpy as np
import pytest

from app.imports.elevation import read_elevation
from app.science.arrays import BoolArray
from app.science.engine.cells import accumulate
from app.science.engine.compare_trips import TripComparison, compare_trips
from app.science.engine.efficiency_map import CellGrid, CellSums
from app.science.engine.operating import operating_points
from app.science.errors import ScienceError
from app.science.logger.decode import decode_image
from app.science.observer.observe import observe
from app.science.vehicle.xml import read_vehicle
from app.science.virtualcar.simulate import simulate
from app.science.virtualcar.specification import Simulation
from tests.synthetic import random_points

GRID = CellGrid()


@cache
def trips() -> list[CellSums]:
    """Sums of six trips of a quarter of an hour, as the observer sees them."""
    found = []
    for seed in range(6):
        trip = simulate(Simulation(duration_s=900.0, seed=4200 + seed))
        vehicle, recording = read_vehicle(trip.car_xml), decode_image(trip.image).recordings[0]
        seen = observe(recording, vehicle, elevation=read_elevation(trip.elevation_csv))
        found.append(accumulate(operating_points(seen, recording, vehicle), GRID))
    return found


def scaled(sums: CellSums, factor: float) -> CellSums:
    """The same trip of an engine that does so much more work with its fuel."""
    return replace(
        sums,
        efficiency_sum=factor * sums.efficiency_sum,
        efficiency_squared_sum=factor**2 * sums.efficiency_squared_sum,
        power_sum_w=factor * sums.power_sum_w,
    )


def chosen(*which: int) -> BoolArray:
    return np.isin(np.arange(6), which)


def compared(parts: list[CellSums], first: BoolArray, second: BoolArray) -> TripComparison:
    return compare_trips(parts, first, second, GRID)


def test_two_halves_of_the_same_cars_trips_are_the_same() -> None:
    changed, cells = 0, 0
    for half in ((0, 1, 2), (0, 2, 4), (1, 3, 4), (0, 3, 5), (1, 2, 5)):
        found = compared(trips(), chosen(*half), ~chosen(*half)).difference
        changed, cells = changed + int(found.significant.sum()), cells + len(found.rpm)
        assert found.level == pytest.approx(1.0, abs=2.0 * found.level_sd)
        assert found.level_sd < 0.008
    assert cells > 1500
    assert changed <= 0.002 * cells


def test_a_worse_engine_is_found_with_how_much() -> None:
    parts = [scaled(one, 0.94 if number >= 3 else 1.0) for number, one in enumerate(trips())]
    found = compared(parts, chosen(0, 1, 2), chosen(3, 4, 5)).difference
    assert found.level == pytest.approx(0.94, abs=3.0 * found.level_sd)
    assert found.significant.mean() > 0.3
    assert (found.difference[found.significant] < 0.0).all()


def test_what_is_in_both_sets_cancels() -> None:
    """Adding a trip to five is as sure as that trip against the five, and no surer."""
    grown = compared(trips(), chosen(0, 1, 2, 3, 4), chosen(0, 1, 2, 3, 4, 5))
    assert (grown.trips_first, grown.trips_second, grown.trips_in_both) == (5, 6, 5)
    assert grown.difference.significant.sum() == 0
    same = compared(trips(), chosen(0, 1), chosen(0, 1)).difference
    assert np.array_equal(same.difference, np.zeros(len(same.rpm)))
    assert same.level == 1.0
    bad = [scaled(one, 0.9 if number == 5 else 1.0) for number, one in enumerate(trips())]
    fallen = compared(bad, chosen(0, 1, 2, 3, 4), chosen(0, 1, 2, 3, 4, 5)).difference
    assert 0.96 < fallen.level < 1.0 - 2.0 * fallen.level_sd


def test_trips_that_differ_as_a_whole_widen_the_level() -> None:
    """Days of wind and load: levels 3 % apart say that a difference of 3 % between two sets is nothing."""
    levels = (1.03, 0.97, 1.0, 0.98, 1.02, 1.03)
    parts = [scaled(one, level) for one, level in zip(trips(), levels, strict=True)]
    found = compared(parts, chosen(0, 1, 2), chosen(3, 4, 5))
    assert 0.015 < found.trip_sd < 0.04
    assert found.difference.level == pytest.approx(1.0, abs=2.0 * found.difference.level_sd)
    assert found.difference.significant.mean() < 0.01


def test_points_seconds_apart_are_compared_in_coarser_cells() -> None:
    sparse = [accumulate(random_points(60, seed), GRID) for seed in range(6)]
    found = compared(sparse, chosen(0, 1, 2), chosen(3, 4, 5))
    assert found.grid.independent
    assert found.points_per_look == 1.0
    assert not found.difference.significant.any()


def test_too_little_in_common_is_said() -> None:
    with pytest.raises(ScienceError, match="share 0 trusted cells"):
        compared(trips(), chosen(), chosen(0))
