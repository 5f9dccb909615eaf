"""Operating points of a known drive."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from app.science.engine.operating import operating_points
from app.science.engine.rules import PointRules, settled
from app.science.logger.recording import Recording, Series
from app.science.vehicle.model import Vehicle
from tests.synthetic import RATIOS, drive, table_4_1, with_columns

NOTHING = Recording({})
CAR = Vehicle(gear_ratios=RATIOS)


def test_points_lie_on_the_engine_that_made_the_drive() -> None:
    points = operating_points(drive(), NOTHING, CAR)
    assert len(points) > 1000
    assert points.torque_source == "observer"
    np.testing.assert_allclose(points.efficiency, table_4_1(points.engine_speed_rpm, points.torque_nm), rtol=1e-12)
    np.testing.assert_allclose(points.power_w, points.torque_nm * points.engine_speed_rpm * np.pi / 30, rtol=1e-12)
    assert points.power_w.min() > 2000.0


def test_points_keep_clear_of_gear_changes_and_of_neutral() -> None:
    observation = drive()
    points = operating_points(observation, NOTHING, CAR)
    t, gear = observation.columns["t_s"], observation.columns["gear"]
    changes = t[1:][np.diff(gear) != 0]
    distance = np.abs(points.t_s[:, np.newaxis] - changes).min(axis=1)
    assert distance.min() >= 0.4
    assert np.all(gear[np.searchsorted(t, points.t_s)] >= 1)


def test_without_known_gears_only_the_power_decides() -> None:
    observation = drive()
    unknown = with_columns(observation, gear=np.zeros(len(observation.columns["t_s"])))
    every = operating_points(unknown, NOTHING, CAR)
    assert len(every) == np.isfinite(observation.columns["efficiency"]).sum()
    assert len(operating_points(observation, NOTHING, Vehicle())) == len(every)


def test_deviation_matches_random_errors_of_the_states() -> None:
    observation = drive(seconds=100.0)
    rng = np.random.default_rng(0)
    truth = operating_points(observation, NOTHING, CAR)
    c = observation.columns
    relative = {"thrust_n": 0.05, "speed_mps": 0.004, "fuel_power_w": 0.03}
    told = with_columns(observation, **{f"{k}_sd": np.abs(c[k]) * r for k, r in relative.items()})
    claimed = operating_points(told, NOTHING, CAR).efficiency_sd
    draws = []
    for _ in range(400):
        noisy = {k: c[k] * (1 + r * rng.standard_normal()) for k, r in relative.items()}
        points = operating_points(with_columns(observation, **noisy), NOTHING, CAR)
        draws.append(np.interp(truth.t_s, points.t_s, points.efficiency))
    np.testing.assert_allclose(np.median(np.std(draws, axis=0) / claimed), 1.0, atol=0.1)


@pytest.mark.parametrize("column", ["thrust_n", "fuel_power_w", "engine_speed_radps", "speed_mps"])
def test_a_node_with_an_unknown_state_is_left_out(column: str) -> None:
    observation = drive()
    whole = operating_points(observation, NOTHING, CAR)
    broken = observation.columns[column].copy()
    lost = int(np.searchsorted(observation.columns["t_s"], whole.t_s[500]))
    broken[lost] = np.nan
    points = operating_points(with_columns(observation, **{column: broken}), NOTHING, CAR)
    assert len(points) == len(whole) - 1
    assert whole.t_s[500] not in points.t_s


def test_more_work_than_fuel_is_no_operating_point() -> None:
    observation = drive()
    starved = with_columns(observation, fuel_power_w=observation.columns["power_w"] * 0.99)
    assert len(operating_points(starved, NOTHING, CAR)) == 0


def test_points_far_less_certain_than_the_map_allows_are_left_out() -> None:
    observation = drive()
    whole = operating_points(observation, NOTHING, CAR)
    c = observation.columns
    late = c["t_s"] > 400.0
    unsure = with_columns(observation, thrust_n_sd=np.where(late, 0.3 * np.abs(c["thrust_n"]), c["thrust_n_sd"]))
    points = operating_points(unsure, NOTHING, CAR)
    np.testing.assert_array_equal(points.t_s, whole.t_s[whole.t_s <= 400.0])
    assert points.efficiency_sd.max() <= 0.05


def test_an_observer_that_is_unsure_all_along_still_gives_points() -> None:
    observation = drive()
    unsure = with_columns(observation, thrust_n_sd=0.4 * np.abs(observation.columns["thrust_n"]))
    points = operating_points(unsure, NOTHING, CAR)
    assert len(points) == len(operating_points(observation, NOTHING, CAR))
    assert points.efficiency_sd.min() > 0.05


def ecu_recording(step_s: float) -> Recording:
    """Engine at 100 Nm and a ramp of engine speed, polled one signal after the other; 34 % efficient."""
    t = np.arange(0.0, 100.0, step_s)
    rpm = 2000.0 + 10.0 * t
    at_torque = t + 0.3
    watts = 100.0 * (2000.0 + 10.0 * (t + 0.1)) * np.pi / 30 / 0.34
    return Recording(
        {
            "engine_speed_rpm": Series(t, rpm),
            "fuel_rate_lph": Series(t + 0.1, watts / 32.0e6 * 3600.0),
            "engine_torque_nm": Series(at_torque, np.full(len(t), 100.0)),
        }
    )


def test_reported_torque_is_used_where_there_is_one() -> None:
    observation = with_columns(drive(), gear=np.zeros(len(drive().columns["t_s"])))
    points = operating_points(observation, ecu_recording(1.0), Vehicle())
    assert points.torque_source == "ecu"
    assert len(points) == 99  # the last torque lies after the last engine speed
    np.testing.assert_allclose(points.engine_speed_rpm, 2000.0 + 10.0 * points.t_s, rtol=1e-9)
    np.testing.assert_allclose(points.efficiency, 0.34, rtol=1e-9)


def test_reported_torque_is_not_joined_across_a_gap() -> None:
    observation = drive()
    assert len(operating_points(observation, ecu_recording(7.0), Vehicle())) > 10
    assert len(operating_points(observation, ecu_recording(11.0), Vehicle())) == 0


def test_the_observer_stands_in_for_what_the_bus_does_not_report() -> None:
    observation = drive()
    t = np.arange(60.3, 70.0, 1.0)
    torque = np.interp(t, observation.columns["t_s"], observation.columns["torque_nm"])
    only_torque = Recording({"engine_torque_nm": Series(t, torque)})
    points = operating_points(observation, only_torque, Vehicle())
    expected = operating_points(observation, NOTHING, Vehicle())
    np.testing.assert_allclose(points.efficiency, np.interp(points.t_s, expected.t_s, expected.efficiency), rtol=5e-3)
    assert np.all(points.efficiency_sd > 0)


def test_rounding_is_what_is_known_of_a_bus_signal() -> None:
    recording = ecu_recording(1.0)
    torque = Series(recording["engine_torque_nm"].t_s, 100.0 + 2.5 * (np.arange(100) % 2))
    points = operating_points(
        drive(), Recording({**recording.signals, "engine_torque_nm": torque}), replace(CAR, gear_ratios=())
    )
    rounding = 2.5 / np.sqrt(12.0) / points.torque_nm
    assert np.all(points.efficiency_sd / points.efficiency >= rounding)
    assert np.all(points.efficiency_sd / points.efficiency < rounding * 1.05)


@given(
    st.lists(st.integers(0, 3), min_size=1, max_size=40),
    st.lists(st.floats(-1.0, 11.0), min_size=1, max_size=20),
)
def test_settled_agrees_with_a_slow_reference(gears: list[int], times: list[float]) -> None:
    gear_t = np.arange(len(gears)) * 0.25
    rules = PointRules(settle_s=0.5)
    answer = settled(np.array(times), gear_t, np.array(gears, dtype=np.float64), rules)
    for t, said in zip(times, answer, strict=True):
        past = [g for gt, g in zip(gear_t, gears, strict=True) if gt <= t]
        in_gear = (past[-1] if past else gears[0]) >= 1
        changes = [gear_t[k] for k in range(1, len(gears)) if gears[k] != gears[k - 1]]
        assert bool(said) == (in_gear and all(abs(t - change) >= 0.5 for change in changes))
