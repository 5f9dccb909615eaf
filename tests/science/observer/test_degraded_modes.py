"""What the observer makes of sensors that are missing, late, or more than usual, beside a virtual drive's truth."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from app.cli.bench import modes
from app.cli.bench.modes import MODES, lacking, lacking_axis, with_gyroscope, without_fixes
from app.imports.elevation import read_elevation
from app.science.logger.decode import decode_image
from app.science.logger.recording import ACCELEROMETER, GYROSCOPE, Recording, Series, series
from app.science.observer import motion_kernels as motion
from app.science.observer.body_axes import body_acceleration, gyroscope_bias, yaw_rate
from app.science.observer.events import motion_events
from app.science.observer.motion import motion_model
from app.science.observer.observe import observe
from app.science.observer.receiver_speed import in_time, lateness_s, standing
from app.science.observer.timeline import build_timeline
from app.science.observer.tuning import DEFAULT
from app.science.vehicle.model import Mounting
from app.science.vehicle.xml import read_vehicle
from app.science.virtualcar.simulate import simulate
from app.science.virtualcar.specification import Simulation

TRIP = simulate(Simulation(duration_s=600.0, seed=611))
RECORDING = decode_image(TRIP.image).recordings[0]
VEHICLE = read_vehicle(TRIP.car_xml)
ELEVATION = read_elevation(TRIP.elevation_csv)
FULL = {"speed_mps": 0.01, "pitch_rad": np.radians(0.25), "thrust_n": 85.0}
LOOSER = {
    "no GPS": {"pitch_rad": np.radians(1.0), "thrust_n": 160.0},
    "no accelerometer": {"speed_mps": 0.06, "thrust_n": 150.0},
    "no Vss": {"speed_mps": 0.06, "thrust_n": 120.0},
    "no Vss, no elevation": {"speed_mps": 0.06, "thrust_n": 120.0},
    **{f"accelerometer without {name[1]}": {"thrust_n": 130.0, "speed_mps": 0.02} for name in ACCELEROMETER},
}


def true(column: str, t: np.ndarray) -> np.ndarray:
    return np.interp(t, TRIP.truth["t_s"], TRIP.truth[column])


@pytest.mark.parametrize("name", MODES)
def test_every_mode_stays_near_the_truth_and_knows_how_near(name: str) -> None:
    seen = observe(MODES[name](RECORDING, TRIP), VEHICLE, elevation=None if "no elevation" in name else ELEVATION)
    t = seen.columns["t_s"]
    settled = (t > 5.0) & (t < t[-1] - 5.0)
    for column, limit in (FULL | LOOSER.get(name, {})).items():
        counted = settled & (true("power_w", t) > 2000.0) if column == "thrust_n" else settled
        error = (seen.columns[column] - true(column, t))[counted]
        assert np.sqrt(np.mean(error**2)) < limit, column
        assert np.mean(np.abs(error) <= 2.0 * seen.columns[f"{column}_sd"][counted]) > 0.85, column
    if name == "no GPS":
        assert seen.verdict == "doubtful"
        assert "slope of the road is known to ±" in seen.reasons[0]
    else:
        assert seen.verdict == "healthy", seen.reasons


@pytest.mark.parametrize("more", [False, True], ids=["accelerometer", "gyroscope"])
def test_a_car_from_a_garage_finds_where_it_came_from(more: bool) -> None:
    late = without_fixes(-np.inf, 200.0, with_gyroscope(RECORDING, TRIP) if more else RECORDING)
    seen = observe(late, VEHICLE, elevation=ELEVATION)
    t = seen.columns["t_s"]
    blind = t < 200.0
    heading = np.angle(np.exp(1j * (seen.columns["heading_rad"] - true("heading_rad", t))))[blind]
    assert np.abs(heading).max() < 0.2
    assert np.mean(np.abs(heading) <= 2.0 * seen.columns["heading_rad_sd"][blind]) > 0.9
    north = 111.2e3 * (seen.columns["lat_deg"] - true("lat_deg", t))[blind]
    assert np.abs(north).max() < 150.0
    assert np.mean(np.abs(north) <= 2.0 * seen.columns["north_m_sd"][blind]) > 0.85


@pytest.mark.parametrize("axis", range(3))
def test_a_missing_axis_takes_away_exactly_what_it_told(axis: int) -> None:
    """With a sensor along the body's axes, that is the body axis itself; the others are measured as ever."""
    acceleration = body_acceleration(RECORDING, VEHICLE)
    assert acceleration is not None
    t, body = acceleration
    upright = Recording({**RECORDING.signals, **{n: Series(t, body[:, k]) for k, n in enumerate(ACCELEROMETER)}})
    vehicle = replace(VEHICLE, mounting=Mounting())
    timeline = build_timeline(upright, vehicle)

    def told(recording: Recording, lost: int) -> list[tuple[float, float]]:
        events = motion_events(recording, vehicle, timeline, DEFAULT, None, None)
        kind = np.where(events.kind >= motion.ACC_X, events.kind - motion.ACC_X + motion.ACC_I, events.kind)
        kept = (kind >= motion.ACC_I) & (kind <= motion.ACC_K) & (kind != lost)
        return sorted(zip(events.t_s[kept], kind[kept], events.y[kept], strict=True))

    assert told(lacking_axis(ACCELEROMETER[axis])(upright, TRIP), -1) == told(upright, motion.ACC_I + axis)
    x = np.array([0.0, 20.0, 500.0, 0.7, 0.03, 0.0, 0.0, 0.0, 0.01, 0.001, 0.1, -0.1, 0.2])
    model, rows = motion_model(vehicle, DEFAULT), []
    for kind in (motion.ACC_I + axis, motion.ACC_X + axis):
        index, slope, row = np.zeros(motion.ROW, np.int64), np.zeros(motion.ROW), np.zeros(motion.SIZE)
        predicted, count = motion.measure(kind, x, model, 950.0, index, slope)
        np.add.at(row, index[:count], slope[:count])
        rows.append(np.append(row, [predicted, motion.noise_variance(kind, 1.0, x, model)]))
    np.testing.assert_allclose(rows[0], rows[1], rtol=1e-12, atol=1e-12)


