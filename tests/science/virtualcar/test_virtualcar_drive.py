"""The virtual car obeys mechanics, its gearbox and its driver."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from typing import get_args

import numpy as np
import pytest

from app.science.vehicle.model import Vehicle
from app.science.virtualcar.driver import STEP_S, Drive, drive
from app.science.virtualcar.engine import EngineModel
from app.science.virtualcar.road import Road, build_road
from app.science.virtualcar.simulate import SimulatedTrip
from app.science.virtualcar.specification import DEFAULT_CAR, RouteName

Hour = Callable[[RouteName, int], SimulatedTrip]


@pytest.fixture(scope="module")
def trip(hour: Hour) -> SimulatedTrip:
    return hour("mixed", 1)


def masses(drive: Drive, vehicle: Vehicle) -> np.ndarray:
    """Accelerated mass at every step, from the numbers of Table 3.1 and App. C.1.2."""
    radius = vehicle.wheel_radius_m
    ratio = np.array([0.0, 13.25, 9.604, 7.37, 5.796, 4.208, 3.23])[drive.gear]
    return 844 + 75 + 4 * 0.62 / radius**2 + 0.061 * (ratio / radius) ** 2


def resistance(drive: Drive, road: Road, speed: np.ndarray, distance: np.ndarray) -> np.ndarray:
    """Sebesta 2010, (1.1)–(1.4), with M before S_k v² as it must be."""
    pitch = np.interp(distance, road.distance_m, road.pitch_rad)
    bend = np.interp(distance, road.distance_m, road.curvature_v_radpm)
    air = 0.5 * 1.2 * 0.39 * 1.93 * speed**2
    return air + 919 * 0.010 * (9.805 * np.cos(pitch) + bend * speed**2) + 919 * 9.805 * np.sin(pitch)


def test_every_step_obeys_newton(trip: SimulatedTrip) -> None:
    d = trip.drive
    pull = d.thrust_n - resistance(d, trip.road, d.speed_mps, d.distance_m + 0.5 * STEP_S * d.speed_mps)
    expected = (pull / masses(d, trip.vehicle))[:-1]
    moving = (d.speed_mps[:-1] > 0) & (d.speed_mps[1:] > 0)
    assert np.abs(np.diff(d.speed_mps) / STEP_S - expected)[moving].max() < 1e-9


def test_energy_is_balanced(trip: SimulatedTrip) -> None:
    d, road = trip.drive, trip.road
    way, speed = np.diff(d.distance_m), 0.5 * (d.speed_mps[1:] + d.speed_mps[:-1])
    work = np.sum(d.thrust_n[:-1] * way)
    kinetic = np.sum(masses(d, trip.vehicle)[:-1] * speed * np.diff(d.speed_mps))
    pitch = np.interp(0.5 * (d.distance_m[1:] + d.distance_m[:-1]), road.distance_m, road.pitch_rad)
    bend = np.interp(d.distance_m[1:], road.distance_m, road.curvature_v_radpm)
    air = np.sum(0.5 * 1.2 * 0.39 * 1.93 * speed**2 * way)
    roll = np.sum(919 * 0.010 * (9.805 * np.cos(pitch) + bend * speed**2) * way)
    lift = 919 * 9.805 * float(np.diff(np.interp(d.distance_m[[0, -1]], road.distance_m, road.alt_m))[0])
    spent = np.sum(np.maximum(d.thrust_n[:-1], 0.0) * way)
    assert work == pytest.approx(kinetic + air + roll + lift, abs=1e-4 * spent)
    assert air > 0.2 * spent


def test_in_gear_thrust_is_the_engines_power(trip: SimulatedTrip) -> None:
    d = trip.drive
    ratio = np.array([np.nan, 13.25, 9.604, 7.37, 5.796, 4.208, 3.23])[d.gear] / 0.2954
    geared = d.gear > 0
    assert np.abs(d.engine_speed_radps - d.speed_mps * ratio)[geared].max() < 1e-9
    torque = (d.thrust_n / ratio)[geared]
    omega, fuel = d.engine_speed_radps[geared], d.fuel_power_w[geared]
    rpm = omega * 30 / np.pi
    assert np.all(torque <= EngineModel().full_load_nm(rpm) * 1.001)
    propelling = torque * omega > 2000.0
    efficiency = (torque * omega)[propelling] / fuel[propelling]
    known = trip.engine.map_efficiency(rpm, torque * 0.999)[propelling]
    assert np.abs(efficiency - known).max() < 2e-4
    overrun = (torque <= -(5.0 + 0.014 * omega)) & (rpm > 1300.0)
    assert np.mean(overrun) > 0.02
    assert np.all(fuel[overrun] == 0.0)
    assert np.all(fuel[~overrun & (d.t_s[geared] < 3590)] > 0.0)


def test_shifts_open_the_clutch_for_a_moment(trip: SimulatedTrip) -> None:
    d = trip.drive
    changes = np.flatnonzero(np.diff(d.gear))
    opened = changes[:-1][d.gear[changes[:-1] + 1] == 0]
    closed = changes[1:][d.gear[changes[:-1] + 1] == 0]
    before, after = d.gear[opened], d.gear[closed + 1]
    length = (closed - opened) * STEP_S
    rolling = (before > 0) & (after > 0) & (length < 0.7)
    assert np.sum(rolling) > 50
    assert np.all((length[rolling] > 0.28) & (length[rolling] < 0.62))
    for begin, end in zip(opened[rolling], closed[rolling], strict=True):
        assert np.all(d.thrust_n[begin + 1 : end + 1] == 0.0)
    assert {1, -1} <= set((after - before)[rolling].tolist())
    steps = np.abs(np.diff(d.engine_speed_radps)) * 30 / np.pi
    assert steps.max() < 60.0


def test_it_stands_at_both_ends(trip: SimulatedTrip) -> None:
    d = trip.drive
    assert np.all(d.speed_mps[d.t_s < 10.0] == 0)
    assert np.all(d.speed_mps[d.t_s > 3596.0] == 0)
    idling = (d.t_s > 4.0) & (d.t_s < 10.0)
    assert d.engine_speed_radps[idling] * 30 / np.pi == pytest.approx(850.0, abs=1.0)
    off = (d.t_s < 1.5) | (d.t_s >= 3598.0)
    assert np.all(d.fuel_power_w[off] == 0.0)
    assert d.engine_speed_radps[-1] < 1.0


def test_brakes_hold_the_car_on_a_slope(trip: SimulatedTrip) -> None:
    d = trip.drive
    standing = (d.speed_mps == 0) & (d.t_s < 9.0)
    pitch = np.interp(d.distance_m, trip.road.distance_m, trip.road.pitch_rad)
    assert d.thrust_n[standing] == pytest.approx(919 * 9.805 * np.sin(pitch[standing]), rel=1e-9)


@pytest.mark.parametrize("seed", [11, 12, 13])
def test_mixed_hours_cover_the_map(hour: Hour, seed: int) -> None:
    c = hour("mixed", seed).truth
    counted = np.isfinite(c["efficiency"]) & (c["gear"] > 0)
    rpm = c["engine_speed_radps"][counted] * 30 / np.pi
    cells = np.floor(rpm / 50) * 1000 + np.floor(c["torque_nm"][counted] / 2)
    _, count = np.unique(cells, return_counts=True)
    assert np.sum(count >= 10) > 800
    assert np.quantile(rpm, 0.02) < 1800 < 4300 < np.quantile(rpm, 0.98)
    assert c["torque_nm"][counted].max() > 95.0


SPEED_KMPH = {"mixed": (45, 75), "motorway": (85, 110), "town": (18, 32), "full-load": (55, 80), "tunnel": (55, 85)}


@pytest.mark.parametrize("route", get_args(RouteName))
def test_routes_differ(hour: Hour, route: RouteName) -> None:
    trip = hour(route, 2)
    low, high = SPEED_KMPH[route]
    assert low < 3.6 * trip.drive.distance_m[-1] / 3600.0 < high
    assert (len(trip.summary["stops"]) > 30) == (route == "town")
    load = trip.truth["torque_nm"] / trip.engine.full_load_nm(trip.truth["engine_speed_radps"] * 30 / np.pi)
    wide_open = np.mean((load > 0.98) & (trip.truth["gear"] > 0))
    assert (wide_open > 0.1) == (route == "full-load")
    assert 0.025 < trip.summary["fuel_l"] / trip.summary["distance_m"] * 1000 < 0.075


def test_a_heavy_car_without_ratings_gets_up_every_hill() -> None:
    van = replace(DEFAULT_CAR, mass_wet_kg=2400.0, frontal_area_m2=2.8, gear_ratios=(16.0, 10.0, 6.5, 4.5, 3.5))
    rng = np.random.default_rng(1)
    road = build_road("mixed", 1800.0, rng)
    done = drive(road, van, EngineModel.for_vehicle(van), "mixed", 1800.0, rng)
    assert done.distance_m[-1] > 15_000.0
    assert done.speed_mps[-1] == 0.0
    begins, ends = np.flatnonzero(np.diff(np.concatenate([[0], done.speed_mps == 0.0, [0]]))).reshape(-1, 2).T
    assert np.max(ends - begins) * STEP_S < 35.0
