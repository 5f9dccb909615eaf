"""A simulated trip as a whole: files that agree with each other, with the contract and with the seed."""

from __future__ import annotations

import csv
import io
import json
from collections.abc import Callable
from dataclasses import fields, replace

import numpy as np
import pytest
from pyproj import Geod

from app.science.engine.efficiency_map import CellGrid
from app.science.errors import ScienceError
from app.science.observer.states import STATE_COLUMNS
from app.science.vehicle.model import Injection, Mounting
from app.science.vehicle.xml import read_vehicle
from app.science.virtualcar.simulate import SimulatedTrip, simulate
from app.science.virtualcar.specification import DEFAULT_CAR, RouteName, Simulation

Hour = Callable[[RouteName, int], SimulatedTrip]


@pytest.fixture(scope="module")
def trip(hour: Hour) -> SimulatedTrip:
    return hour("mixed", 1)


def test_the_seed_decides_everything() -> None:
    spec = Simulation(duration_s=120.0, seed=9)
    one, same, other = simulate(spec), simulate(spec), simulate(replace(spec, seed=10))
    assert one.image == same.image
    assert one.car_xml == same.car_xml
    assert one.elevation_csv == same.elevation_csv
    assert all(np.array_equal(one.truth[name], same.truth[name], equal_nan=True) for name in one.truth)
    assert json.dumps(one.summary) == json.dumps(same.summary)
    assert one.image != other.image
    assert one.vehicle.mounting != other.vehicle.mounting


def test_truth_has_the_columns_of_the_contract(trip: SimulatedTrip) -> None:
    derived = {"lat_deg", "lon_deg", "alt_m", "torque_nm", "power_w", "efficiency", "gear"}
    assert set(trip.truth) == {"t_s", *STATE_COLUMNS} | derived
    assert {len(column) for column in trip.truth.values()} == {72001}
    assert {column.dtype for column in trip.truth.values()} == {np.dtype(np.float64)}
    assert np.diff(trip.truth["t_s"]) == pytest.approx(0.05)
    assert all(np.all(np.isfinite(trip.truth[name])) for name in trip.truth if name != "efficiency")
    assert np.all((trip.truth["heading_rad"] >= 0) & (trip.truth["heading_rad"] < 2 * np.pi))


def test_truth_agrees_with_itself(trip: SimulatedTrip) -> None:
    c = trip.truth
    assert c["power_w"] == pytest.approx(c["thrust_n"] * c["speed_mps"])
    turning = c["engine_speed_radps"] > 1.0
    assert (c["torque_nm"] * c["engine_speed_radps"])[turning] == pytest.approx(c["power_w"][turning])
    assert np.array_equal(np.isnan(c["efficiency"]), c["power_w"] <= 2000.0)
    assert c["down_m"] == pytest.approx(-c["alt_m"])
    way = 0.5 * (c["speed_mps"][1:] + c["speed_mps"][:-1]) * 0.05
    assert np.sum(way) == pytest.approx(c["distance_m"][-1], rel=1e-5)
    burned = np.interp(c["t_s"], trip.drive.t_s, trip.drive.fuel_energy_j)
    assert c["fuel_energy_j"] == pytest.approx(burned)


def test_truth_efficiency_is_the_map_in_every_gear(trip: SimulatedTrip) -> None:
    c = trip.truth
    geared = np.isfinite(c["efficiency"]) & (c["gear"] > 0)
    rpm = c["engine_speed_radps"][geared] * 30 / np.pi
    expected = trip.engine.map_efficiency(rpm, np.minimum(c["torque_nm"][geared], trip.engine.full_load_nm(rpm)))
    assert c["efficiency"][geared] == pytest.approx(expected, abs=1e-9)
    slipping = np.isfinite(c["efficiency"]) & (c["gear"] == 0)
    assert 0.0 < np.mean(slipping) < 0.03


def test_places_are_on_the_ellipsoid(trip: SimulatedTrip) -> None:
    c = trip.truth
    geod = Geod(ellps="WGS84")
    i = np.arange(0, len(c["t_s"]) - 200, 200)
    azimuth, _, length = geod.inv(c["lon_deg"][i], c["lat_deg"][i], c["lon_deg"][i + 200], c["lat_deg"][i + 200])
    flat = np.hypot(c["north_m"][i + 200] - c["north_m"][i], c["east_m"][i + 200] - c["east_m"][i])
    assert length == pytest.approx(flat, rel=1e-4, abs=1e-3)
    straight = np.array(length) > 150.0
    bearing = np.arctan2(c["east_m"][i + 200] - c["east_m"][i], c["north_m"][i + 200] - c["north_m"][i])
    turned = np.angle(np.exp(1j * (np.radians(azimuth) - bearing)))
    assert np.abs(turned[straight]).max() < np.radians(0.3)


