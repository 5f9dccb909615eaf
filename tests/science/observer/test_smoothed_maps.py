"""Smoothing never makes a healthy trip's map worse than filtering."""

from __future__ import annotations

from typing import get_args

import pytest

from app.imports.elevation import read_elevation
from app.science.engine.accuracy import map_error
from app.science.engine.cells import accumulate, build_map
from app.science.engine.efficiency_map import CellGrid
from app.science.engine.operating import operating_points
from app.science.logger.decode import decode_image
from app.science.observer.observe import observe
from app.science.vehicle.xml import read_vehicle
from app.science.virtualcar.simulate import SimulatedTrip, simulate
from app.science.virtualcar.specification import RouteName, Simulation


def error_of_the_map(trip: SimulatedTrip, *, smooth: bool, elevation: bool) -> float:
    recording, vehicle, grid = decode_image(trip.image).recordings[0], read_vehicle(trip.car_xml), CellGrid()
    heights = read_elevation(trip.elevation_csv) if elevation else None
    seen = observe(recording, vehicle, elevation=heights, smooth=smooth)
    assert seen.verdict == "healthy"
    sums = accumulate(operating_points(seen, recording, vehicle), grid)
    return map_error(build_map(sums, grid, vehicle), trip.engine.map_efficiency).rmse


@pytest.mark.parametrize("route", get_args(RouteName))
def test_on_no_route_is_the_smoothed_map_worse(route: RouteName) -> None:
    trip = simulate(Simulation(duration_s=480.0, seed=631, route=route))
    for elevation in (True, False):
        filtered, smoothed = (error_of_the_map(trip, smooth=smooth, elevation=elevation) for smooth in (False, True))
        assert smoothed < filtered, elevation
