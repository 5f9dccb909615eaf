"""The information along a trip, against a slow sum over its events with integrated transition matrices."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from app.imports.elevation import read_elevation
from app.science.logger.decode import decode_image
from app.science.observer import motion_kernels as mk
from app.science.observer.events import MOTION_SENSORS
from app.science.observer.motion import motion_model
from app.science.observer.observability.car_system import TYPICAL
from app.science.observer.observability.gramian import MOTION_STATES, Information, information_along
from app.science.observer.observability.linear import dynamics, measurement_rows
from app.science.observer.observability.report import observability_of
from app.science.observer.observe import observe
from app.science.observer.states import STATE_COLUMNS, State
from app.science.observer.tuning import DEFAULT
from app.science.vehicle.model import Mounting, Vehicle
from app.science.vehicle.xml import read_vehicle
from app.science.virtualcar.simulate import simulate
from app.science.virtualcar.specification import DEFAULT_CAR, Simulation
from tests.science.observer import dense_reference as dense

TRIP = simulate(Simulation(duration_s=185.0, seed=77, vehicle=DEFAULT_CAR))
VEHICLE = read_vehicle(TRIP.car_xml)
SEEN = observe(decode_image(TRIP.image).recordings[0], VEHICLE, elevation=read_elevation(TRIP.elevation_csv))
R = {
    mk.DISTANCE: DEFAULT.r_distance, mk.STANDSTILL: DEFAULT.r_standstill, mk.HEADING: DEFAULT.r_heading,
    mk.NORTH: DEFAULT.r_gps_horizontal, mk.EAST: DEFAULT.r_gps_horizontal, mk.ALTITUDE: DEFAULT.r_gps_vertical,
    mk.ROAD_ALTITUDE: DEFAULT.r_road_altitude,
}  # fmt: skip


def without(name: str, from_s: float, to_s: float):
    """The trip as if a sensor had been silent for a while."""
    seen = SEEN.innovations
    silent = np.array([sensor.startswith(name) for sensor in seen.sensors])[seen.sensor]
    accepted = np.where(silent & (seen.t_s >= from_s) & (seen.t_s < to_s), 0, seen.accepted)
    return replace(SEEN, innovations=replace(seen, accepted=accepted))


def test_many_jacobians_at_once_are_those_one_by_one() -> None:
    vehicle = replace(VEHICLE, mounting=Mounting(0.3, -1.0, 2.0, 1.1))
    model, rng = motion_model(vehicle, DEFAULT), np.random.default_rng(2)
    x = rng.normal(size=(6, 13)) * TYPICAL[MOTION_STATES]
    x[0, mk.V] = 0.02
    mass_a = rng.uniform(900.0, 1100.0, 6)
    a, h = dynamics(x, vehicle, mass_a), measurement_rows(x, vehicle, mass_a)
    for i in range(6):
        np.testing.assert_allclose(a[i], dense.jacobian(x[i], model, mass_a[i]), rtol=1e-10, atol=1e-12)
        for kind in MOTION_SENSORS:
            np.testing.assert_allclose(h[i, kind], dense.row(kind, x[i], model, mass_a[i]), rtol=1e-10, atol=1e-12)


def slow_gramian(from_s: float, to_s: float) -> np.ndarray:
    """Σ Φᵀ Hᵀ R⁻¹ H Φ, event by event at its own time, with Φ integrated by small Euler–Heun steps in between."""
    columns, seen = SEEN.columns, SEEN.innovations
    t = columns["t_s"]
    nodes = np.column_stack([columns[STATE_COLUMNS[state]] for state in MOTION_STATES])
    nodes[:, mk.PSI] = np.unwrap(nodes[:, mk.PSI])
    model = motion_model(VEHICLE, DEFAULT)
    kinds = {name: kind for kind, name in MOTION_SENSORS.items()}
    in_window = (seen.accepted == 1) & (seen.t_s >= from_s - 0.05) & (seen.t_s < to_s - 0.05)
    now, phi, total = from_s, np.eye(13), np.zeros((13, 13))

    def state(at):
        return np.array([np.interp(at, t, nodes[:, i]) for i in range(13)])

    for i in np.flatnonzero(in_window):
        kind = kinds.get(seen.sensors[seen.sensor[i]])
        if kind is None:
            continue
        mass_a = VEHICLE.accelerated_mass_kg(int(columns["gear"][np.argmin(np.abs(t - seen.t_s[i]))]))
        dt = max(seen.t_s[i] - now, 0.0)
        if dt > 0.0:
            a = dt * dense.jacobian(state(now + 0.5 * dt), model, mass_a)
            phi = phi + a @ phi + 0.5 * a @ a @ phi
            now = seen.t_s[i]
        x = state(now)
        row = dense.row(kind, x, model, mass_a) @ phi
        total += np.outer(row, row) / (dense.variance_of(kind, R.get(kind, 1.0), x, model))
    return total


def test_it_is_the_sum_over_the_events() -> None:
    found = information_along(SEEN, VEHICLE, DEFAULT, window_s=20.0)
    assert found.begin_s == pytest.approx(np.arange(9) * 20.0 + SEEN.columns["t_s"][0])
    begin = float(found.begin_s[5])
    gramian = np.zeros((1, 17, 17))
    gramian[np.ix_([0], MOTION_STATES, MOTION_STATES)] = slow_gramian(begin, begin + 20.0)
    expected = Information(found.begin_s[5:6], gramian).sd(TYPICAL)[0][MOTION_STATES]
    np.testing.assert_allclose(found.sd(TYPICAL)[5][MOTION_STATES], expected, rtol=0.05)


def test_fuel_and_engine_follow_from_their_own_pulses() -> None:
    found = information_along(SEEN, VEHICLE, DEFAULT)
    seen = SEEN.innovations
    for level, name, r in (
        (State.FUEL_ENERGY, "fuel_energy", DEFAULT.r_fuel_energy),
        (State.ENGINE_ANGLE, "engine_angle", DEFAULT.r_engine_angle),
    ):
        t = seen.t_s[(seen.sensor == seen.sensors.index(name)) & (seen.accepted == 1)] - found.begin_s[1]
        t = t[(t >= 0.0) & (t < 60.0)]
        block = found.gramian[1, level : level + 2, level : level + 2]
        assert block[0, 0] == pytest.approx(len(t) / r, rel=0.02)
        assert block[0, 1] == block[1, 0] == pytest.approx(t.sum() / r, rel=0.02)
        assert block[1, 1] >= 0.98 * (t**2).sum() / r


def test_the_deviations_are_those_of_prior_and_information_together() -> None:
    rng = np.random.default_rng(3)
    root = rng.normal(size=(2, 17, 17)) / TYPICAL
    gramian = np.swapaxes(root, 1, 2) @ root
    gramian[1] = 0.0
    found = Information(np.zeros(2), gramian).sd(TYPICAL)
    expected = np.sqrt(np.diag(np.linalg.inv(np.diag(TYPICAL**-2.0) + gramian[0])))
    np.testing.assert_allclose(found[0], expected, rtol=1e-8)
    np.testing.assert_allclose(found[1], TYPICAL)


def test_a_rest_shorter_than_half_a_window_goes_with_the_window_before() -> None:
    assert len(information_along(SEEN, VEHICLE, DEFAULT).begin_s) == 3
    assert len(information_along(SEEN, VEHICLE, DEFAULT, window_s=1000.0).begin_s) == 1


def test_minutes_without_satellites_tell_no_place() -> None:
    gap = observability_of(without("gps", 60.0, 120.0), VEHICLE, DEFAULT)
    whole = observability_of(SEEN, VEHICLE, DEFAULT)
    for state in (State.NORTH, State.EAST):
        assert whole.sd[1, state] < 10.0
        assert gap.sd[1, state] > 0.9 * whole.prior_sd[state]
        assert gap.sd[2, state] == pytest.approx(whole.sd[2, state])
        assert gap.told_share[state] == pytest.approx(whole.told_share[state] - 1 / 3)
    assert gap.sensors == whole.sensors == ("vss", "acc", "gps", "dem", "fuel", "engine")
    assert gap.words == whole.words
    assert (whole.sd <= whole.prior_sd * (1 + 1e-9)).all()


def test_less_is_told_by_fewer_sensors() -> None:
    blind = observability_of(without("acc", 0.0, 1e9), VEHICLE, DEFAULT)
    whole = observability_of(SEEN, VEHICLE, DEFAULT)
    assert (blind.sd >= whole.sd * (1 - 1e-6)).all()
    assert "acc" not in blind.sensors
    np.testing.assert_allclose(blind.sd[:, State.BIAS_I], whole.prior_sd[State.BIAS_I])


def test_a_car_of_unknown_gears_and_an_engine_nobody_hears_are_no_obstacle() -> None:
    columns = {**SEEN.columns, "engine_speed_radps": np.full(len(SEEN.columns["t_s"]), np.nan)}
    found = observability_of(replace(SEEN, columns=columns), Vehicle(), DEFAULT)
    assert np.isfinite(found.sd).all()
