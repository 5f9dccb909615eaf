"""The whole observer on virtual drives whose truth is known."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from app.imports.elevation import read_elevation
from app.science.errors import EstimatorDiverged, TooLittleData
from app.science.logger.decode import decode_image
from app.science.logger.recording import Recording, Series, series
from app.science.observer.observe import observe
from app.science.observer.result import Observation
from app.science.observer.states import DERIVED_COLUMNS, STATE_COLUMNS
from app.science.observer.tuning import DEFAULT, THESIS_2010
from app.science.vehicle.xml import read_vehicle
from app.science.virtualcar.simulate import SimulatedTrip, simulate
from app.science.virtualcar.specification import Simulation


class Drive:
    """A simulated trip as the observer gets it: through its image, its XML and its elevation table."""

    def __init__(self, trip: SimulatedTrip) -> None:
        self.truth = trip.truth
        self.recording = decode_image(trip.image).recordings[0]
        self.vehicle = read_vehicle(trip.car_xml)
        self.elevation = read_elevation(trip.elevation_csv)

    def error(self, seen: Observation, column: str, propelling: bool = False) -> tuple[float, float]:
        """Root mean square error of a column, and the share of the truth inside two sigma."""
        t = seen.columns["t_s"]
        true = {name: np.interp(t, self.truth["t_s"], self.truth[name]) for name in (column, "power_w")}
        wanted = (t > 5.0) & (t < t[-1] - 5.0)
        if propelling:
            wanted &= true["power_w"] > 2000.0
        error = (seen.columns[column] - true[column])[wanted]
        inside = np.abs(error) <= 2.0 * seen.columns[f"{column}_sd"][wanted]
        return float(np.sqrt(np.mean(error**2))), float(inside.mean())


@pytest.fixture(scope="module")
def drive() -> Drive:
    return Drive(simulate(Simulation(duration_s=900.0, seed=501)))


@pytest.fixture(scope="module")
def seen(drive: Drive) -> Observation:
    return observe(drive.recording, drive.vehicle, elevation=drive.elevation)


def test_states_follow_the_truth_and_say_how_well(drive: Drive, seen: Observation) -> None:
    for column, limit in (("speed_mps", 0.03), ("pitch_rad", np.radians(0.25)), ("thrust_n", 85.0)):
        rmse, inside = drive.error(seen, column, propelling=column == "thrust_n")
        assert rmse <= limit, column
        assert 0.90 <= inside <= 0.995, column
    assert drive.error(seen, "engine_speed_radps", propelling=True)[0] < 3.0
    assert drive.error(seen, "fuel_power_w", propelling=True)[0] < 1500.0
    assert seen.verdict == "healthy"
    assert seen.distance_m == pytest.approx(float(np.ptp(drive.truth["distance_m"])), rel=1e-3)
    assert seen.fuel_energy_j == pytest.approx(float(np.ptp(drive.truth["fuel_energy_j"])), rel=2e-3)


def test_columns_are_the_contracts(seen: Observation) -> None:
    expected = {"t_s", *STATE_COLUMNS, *(f"{name}_sd" for name in STATE_COLUMNS), *DERIVED_COLUMNS}
    assert set(seen.columns) == expected
    assert {len(column) for column in seen.columns.values()} == {len(seen.columns["t_s"])}
    idle = ~(seen.columns["power_w"] > 2000.0)
    assert np.isnan(seen.columns["efficiency"][idle]).all()


def test_where_the_car_went(drive: Drive, seen: Observation) -> None:
    t = seen.columns["t_s"]
    north = 111.2e3 * (seen.columns["lat_deg"] - np.interp(t, drive.truth["t_s"], drive.truth["lat_deg"]))
    assert np.sqrt(np.mean(north[t > 15.0] ** 2)) < 8.0
    gear = np.interp(t, drive.truth["t_s"], drive.truth["gear"])
    steady = (seen.columns["gear"] > 0) & (gear == np.round(gear)) & (gear > 0)
    assert np.mean(seen.columns["gear"][steady] == gear[steady]) > 0.98


def test_smoothing_beats_filtering(drive: Drive, seen: Observation) -> None:
    filtered = observe(drive.recording, drive.vehicle, elevation=drive.elevation, smooth=False)
    for column in ("speed_mps", "pitch_rad", "thrust_n"):
        assert drive.error(seen, column)[0] < drive.error(filtered, column)[0]


def test_default_beats_the_thesis_values(drive: Drive, seen: Observation) -> None:
    thesis = observe(drive.recording, drive.vehicle, elevation=drive.elevation, tuning=THESIS_2010)
    for column in ("speed_mps", "pitch_rad", "thrust_n"):
        assert drive.error(seen, column)[0] < drive.error(thesis, column)[0]
    assert thesis.tuning == "thesis-2010"
    assert thesis.verdict != "healthy"


@pytest.mark.parametrize(
    ("without", "lost"),
    [("gps", {"lat_deg", "north_m"}), ("inj", {"fuel_power_w", "engine_speed_radps", "efficiency"}),
     ("dem", set()), ("acc", set()), ("vss", set())],
)  # fmt: skip
def test_a_lost_sensor_takes_only_what_it_told(drive: Drive, without: str, lost: set[str]) -> None:
    seen = observe(drive.recording, drive.vehicle, elevation=drive.elevation, without=frozenset({without}))
    for column in lost:
        assert np.isnan(seen.columns[column]).all(), column
    assert drive.error(seen, "speed_mps")[0] < 0.3
    assert drive.error(seen, "thrust_n")[0] < 350.0


def shaken(recording: Recording, change) -> Recording:
    return Recording({name: change(name, s) for name, s in recording.signals.items()})


def test_duplicates_disorder_and_nan_change_nothing(drive: Drive, seen: Observation) -> None:
    def spoil(name: str, s: Series) -> Series:
        rng = np.random.default_rng(len(name))
        order = rng.permutation(len(s))
        t = np.concatenate([s.t_s[order], s.t_s[:50], [np.nan, 3.0]])
        return series(t, np.concatenate([s.value[order], s.value[:50], [1.0, np.nan]]))

    again = observe(shaken(drive.recording, spoil), drive.vehicle, elevation=drive.elevation)
    np.testing.assert_allclose(again.columns["speed_mps"], seen.columns["speed_mps"], atol=1e-9)


def test_a_pause_of_hours_is_bridged_and_not_filtered_through(drive: Drive) -> None:
    def pause(_: str, s: Series) -> Series:
        return series(np.where(s.t_s > 400.0, s.t_s + 4 * 3600.0, s.t_s), s.value)

    late = observe(shaken(drive.recording, pause), drive.vehicle)
    assert len(late.columns["t_s"]) < 25_000
    assert np.isfinite(late.columns["speed_mps"]).all()
    t = late.columns["t_s"]
    tail = t > 4 * 3600.0 + 400.0
    assert tail.any()
    true = np.interp(t[tail] - 4 * 3600.0, drive.truth["t_s"], drive.truth["speed_mps"])
    settled = t[tail] > t[tail][0] + 60.0
    assert np.sqrt(np.mean((late.columns["speed_mps"][tail] - true)[settled] ** 2)) < 0.1


def test_lost_ticks_do_not_shake_the_speed(drive: Drive, seen: Observation) -> None:
    ticks = drive.recording["vss_tick"]
    keep = np.ones(len(ticks), bool)
    keep[5000:5004] = False
    keep[9000] = False
    fewer = Recording({**drive.recording.signals, "vss_tick": Series(ticks.t_s[keep], ticks.value[keep])})
    again = observe(fewer, drive.vehicle, elevation=drive.elevation)
    assert drive.error(again, "speed_mps")[0] < 0.03
    assert again.verdict == "healthy"


def test_a_wild_gps_fix_is_refused(drive: Drive, seen: Observation) -> None:
    lat = drive.recording["lat_deg"]
    value = lat.value.copy()
    value[1000:1004] += 0.02
    jumped = Recording({**drive.recording.signals, "lat_deg": Series(lat.t_s, value)})
    again = observe(jumped, drive.vehicle, elevation=drive.elevation)
    assert np.abs(again.columns["north_m"] - seen.columns["north_m"]).max() < 1.0
    assert next(s for s in again.sensors if s.sensor == "gps_north").rejected >= 4


def test_nothing_that_tells_the_motion_is_said(drive: Drive) -> None:
    only = Recording({"injector_pulse_s": drive.recording["injector_pulse_s"]})
    with pytest.raises(TooLittleData, match="no wheel ticks"):
        observe(only, drive.vehicle)
    pulses = drive.recording["injector_pulse_s"]
    with pytest.raises(TooLittleData, match="send it as data of that battery"):
        observe(Recording({"battery_current_a": pulses, "battery_voltage_v": pulses}), drive.vehicle)
    with pytest.raises(TooLittleData, match="no signal at all"):
        observe(Recording({}), drive.vehicle)
    with pytest.raises(TooLittleData, match="no sensor called 'abs'"):
        observe(drive.recording, drive.vehicle, without=frozenset({"abs"}))


def test_a_filter_that_diverges_says_when(drive: Drive) -> None:
    absurd = replace(DEFAULT, q_thrust=1e300, unsteady_boost=1e10)
    with pytest.raises(EstimatorDiverged) as caught:
        observe(drive.recording, drive.vehicle, tuning=absurd)
    assert 0.0 <= caught.value.t_s < 900.0


def test_lost_pulses_do_not_shake_engine_speed_or_fuel(drive: Drive, seen: Observation) -> None:
    pulses = drive.recording["injector_pulse_s"]
    keep = np.random.default_rng(8).random(len(pulses)) > 0.003
    fewer = Recording({**drive.recording.signals, "injector_pulse_s": Series(pulses.t_s[keep], pulses.value[keep])})
    again = observe(fewer, drive.vehicle, elevation=drive.elevation)
    assert (~keep).sum() > 20
    assert again.verdict == "healthy"
    assert again.fuel_energy_j == pytest.approx(seen.fuel_energy_j, rel=5e-4)
    assert drive.error(again, "engine_speed_radps", propelling=True)[0] < 3.0
    assert drive.error(again, "fuel_power_w", propelling=True)[0] < 1500.0