def test_a_receiver_that_comes_late_is_moved_back_where_it_tells_the_speed() -> None:
    alone = lacking("vss")(RECORDING, TRIP)
    assert lateness_s(alone, VEHICLE) == pytest.approx(0.05, abs=0.015)
    later = Recording(
        {k: Series(s.t_s + 0.2, s.value) if k == "gnss_speed_mps" else s for k, s in alone.signals.items()}
    )
    assert lateness_s(later, VEHICLE) == pytest.approx(0.25, abs=0.015)
    moved = in_time(alone, VEHICLE)
    shift = alone["lat_deg"].t_s - moved["lat_deg"].t_s
    np.testing.assert_allclose(shift, lateness_s(alone, VEHICLE))
    assert in_time(RECORDING, VEHICLE) is RECORDING
    blind = lacking("acc")(alone, TRIP)
    assert in_time(blind, VEHICLE) is blind


def test_a_receivers_noise_at_standstill_is_no_speed() -> None:
    speed = RECORDING["gnss_speed_mps"]
    stood = standing(speed.t_s, speed)
    truly = np.interp(speed.t_s, TRIP.truth["t_s"], TRIP.truth["speed_mps"])
    assert stood.sum() > 50
    assert truly[stood].max() < 0.2


def test_gyroscope_bias_from_standstill_from_the_course_and_from_nothing() -> None:
    given = with_gyroscope(RECORDING, TRIP)
    expected = (VEHICLE.mounting.matrix / VEHICLE.mounting.scale @ np.array(modes.GYROSCOPE_BIAS_RADPS))[2]
    rate = yaw_rate(given, VEHICLE)
    assert rate is not None
    course = given["heading_deg"]
    speed = true("speed_mps", course.t_s)
    still = true("speed_mps", rate.t_s) == 0.0
    assert gyroscope_bias(rate, still, course, speed) == pytest.approx(expected, abs=5e-4)
    assert gyroscope_bias(rate, np.zeros_like(still), course, speed) == pytest.approx(expected, abs=1e-3)
    assert gyroscope_bias(rate, np.zeros_like(still), None, None) == 0.0


def test_a_gyroscope_needs_only_the_axes_that_stand_upright() -> None:
    t = np.linspace(0.0, 10.0, 101)
    vehicle = replace(VEHICLE, mounting=Mounting(0.1, -0.1, 1.0))
    down = vehicle.mounting.matrix[2]
    axes = {name: series(t, 0.2 * down[k] * np.ones(101)) for k, name in enumerate(GYROSCOPE)}
    for present in (GYROSCOPE, ("gz_radps",)):
        rate = yaw_rate(Recording({name: axes[name] for name in present}), vehicle)
        assert rate is not None
        np.testing.assert_allclose(rate.value, 0.2)
    assert yaw_rate(Recording({"gx_radps": axes["gx_radps"]}), vehicle) is None


def test_a_compass_tells_the_heading_without_positions() -> None:
    seen = observe(MODES["no GPS, with compass and level"](RECORDING, TRIP), VEHICLE)
    t = seen.columns["t_s"]
    error = np.angle(np.exp(1j * (seen.columns["heading_rad"] - true("heading_rad", t))))
    assert np.sqrt(np.mean(error**2)) < 0.03
    assert np.isnan(seen.columns["north_m"]).all()
    blind = observe(lacking("gps")(RECORDING, TRIP), VEHICLE)
    assert np.isnan(blind.columns["heading_rad"]).all()
