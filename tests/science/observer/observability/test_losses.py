"""The sensor-loss table (Sebesta 2010, 3.1.2.1): what the thesis claims, and where the computation differs."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from app.science.observer.observability.car_system import car_in_gear
from app.science.observer.observability.losses import Loss, SensorTest, Told, losses, sensors_of
from app.science.observer.observability.table import CASES, Case, loss_table, measurements_of, table_text
from app.science.observer.observability.words import words_of
from app.science.observer.states import State
from app.science.vehicle.model import Mounting, Vehicle

ROOT = Path(__file__).resolve().parents[4]
GEARS = (13.25, 9.604, 7.37, 5.796, 4.208, 3.23)
TEST = SensorTest(car_in_gear(Vehicle(gear_ratios=GEARS), 4))
FOUND = {case.name: told for case, told in loss_table(TEST)}
BIASES = {State.BIAS_I, State.BIAS_J, State.BIAS_K}
AT_REST_UNKNOWN = {
    State.THRUST, State.HEADING, State.PITCH, State.CURVATURE_H, State.CURVATURE_V, State.BIAS_I, State.BIAS_K,
}  # fmt: skip


def never(name: str) -> set[State]:
    return {state for state in State if not FOUND[name].changing[state]}


def not_when_steady(name: str) -> set[State]:
    return {state for state in State if FOUND[name].changing[state] and not FOUND[name].steady[state]}


def not_at_rest(name: str) -> set[State]:
    return {state for state in State if not FOUND[name].standing[state]}


def test_with_all_sensors_everything_is_told_on_the_move() -> None:
    assert never("all sensors") == not_when_steady("all sensors") == set()


def test_at_rest_thrust_pitch_and_so_efficiency_are_not_told() -> None:
    assert not_at_rest("all sensors") == AT_REST_UNKNOWN


@pytest.mark.parametrize(
    ("name", "lost"),
    [
        ("no satellites", {State.HEADING, State.NORTH, State.EAST}),
        ("no satellites, no road heights", {State.HEADING, State.NORTH, State.EAST, State.DOWN}),
        ("no road heights", set()),
        ("no accelerometer", BIASES),
        ("two-axis accelerometer", {State.BIAS_K}),
        ("no engine speed", {State.ENGINE_ANGLE, State.ENGINE_SPEED}),
        ("no fuel flow", {State.FUEL_ENERGY, State.FUEL_POWER}),
    ],
)
def test_what_the_thesis_says_is_lost_is_lost(name: str, lost: set[State]) -> None:
    assert never(name) == lost


def test_where_the_thesis_says_no_loss_there_is_one() -> None:
    assert never("no wheel ticks") == {State.DISTANCE}
    assert never("satellites and injectors alone") == {State.DISTANCE} | BIASES
    assert never("no engine speed, but the gear") == {State.ENGINE_ANGLE}
    assert not_when_steady("no satellites") == {State.CURVATURE_H, State.BIAS_J}


def test_without_any_height_the_forward_bias_can_not_be_told_from_the_slope_unless_the_slope_changes() -> None:
    """PAPERS, against 3.1.2.1: F, θ and b_i share what is measured."""
    together = {State.THRUST, State.PITCH, State.BIAS_I}
    for name in ("no satellites, no road heights", "satellites without height, no road heights"):
        assert together <= not_when_steady(name)
    assert not together & not_when_steady("no satellites, no road heights, but a pitch")


def test_another_gear_or_mounting_changes_nothing() -> None:
    for vehicle, gear in ((Vehicle(gear_ratios=GEARS), 1), (Vehicle(mounting=Mounting(0.3, -1.0, 2.0)), 0)):
        rows = loss_table(SensorTest(car_in_gear(vehicle, gear)))
        for case, told in rows:
            if "gear" in case.added and gear == 0:
                continue
            np.testing.assert_array_equal(told.steady, FOUND[case.name].steady)
            np.testing.assert_array_equal(told.changing, FOUND[case.name].changing)
            np.testing.assert_array_equal(told.standing, FOUND[case.name].standing)


def test_the_answer_is_clear_of_rounding() -> None:
    assert min(told.gap for told in FOUND.values()) > 1e8


def test_three_own_axes_tell_what_three_body_axes_tell() -> None:
    car = car_in_gear(Vehicle(mounting=Mounting(0.3, -1.0, 2.0)), 0)
    rest = [name for name in measurements_of(CASES[0]) if not name.startswith("acc")]
    body, own = (
        SensorTest(car).told([*rest, *axes]) for axes in (("acc_i", "acc_j", "acc_k"), ("acc_x", "acc_y", "acc_z"))
    )
    np.testing.assert_array_equal(body.standing, own.standing)
    assert own.steady.all()


def test_nothing_measured_tells_nothing() -> None:
    told = TEST.told([])
    assert not np.concatenate([told.steady, told.changing, told.standing]).any()


def test_the_course_over_ground_goes_with_the_satellites_and_a_compass_does_not() -> None:
    assert sensors_of(["vss", "gps_north", "gps_east", "heading", "standstill"]) == {
        "vss": ("vss",), "gps": ("gps_north", "gps_east", "heading"),
    }  # fmt: skip
    assert sensors_of(["vss", "heading"]) == {"vss": ("vss",), "heading": ("heading",)}


def test_each_sensor_of_a_trip_is_lost_in_turn_and_heights_together() -> None:
    found = losses(TEST, [*measurements_of(CASES[0]), "heading", "standstill", "no such sensor"])
    assert [loss.lost for loss in found] == [
        (), ("vss",), ("acc",), ("gps",), ("dem",), ("fuel",), ("engine",), ("gps", "dem"),
    ]  # fmt: skip
    assert [loss.lost for loss in losses(TEST, ["speed"])] == [()]
    assert not any(loss.told.standing[State.HEADING] for loss in found)
    assert TEST.told(["vss", "heading"]).standing[State.HEADING]
    assert not losses(TEST, ["vss", "engine_torque"])[0].told.standing[State.THRUST]
    words = words_of(found)
    assert words[0] == "With all its sensors, everything is told while the car moves."
    assert words[1] == "Without wheel ticks, distance is no longer told."
    assert words[2] == "Without the accelerometer, the accelerometer's biases are no longer told."
    assert words[3] == (
        "Without satellite positions, heading, north and east are no longer told; the road's bends and the "
        "accelerometer's bias sideways only while speed, direction and slope change."
    )
    assert words[4] == "Without road heights, the others still tell the same, with less certainty."


def test_words_follow_what_is_told() -> None:
    every, none = np.ones(17, bool), np.zeros(17, bool)
    poor = every.copy()
    poor[State.CURVATURE_H] = False
    whole = Loss((), Told(poor, every, none, 1e9))
    assert words_of([whole]) == (
        "With all its sensors, the road's bends are told only while speed, direction and slope change.",
    )
    assert words_of([whole, Loss(("vss",), Told(none, poor, none, 1e9))])[1].startswith(
        "Without wheel ticks, the road's bends are no longer told; distance, speed, "
    )


def test_the_table_of_the_documents_is_the_computed_one() -> None:
    assert table_text(loss_table(TEST)) in (ROOT / "docs" / "observer.md").read_text(encoding="utf-8")


def test_a_case_leaves_what_it_does_not_lose() -> None:
    assert measurements_of(Case("x", ("gps", "acc_k"), ("gear",))) == [
        "vss", "acc_i", "acc_j", "dem_altitude", "engine_angle", "fuel_energy", "gear",
    ]  # fmt: skip