def test_summary_can_be_written_and_tells_the_truth(trip: SimulatedTrip) -> None:
    summary = json.loads(json.dumps(trip.summary))
    assert summary["seed"] == 1
    assert summary["distance_m"] == pytest.approx(trip.truth["distance_m"][-1])
    assert summary["fuel_l"] * 32e6 == pytest.approx(trip.truth["fuel_energy_j"][-1])
    assert summary["engine"]["phi"][0] == 9.4360
    assert summary["vehicle"]["mass_kg"] == 919.0
    assert {abs(b) < 0.2 and abs(b) > 0.05 for b in summary["bias_mps2"].values()} == {True}
    assert summary["mounting"]["roll_rad"] == trip.vehicle.mounting.roll_rad
    first, last = summary["stops"][0], summary["stops"][-1]
    assert first["begin_s"] == 0.0
    assert first["end_s"] >= 10.0
    assert last["end_s"] == 3600.0
    for stop in summary["stops"]:
        middle = 0.5 * (stop["begin_s"] + stop["end_s"])
        assert np.interp(middle, trip.truth["t_s"], trip.truth["speed_mps"]) == 0.0


def test_the_tunnel_is_three_minutes_dark(hour: Hour) -> None:
    outages = hour("tunnel", 2).summary["gps_outages_s"]
    assert max(end - begin for begin, end in outages) >= 180.0
    assert outages[0] == [0.0, 8.0]


def test_the_car_file_says_what_was_driven(trip: SimulatedTrip) -> None:
    read = read_vehicle(trip.car_xml)
    for field in fields(read):
        if field.name != "files":
            assert getattr(read, field.name) == getattr(trip.vehicle, field.name), field.name
    assert read.accelerated_mass_kg(0) == pytest.approx(948.0, abs=1.0)


def test_an_unusual_car_file() -> None:
    car = replace(
        DEFAULT_CAR,
        owner='Ann & "Bo"',
        tyre="",
        wheel_radius_m=0.31,
        gear_ratios=(14.0, 8.0, 5.5, 4.0),
        mounting=Mounting(0.1, -0.2, 3.0, 1.01),
        injection=Injection(0.012, -0.0002, "grouped", 2),
        cylinders=4,
        engine_type="1.6 Inline 4",
    )
    trip = simulate(Simulation(duration_s=90.0, vehicle=car))
    read = read_vehicle(trip.car_xml)
    for name in ("owner", "wheel_radius_m", "gear_ratios", "mounting", "injection"):
        assert getattr(read, name) == getattr(car, name), name
    assert trip.vehicle == car


def test_elevation_nodes_lie_on_the_road(trip: SimulatedTrip) -> None:
    rows = list(csv.DictReader(io.StringIO(trip.elevation_csv.decode("ascii"))))
    assert list(rows[0]) == ["lat_deg", "lon_deg", "alt_m", "way"]
    table = np.array([[float(v) for v in row.values()] for row in rows])
    geod = Geod(ellps="WGS84")
    _, _, step = geod.inv(table[:-1, 1], table[:-1, 0], table[1:, 1], table[1:, 0])
    assert np.array(step).max() < 41.0
    doubled = np.diff(table[:, 3]) != 0
    assert np.all(np.array(step)[doubled] == 0.0)
    assert np.all(np.diff(table[:, 3]) >= 0)
    assert np.sum(step) == pytest.approx(trip.summary["distance_m"] + 300.0, rel=2e-3)
    assert np.abs(table[:, 2] * 10 - np.rint(table[:, 2] * 10)).max() < 1e-6
    nearest = [
        np.argmin((trip.truth["lat_deg"] - lat) ** 2 + (0.65 * (trip.truth["lon_deg"] - lon)) ** 2)
        for lat, lon in table[50:1000:50, :2]
    ]
    assert trip.truth["alt_m"][nearest] == pytest.approx(table[50:1000:50, 2], abs=0.15)


def test_a_cells_mean_is_near_its_centre(trip: SimulatedTrip) -> None:
    """The map to find is smooth at the scale of a cell, so that cell means can be held against it."""
    grid, c = CellGrid(), trip.truth
    geared = np.isfinite(c["efficiency"]) & (c["gear"] > 0)
    rpm, nm = c["engine_speed_radps"][geared] * 30 / np.pi, c["torque_nm"][geared]
    centre = trip.engine.map_efficiency((rpm // grid.rpm + 0.5) * grid.rpm, (nm // grid.nm + 0.5) * grid.nm)
    assert np.nanstd(c["efficiency"][geared] - centre) < 0.01


def test_impossible_trips_are_refused() -> None:
    with pytest.raises(ScienceError, match="too short"):
        simulate(Simulation(duration_s=59.0))
    with pytest.raises(ScienceError, match="no gears"):
        simulate(Simulation(vehicle=replace(DEFAULT_CAR, gear_ratios=())))
