"""What the virtual sensors say, against mechanics and against their own specification."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest

from app.science.vehicle.model import STANDARD_GRAVITY_MPS2, Injection
from app.science.virtualcar import sensors
from app.science.virtualcar.driver import STEP_S
from app.science.virtualcar.simulate import SimulatedTrip
from app.science.virtualcar.specification import RouteName, SensorSettings


@pytest.fixture(scope="module")
def trip(hour: Callable[[RouteName, int], SimulatedTrip]) -> SimulatedTrip:
    return hour("mixed", 1)


def test_specific_force_is_motion_plus_gravity(trip: SimulatedTrip) -> None:
    """A sensor fixed to the car feels v̇ + g sin θ, v ψ̇ and −(g cos θ + v θ̇), whatever pushes the car."""
    d, road = trip.drive, trip.road
    felt = sensors.body_acceleration(d, road, trip.vehicle)[:-1]
    pitch = np.interp(d.distance_m, road.distance_m, road.pitch_rad)
    heading = np.interp(d.distance_m, road.distance_m, road.heading_rad)
    speed = d.speed_mps[:-1]
    smooth = (speed > 1.0) & (d.speed_mps[1:] > 1.0)
    along = np.diff(d.speed_mps) / STEP_S + 9.805 * np.sin(pitch[:-1])
    assert np.abs(felt[:, 0] - along)[smooth].max() < 5e-3
    sideways = felt[:, 1] - speed * np.diff(heading) / STEP_S
    down = felt[:, 2] + 9.805 * np.cos(pitch[:-1]) + speed * np.diff(pitch) / STEP_S
    assert np.quantile(np.abs(sideways[smooth]), 0.999) < 0.1
    assert np.quantile(np.abs(down[smooth]), 0.999) < 0.05
    standing = (speed == 0.0) & (d.speed_mps[1:] == 0.0)
    assert np.abs(np.linalg.norm(felt[standing], axis=1) - 9.805).max() < 1e-6


def test_noise_has_the_stated_spread_and_colour(trip: SimulatedTrip) -> None:
    bias = np.array([0.11, -0.07, 0.16])
    rng = np.random.default_rng(8)
    samples = sensors.accelerometer(trip.drive, trip.road, trip.vehicle, bias, SensorSettings(), rng)
    assert np.all(np.diff(samples.ms) == 25)
    body = samples.counts * 1e-3 * STANDARD_GRAVITY_MPS2 @ trip.vehicle.mounting.matrix.T
    error = body - sensors.body_acceleration(trip.drive, trip.road, trip.vehicle, 5)
    assert error.mean(axis=0) == pytest.approx(bias, abs=0.02)
    speed = trip.drive.speed_mps[::5]
    stated = np.column_stack([0.03 + 0.008 * speed, 0.03 + 0.008 * speed, 0.03 + 0.03 * speed])
    ratio = (error - bias) / stated
    for lowest, highest in ((0.0, 1.0), (5.0, 15.0), (20.0, 40.0)):
        chosen = (speed >= lowest) & (speed < highest)
        assert ratio[chosen].std(axis=0) == pytest.approx(1.0, abs=0.04)
    after_25_ms = np.mean(ratio[1:] * ratio[:-1], axis=0)
    assert after_25_ms == pytest.approx(np.exp(-25 / 35), abs=0.03)


def test_ticks_come_every_so_many_metres(trip: SimulatedTrip) -> None:
    ticks = sensors.wheel_ticks(trip.drive, 0.27) / 8000.0
    distance = np.interp(ticks, trip.drive.t_s, trip.drive.distance_m)
    speed = np.interp(ticks, trip.drive.t_s, trip.drive.speed_mps)
    assert speed.min() > 1.0
    number = np.rint(distance / 0.27)
    late = (number * 0.27 - distance) / speed
    assert late.min() > -1e-6
    assert late.max() < 125e-6 + 1e-6
    assert set(np.diff(number)[speed[1:] > 2.0].tolist()) == {1.0}
    assert 0.99 < len(ticks) * 0.27 / trip.drive.distance_m[-1] < 1.0


def test_pulses_come_once_per_cycle_and_carry_its_fuel(trip: SimulatedTrip) -> None:
    pulses = sensors.injector_pulses(trip.drive, trip.vehicle)
    t = pulses.ms / 1000.0
    angle = np.interp(t, trip.drive.t_s, trip.drive.engine_angle_rad)
    speed = np.interp(t, trip.drive.t_s, trip.drive.engine_speed_radps)
    turns = np.rint(angle / (4 * np.pi))
    late = (turns * 4 * np.pi - angle) / speed
    assert np.quantile(late, [0.001, 0.999]) == pytest.approx([0.0, 0.001], abs=2e-4)
    joules = (pulses.counts * 250e-9 - 0.0004) * 0.0085 * 32e6
    energy = np.interp(t, trip.drive.t_s, trip.drive.fuel_energy_j)
    power = np.interp(t, trip.drive.t_s, trip.drive.fuel_power_w)
    assert np.cumsum(joules) == pytest.approx(energy, abs=1e-3 * power.max() + 20.0)
    assert joules.sum() == pytest.approx(trip.drive.fuel_energy_j[-1], rel=2e-5)
    steady = (np.diff(turns) == 1.0) & (np.abs(np.diff(power)) < 0.01 * power[1:])
    cycle_s = 4 * np.pi / speed[1:]
    ratio = joules[1:][steady] / (power[1:] * cycle_s)[steady]
    assert np.quantile(ratio, [0.001, 0.999]) == pytest.approx([1.0, 1.0], abs=0.03)


def test_no_pulses_in_fuel_cut(trip: SimulatedTrip) -> None:
    t = sensors.injector_pulses(trip.drive, trip.vehicle).ms / 1000.0
    dry = trip.drive.fuel_power_w == 0.0
    edges = np.flatnonzero(np.diff(dry.astype(int)))
    begins, ends = edges[1::2] + 1, edges[2::2]
    long = [(b, e) for b, e in zip(begins, ends, strict=False) if dry[b] and (e - b) * STEP_S > 1.0]
    assert len(long) > 20
    for begin, end in long:
        inside = (t > begin * STEP_S + 0.1) & (t < end * STEP_S)
        assert not np.any(inside)


def test_simultaneous_injection_pulses_once_per_cylinder(trip: SimulatedTrip) -> None:
    car = replace(trip.vehicle, injection=Injection(litres_per_second=0.0085, pattern="simultaneous"))
    pulses = sensors.injector_pulses(trip.drive, car)
    t = pulses.ms[500:900] / 1000.0
    angle = np.interp(t, trip.drive.t_s, trip.drive.engine_angle_rad)
    assert np.median(np.diff(angle)) == pytest.approx(4 * np.pi / 3, abs=0.1)
    joules = (pulses.counts * 250e-9 - 0.0004) * 0.0085 * 32e6
    assert joules.sum() == pytest.approx(trip.drive.fuel_energy_j[-1], rel=1e-4)
