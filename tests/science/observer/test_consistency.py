"""Whiteness, bands, refusals and the verdict, against known sequences and drives with a known fault."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from scipy.signal import lfilter

from app.imports.elevation import read_elevation
from app.science.logger.decode import decode_image
from app.science.logger.recording import Recording, Series
from app.science.observer.consistency import consistency, nis_band, refusals
from app.science.observer.events import MOTION_SENSORS
from app.science.observer.observe import observe
from app.science.observer.result import Innovations, SensorConsistency
from app.science.observer.sensor_words import WORDS
from app.science.observer.verdict import verdict_of
from app.science.observer.wheel_scale import WheelScale
from app.science.observer.whiteness import whiteness
from app.science.vehicle.xml import read_vehicle
from app.science.virtualcar.simulate import simulate
from app.science.virtualcar.specification import Simulation

TRIP = simulate(Simulation(duration_s=600.0, seed=621))
RECORDING = decode_image(TRIP.image).recordings[0]
VEHICLE = read_vehicle(TRIP.car_xml)
ELEVATION = read_elevation(TRIP.elevation_csv)
COLUMNS = {name: np.ones(3) for name in ("speed_mps", "gear", "power_w", "fuel_power_w", "efficiency", "pitch_rad_sd")}


def coloured(rho: float, n: int, seed: int = 5) -> np.ndarray:
    white = np.random.default_rng(seed).standard_normal(n)
    return np.asarray(lfilter([np.sqrt(1.0 - rho**2)], [1.0, -rho], white))


def test_white_noise_is_white() -> None:
    told = [whiteness(np.random.default_rng(seed).standard_normal(4000)) for seed in range(40)]
    assert np.mean([abs(one.lag1) < 2.0 / np.sqrt(4000) for one in told]) > 0.85
    assert np.mean([one.portmanteau for one in told]) == pytest.approx(1.0, abs=0.15)
    assert np.median([one.independent for one in told]) == pytest.approx(4000, rel=0.05)


@pytest.mark.parametrize("rho", [0.5, 0.9, 0.98])
def test_a_markov_sequence_is_worth_as_many_samples_as_theory_says(rho: float) -> None:
    told = whiteness(coloured(rho, 200_000))
    assert told.lag1 == pytest.approx(rho, abs=0.02)
    assert told.independent == pytest.approx(200_000 * (1 - rho) / (1 + rho), rel=0.2)
    assert told.independent_squares == pytest.approx(200_000 * (1 - rho**2) / (1 + rho**2), rel=0.2)
    assert told.portmanteau > 1000.0


def test_too_few_innovations_say_nothing() -> None:
    assert np.isnan(whiteness(np.arange(5.0)).lag1)
    assert whiteness(np.zeros(0)).independent == 0.0
    assert np.isnan(whiteness(np.ones(100)).portmanteau)


def test_mean_squares_of_right_filters_lie_in_the_band_as_often_as_it_claims() -> None:
    inside = []
    for seed in range(300):
        values = coloured(0.6, 1500, seed)
        low, high = nis_band(whiteness(values).independent_squares)
        inside.append(low <= np.mean(values**2) <= high)
    assert 0.89 <= np.mean(inside) <= 0.99


def test_refusals_become_episodes_in_the_sensors_own_order() -> None:
    accepted = np.array([1, 0, 0, 2, 1, 1, 0, 1, 1, 0])
    t = np.array([0.0, 5.0, 10.0, 15.0, 20.0, 25.0, 30.0, 30.4, 30.8, 30.9])
    first, last = refusals(t, accepted)
    assert (first.from_s, first.to_s, first.count, first.recovered) == (5.0, 15.0, 3, True)
    assert (last.from_s, last.to_s, last.count, last.recovered) == (30.0, 30.9, 2, False)
    assert refusals(t, np.ones(10)) == ()
    sensor = np.zeros(20, int)
    sensor[10:] = 1
    both = consistency(
        Innovations(
            np.tile(t, 2), sensor, np.ones(20), np.ones(20), np.concatenate((accepted, np.ones(10))), ("a", "b")
        )
    )
    assert [(one.count, one.rejected, one.recovered, one.episode_count) for one in both] == [
        (10, 5, 1, 2),
        (10, 0, 0, 0),
    ]
    assert both[0].longest_refusal_s == 10.0


def test_a_lasting_direction_is_named_and_a_slight_one_is_not() -> None:
    sensor = SensorConsistency("engine_torque", 500, 0, 1.4, 0.93, bias=0.7, bias_sd=0.05)
    verdict, reasons = verdict_of((sensor,), COLUMNS)
    assert verdict == "doubtful"
    assert "Engine torque, reported: the measurements lie above the prediction throughout, by 0.7" in reasons[0]
    for harmless in (replace(sensor, bias=0.4), replace(sensor, bias_sd=0.2)):
        assert verdict_of((harmless,), COLUMNS)[0] == "healthy"
    assert verdict_of((replace(sensor, bias=-2.5),), COLUMNS)[0] == "failed"


def test_wheels_are_blamed_only_beyond_doubt() -> None:
    assert verdict_of((), COLUMNS, WheelScale(1.009, 0.0001))[0] == "healthy"
    assert verdict_of((), COLUMNS, WheelScale(1.03, 0.01))[0] == "healthy"
    assert verdict_of((), COLUMNS, WheelScale(0.8, 0.001))[0] == "failed"


@pytest.mark.parametrize(("factor", "said"), [(1.0, None), (1.03, "less far"), (0.98, "farther")])
def test_a_wrong_wheel_scale_is_the_reason_of_the_verdict(factor: float, said: str | None) -> None:
    seen = observe(RECORDING, replace(VEHICLE, vss_m_per_tick=factor * VEHICLE.vss_m_per_tick), elevation=ELEVATION)
    if said is None:
        assert seen.verdict == "healthy"
        return
    assert seen.verdict == "doubtful"
    assert said in seen.reasons[0]
    assert "metres per tick" in seen.reasons[0]
    told = float(seen.reasons[0].split("move ")[1].split("%")[0]) / 100.0
    assert told == pytest.approx(abs(1.0 / factor - 1.0), abs=0.004)


def test_a_receiver_that_jumps_for_a_while_shows_as_an_episode_and_recovers() -> None:
    lat = RECORDING["lat_deg"]
    value = lat.value.copy()
    value[(lat.t_s > 300.0) & (lat.t_s < 330.0)] += 0.02
    seen = observe(Recording({**RECORDING.signals, "lat_deg": Series(lat.t_s, value)}), VEHICLE, elevation=ELEVATION)
    north = next(one for one in seen.sensors if one.sensor == "gps_north")
    assert north.recovered > 0
    assert 300.0 <= north.episodes[0].from_s < 300.5
    assert north.episodes[0].recovered
    assert north.longest_refusal_s > 2.0


def test_every_sensor_has_words() -> None:
    assert {*MOTION_SENSORS.values(), "fuel_energy", "fuel_power", "engine_angle", "engine_speed"} == set(WORDS)
