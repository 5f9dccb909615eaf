"""From windows to words, with trips of which it is known what was off."""

from __future__ import annotations

import json
from dataclasses import replace

import numpy as np
import pytest

from app.science.health.assess import TripLoad, assess
from app.science.health.baseline import BASELINE_TRIPS, alone, learn_baseline
from app.science.health.evidence import trip_design
from app.science.health.result import CarHealth
from app.science.health.usual import QUANTITIES
from tests.science.health.made_up import CAR, Truth, made_up_windows

HEALTHY = Truth()
SOFT_TYRE = Truth(rolling_resistance=20.0)
LOADED = Truth(mass=150.0)
ROOF_BOX = Truth(drag=25.0)
WEAK_ENGINE = Truth(efficiency=-6.0)


def drives(*truths: Truth, since: int = 0) -> list[TripLoad]:
    """Half-hour trips, a day apart."""
    numbers = range(since, since + len(truths))
    return [
        TripLoad(f"t{n}", f"trip {n}", 86400.0 * n, made_up_windows(n, truth))
        for n, truth in zip(numbers, truths, strict=True)
    ]


BASELINE = drives(*[HEALTHY] * BASELINE_TRIPS)


def after_baseline(*truths: Truth) -> CarHealth:
    return assess([*BASELINE, *drives(*truths, since=BASELINE_TRIPS)], CAR)


@pytest.mark.parametrize(
    ("truth", "quantity", "change", "within", "says"),
    [
        (SOFT_TYRE, "rolling_resistance", 20.0, 4.0, "tyre pressures"),
        (LOADED, "mass", 150.0, 15.0, "carried"),
        (ROOF_BOX, "drag", 25.0, 3.0, "roof box"),
        (WEAK_ENGINE, "efficiency", -6.0, 0.5, "injectors"),
        (Truth(efficiency=6.0), "efficiency", 6.0, 0.5, "pump"),
    ],
)
def test_each_cause_is_named_and_measured(truth: Truth, quantity: str, change: float, within: float, says: str) -> None:
    health = after_baseline(HEALTHY, HEALTHY, *[truth] * 4)
    (alert,) = health.open_alerts
    assert (alert.quantity, alert.since_trip_id, alert.trips, alert.other) == (quantity, "t12", 4, "")
    assert alert.change == pytest.approx(change, abs=within)
    assert abs(alert.change - change) < 2.5 * alert.change_sd
    assert says in alert.advice
    assert alert.words.endswith("its usual, since 4 trips")
    assert health.words == f"{alert.words}."


def test_healthy_trips_are_as_usual() -> None:
    health = after_baseline(*[HEALTHY] * 12)
    assert health.alerts == ()
    assert health.words == "All as usual, 12 trips watched."
    assert [trip.role for trip in health.trips] == ["baseline"] * 10 + ["watched"] * 12
    off = np.array([[one.change / one.sd for one in trip.changes] for trip in health.trips])
    assert float(np.mean(np.abs(off) < 2.0)) > 0.93
    for trend in health.trends:
        assert trend.trip_ids == tuple(trip.trip_id for trip in health.trips)
        assert trend.words.startswith("As usual: ")
        assert 0.0 < trend.usual_sd < trend.band


def test_what_is_known_to_be_off_is_taken_out_of_the_rest() -> None:
    """By itself a weak engine's trip looks like 60 kg of load as well."""
    health = after_baseline(*[WEAK_ENGINE] * 5)
    mass, efficiency = (next(one for one in health.trends if one.quantity == name) for name in ("mass", "efficiency"))
    assert np.abs(mass.estimate[-5:]).max() < 30.0
    assert mass.words.startswith("As usual: ")
    assert efficiency.words.endswith("below its usual, since 5 trips.")


def test_a_wrong_car_file_costs_no_sharpness() -> None:
    """The file has 30 % too much C_rr and 30 % too little drag; 20 % more of the true C_rr is 15 % of the file's."""
    file = replace(CAR, cd=0.7 * CAR.cd, crr=1.3 * CAR.crr)
    health = assess([*BASELINE, *drives(*[SOFT_TYRE] * 4, since=10)], file)
    (alert,) = health.alerts
    assert alert.quantity == "rolling_resistance"
    assert alert.change == pytest.approx(20.0 / 1.3, abs=3.0)


