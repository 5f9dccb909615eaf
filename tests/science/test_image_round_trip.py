"""The virtual car writes an image, the decoder reads it; they share no code, and the truth is known."""

from __future__ import annotations

import numpy as np
import pytest

from app.science.logger.decode import decode_image
from app.science.logger.recording import Recording
from app.science.virtualcar.simulate import SimulatedTrip, simulate
from app.science.virtualcar.specification import ImageSettings, SensorSettings, Simulation

WALKING_MPS = 1.1
LATENCY_S = SensorSettings().gps_latency_s
METRES_PER_DEGREE = 111_200.0

IMAGES = {
    "as the thesis has it": ImageSettings(),
    "most significant byte first": ImageSettings(big_endian=True),
    "clock about to run over": ImageSettings(clock_start_ms=2**32 - 60_000),
    "text in crumbs": ImageSettings(gps_packet_bytes=7, skew_every_s=2.0, error_every_s=10.0),
    "text in the longest packets": ImageSettings(gps_packet_bytes=254, zero_padding_bytes=0),
}


@pytest.fixture(scope="module", params=IMAGES)
def trip(request: pytest.FixtureRequest) -> SimulatedTrip:
    return simulate(Simulation(duration_s=240.0, seed=11, image=IMAGES[request.param]))


@pytest.fixture(scope="module")
def recording(trip: SimulatedTrip) -> Recording:
    (only,) = decode_image(trip.image).recordings
    return only


def test_the_whole_image_is_packets_and_zeros(trip: SimulatedTrip) -> None:
    report = decode_image(trip.image).report
    settings = trip.summary["image"]
    assert report.packet_bytes == trip.packet_bytes
    assert report.zero_tail_bytes == settings["zero_padding_bytes"]
    assert report.byte_order == ("big" if settings["big_endian"] else "little")
    assert report.clock.wraps == (settings["clock_start_ms"] > 0)
    assert report.trips[0].clock_origin_ms == settings["clock_start_ms"]
    assert report.packets["accelerometer"] == 240 * 40 + 1
    assert report.packets["error"] == len(report.error_messages)
    assert report.packets["skew"] == report.skew.count
    assert (report.resyncs, report.gaps, report.clock.jumps_rejected, report.clock.restarts) == ((), (), 0, 0)
    assert (report.nmea.bad_checksum, report.nmea.malformed) == (0, 0)
    assert 240 * 5 - 1 <= report.nmea.sentences["GGA"] <= 240 * 5


def test_every_tick_stands_at_its_distance(trip: SimulatedTrip, recording: Recording) -> None:
    t_s, distance_m = trip.truth["t_s"], trip.truth["distance_m"]
    metres_per_tick = trip.vehicle.vss_m_per_tick
    ticks = recording["vss_tick"]
    number = np.interp(ticks.t_s, t_s, distance_m) / metres_per_tick
    np.testing.assert_allclose(number, np.rint(number), atol=0.03)
    written = np.rint(number).astype(int)
    assert len(np.unique(written)) == len(written)
    every = np.arange(1, int(distance_m[-1] / metres_per_tick) + 1)
    missing = np.setdiff1d(every, written)
    speed_there = np.interp(missing * metres_per_tick, distance_m, trip.truth["speed_mps"])
    assert np.all(speed_there < WALKING_MPS + 0.2)


def test_the_pulses_are_the_fuel(trip: SimulatedTrip, recording: Recording) -> None:
    pulses, injection = recording["injector_pulse_s"], trip.vehicle.injection
    energy_j = trip.vehicle.fuel_energy_of_pulse_j(pulses.value).cumsum()
    truth_j = np.interp(pulses.t_s, trip.truth["t_s"], trip.truth["fuel_energy_j"])
    assert injection.lag_s < 0
    np.testing.assert_allclose(energy_j, truth_j, atol=1500.0)  # the truth is known every 50 ms only
    assert np.median(np.abs(energy_j - truth_j)) < 50.0  # pulses are stamped in whole milliseconds
    assert energy_j[-1] == pytest.approx(trip.summary["fuel_energy_j"], rel=1e-3)


def test_every_sample_of_the_accelerometer_is_there(trip: SimulatedTrip, recording: Recording) -> None:
    axes = [recording[name] for name in ("ax_mps2", "ay_mps2", "az_mps2")]
    np.testing.assert_allclose(axes[0].t_s, np.arange(240 * 40 + 1) * 0.025, atol=1e-9)
    body = trip.vehicle.mounting.matrix @ np.array([axis.value for axis in axes])
    bias = trip.summary["bias_mps2"]
    standing = trip.truth["speed_mps"][
        np.searchsorted(trip.truth["t_s"], axes[0].t_s).clip(0, len(trip.truth["t_s"]) - 1)
    ]
    still = body[:, standing == 0.0].mean(axis=1)
    assert still[1] == pytest.approx(bias["j"], abs=0.03)
    assert still[2] == pytest.approx(-9.805 + bias["k"], abs=0.06)


def test_fixes_are_late_by_the_receivers_own_latency_only(trip: SimulatedTrip, recording: Recording) -> None:
    utc = recording["utc_s"]
    latency = utc.t_s - (utc.value - trip.summary["started_at_utc_s"])
    assert latency.min() > LATENCY_S - 0.001
    assert latency.max() < LATENCY_S + 0.03
    assert np.ptp(latency) < 0.02
    assert recording.started_at_utc_s == pytest.approx(trip.summary["started_at_utc_s"] - LATENCY_S, abs=0.03)


def test_positions_are_where_the_car_was(trip: SimulatedTrip, recording: Recording) -> None:
    lat, lon = recording["lat_deg"], recording["lon_deg"]
    then_s = lat.t_s - LATENCY_S
    north = (lat.value - np.interp(then_s, trip.truth["t_s"], trip.truth["lat_deg"])) * METRES_PER_DEGREE
    east = (lon.value - np.interp(then_s, trip.truth["t_s"], trip.truth["lon_deg"])) * METRES_PER_DEGREE
    east *= np.cos(np.radians(lat.value))
    assert np.abs(north).max() < 12.0
    assert np.abs(east).max() < 12.0
    up = recording["alt_m"].value - np.interp(then_s, trip.truth["t_s"], trip.truth["alt_m"])
    assert np.abs(up).max() < 25.0
    np.testing.assert_allclose(
        recording["gnss_speed_mps"].value, np.interp(then_s, trip.truth["t_s"], trip.truth["speed_mps"]), atol=0.8
    )