def test_an_alert_ends_with_its_cause() -> None:
    health = after_baseline(*[LOADED] * 3, *[HEALTHY] * 3)
    (alert,) = health.alerts
    assert (alert.since_trip_id, alert.last_trip_id, alert.is_open) == ("t10", "t12", False)
    assert alert.cleared_trip_id in ("t13", "t14")
    assert alert.words.endswith("above its usual for 3 trips, and is back")
    assert health.words == "All as usual, 6 trips watched."
    (mass,) = (one for one in health.trends if one.quantity == "mass")
    assert mass.change_points == ("t10", alert.cleared_trip_id)


def test_too_few_trips_say_how_many_are_missing() -> None:
    health = assess(BASELINE[:4], CAR)
    assert (health.trends, health.alerts) == ((), ())
    assert health.reason == "10 trips that agree say what is usual for a car; there are 4 so far. Upload 6 more."
    assert assess([], CAR).reason.endswith("Upload 10 more.")


def test_short_trips_and_trips_without_fuel_do_not_count() -> None:
    short = replace(BASELINE[0], windows=made_up_windows(0, count=40))
    dark = replace(BASELINE[1], windows=replace(BASELINE[1].windows, fuel_power_w=np.full(500, np.nan)))
    health = assess([short, dark, *BASELINE[2:]], CAR)
    assert [trip.role for trip in health.trips[:3]] == ["left_out", "left_out", "baseline"]
    assert "1.3 min" in health.trips[0].reason
    assert health.baseline_trips == 8


def test_trips_of_another_car_file_wait_to_be_run_again() -> None:
    health = assess([replace(BASELINE[0], config="old"), *BASELINE[1:]], CAR)
    assert "run it again" in health.trips[0].reason


def test_a_new_usual_ends_what_was_unusual() -> None:
    trips = [*BASELINE, *drives(*[SOFT_TYRE] * 13, since=10)]
    assert len(assess(trips, CAR).open_alerts) == 1
    health = assess(trips, CAR, usual_since=86400.0 * 10)
    assert health.alerts == ()
    assert [trip.role for trip in health.trips] == ["before"] * 10 + ["baseline"] * 10 + ["watched"] * 3
    assert all(trip.changes for trip in health.trips)


def test_a_loaded_trip_does_not_blunt_the_usual() -> None:
    """The one odd trip among the first ten is passed over, and 150 kg later are seen as well as ever."""
    loaded = replace(BASELINE[4], windows=made_up_windows(4, Truth(mass=400.0)))
    health = assess([*BASELINE[:4], loaded, *BASELINE[5:], *drives(HEALTHY, *[LOADED] * 3, since=10)], CAR)
    assert health.trips[4].role == "left_out"
    assert "differs" in health.trips[4].reason
    assert health.trips[10].role == "baseline"
    assert [(alert.quantity, alert.since_trip_id) for alert in health.alerts] == [("mass", "t11")]


def test_a_trip_where_nothing_is_known_is_left_out() -> None:
    fast = replace(BASELINE[0].windows, engine_speed_radps=BASELINE[0].windows.engine_speed_radps + 400.0)
    health = assess([*BASELINE, TripLoad("t10", "trip 10", None, fast), *drives(HEALTHY, since=11)], CAR)
    assert [trip.role for trip in health.trips[-2:]] == ["left_out", "watched"]
    assert "other engine speeds" in health.trips[-2].reason


def test_trips_that_have_nothing_in_common_say_nothing_usual() -> None:
    """Ten trips, each at an engine speed of its own."""
    steady = [
        replace(trip, windows=replace(trip.windows, engine_speed_radps=np.full(500, 150.0 + 45.0 * number)))
        for number, trip in enumerate(BASELINE)
    ]
    assert assess(steady, CAR).reason


def test_sds_are_honest() -> None:
    """Over 60 made-up trips the scatter of each quantity's normalised change is about one or less."""
    designs = [trip_design(trip.windows, CAR.drag_area_kgpm, CAR.crr) for trip in BASELINE]
    baseline = learn_baseline(designs, CAR.drag_area_kgpm, CAR.crr)
    assert baseline is not None
    off = []
    for seed in range(100, 160):
        seen = alone(trip_design(made_up_windows(seed), CAR.drag_area_kgpm, CAR.crr), baseline.usual)
        off.append(seen.change / seen.scatter_sd)
    scatter = np.sqrt(np.mean(np.square(off), axis=0))
    assert dict(zip(QUANTITIES, scatter < 1.25, strict=True)) == dict.fromkeys(QUANTITIES, True)


def test_the_assessment_survives_json() -> None:
    health = after_baseline(*[LOADED] * 3)
    assert CarHealth.from_dict(json.loads(json.dumps(health.to_dict(), allow_nan=False))) == health
