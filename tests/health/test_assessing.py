"""The health stage: assessed once per question, told once per alert, and never at the cost of a trip."""

from __future__ import annotations

from typing import Any

import pytest

from app.accounts.models import DEFAULT_FLEET_ID as FLEET
from app.cars import service as cars
from app.health import assessing, service, view
from app.health.models import Alert
from app.health.schemas import HealthDocument, NewUsual
from app.trips import service as trips
from app.trips.keys import ROAD_LOAD, result_file
from app.trips.models import Trip
from app.trips.schemas import TripChange
from tests.health.conftest import FIRST, Garage

WORDS = "Rolling resistance 20 % above its usual, since {} trips"


def health(garage: Garage) -> HealthDocument:
    with garage.resources.database.transaction(FLEET, read_only=True) as session:
        return view.health(session, garage.car_id)


def change(garage: Garage, trip_id: str, **wanted: Any) -> None:
    garage.write(lambda session: trips.change(session, trip_id, TripChange(**wanted)) and None)


def test_an_alert_is_told_when_it_is_raised_and_when_it_is_over_and_never_again(garage: Garage) -> None:
    for name in ("one", "two"):
        garage.drive(name)
        garage.assess()
    assert (health(garage).state, garage.told) == ("healthy", [])
    since = garage.drive("soft one")
    garage.assess()
    garage.assess()
    (alert,) = garage.alerts()
    assert (alert.state, alert.since_trip_id, alert.since_at.date()) == ("open", since, FIRST.replace(day=3).date())
    garage.drive("soft two")
    garage.assess()
    assert [(one.id, one.trips, one.words) for one in garage.alerts()] == [(alert.id, 2, WORDS.format(2))]
    assert garage.told == [("health.alert", WORDS.format(1))]
    garage.drive("pumped up")
    garage.assess()
    garage.assess()
    assert [(one.state, one.cleared_words) for one in garage.alerts()] == [("cleared", "Back to its usual.")]
    assert garage.told[1:] == [("health.cleared", WORDS.format(2))]
    assert health(garage).state == "healthy"


def test_the_same_question_is_not_asked_twice(garage: Garage, monkeypatch: pytest.MonkeyPatch) -> None:
    garage.drive("one")
    garage.assess()
    monkeypatch.setattr(assessing, "judge", lambda *_: pytest.fail("it was assessed already"))
    garage.assess()


def test_trips_that_do_not_count_are_told_with_the_reason(garage: Garage) -> None:
    counted, out, old, other = (garage.drive(name, kept=name != "old") for name in ("one", "out", "old", "other"))
    change(garage, out, in_map=False)
    garage.write(lambda session: setattr(session.get_one(Trip, other), "provenance", {"config_sha256": "?"}))
    garage.assess()
    assert [(trip.trip_id, trip.why) for trip in health(garage).trips] == [
        (counted, ""),
        (out, assessing.NOT_IN_MAP),
        (old, assessing.NOTHING_KEPT),
        (other, assessing.OTHER_FILE),
    ]
    assert (health(garage).state, health(garage).reason) == ("unknown", "Too few trips.")


def test_an_unreadable_result_is_told_and_the_others_count(garage: Garage) -> None:
    broken, whole = garage.drive("broken"), garage.drive("whole")
    row = garage.trip(broken)
    garage.resources.blobs.put(result_file(row, row.observe_key, ROAD_LOAD), b"no parquet")
    garage.assess()
    said = {trip.trip_id: trip.why for trip in health(garage).trips}
    assert said == {broken: assessing.UNREADABLE, whole: ""}


def test_a_fault_of_the_assessment_costs_no_trip_and_no_alert(garage: Garage, monkeypatch: pytest.MonkeyPatch) -> None:
    for name in ("one", "two", "soft"):
        garage.drive(name)
    garage.assess()

    def broken(*_: Any) -> Any:
        raise ZeroDivisionError("nothing to divide by")

    monkeypatch.setattr(assessing, "judge", broken)
    garage.drive("soft, too")
    garage.assess()
    assert "nothing to divide by" in health(garage).reason
    assert [alert.state for alert in garage.alerts()] == ["open"]
    assert health(garage).state == "alert"


def test_what_was_told_stands_while_its_trips_wait_to_be_run_again(garage: Garage) -> None:
    made = [garage.drive(name) for name in ("one", "two", "soft", "soft, too")]
    garage.assess()

    def age(session: Any) -> None:
        for trip_id in made[2:]:
            session.get_one(Trip, trip_id).provenance = {"config_sha256": "of the older file"}

    garage.write(age)
    garage.assess()
    assert [alert.state for alert in garage.alerts()] == ["open"]
    assert [event for event, _ in garage.told] == ["health.alert"]
    change(garage, made[2], in_map=False)
    change(garage, made[3], in_map=False)
    garage.assess()
    assert [(alert.state, alert.cleared_words) for alert in garage.alerts()] == [
        ("cleared", "The trips, looked at again, no longer say so.")
    ]


def test_an_assessment_that_comes_too_late_is_left_to_the_next(garage: Garage) -> None:
    for name in ("one", "two"):
        garage.drive(name)
    late = assessing.assess(garage.resources, FLEET, garage.car_id, lambda *_: None)
    garage.drive("soft")
    garage.assess()
    garage.write(late)
    assert [alert.state for alert in garage.alerts()] == ["open"]
    assert len(health(garage).trips) == 3


def test_a_new_usual_ends_the_alert_and_is_taken_back(garage: Garage) -> None:
    made = [garage.drive(name) for name in ("one", "two", "soft", "soft, too")]
    garage.assess()
    garage.write(lambda session: service.set_usual(session, garage.car_id, NewUsual()) and None)
    assert [(alert.state, alert.cleared_words) for alert in garage.alerts()] == [
        ("cleared", "Taken as the car's new usual.")
    ]
    garage.assess()
    now = health(garage)
    assert (now.state, now.usual_since) == ("healthy", garage.trip(made[2]).started_at)
    assert [trip.role for trip in now.trips] == ["before", "before", "watched", "watched"]
    garage.write(lambda session: service.forget_usual(session, garage.car_id) and None)
    garage.assess()
    assert [alert.state for alert in garage.alerts()] == ["cleared", "open"]
    assert [event for event, _ in garage.told] == ["health.alert", "health.cleared", "health.alert"]


def test_a_changed_file_leaves_the_trips_to_be_run_again(garage: Garage) -> None:
    for name in ("one", "two"):
        garage.drive(name)
    garage.assess()
    garage.write(lambda session: cars.change(session, garage.car_id, name=None, load_kg=200.0) and None)
    garage.assess()
    assert {trip.why for trip in health(garage).trips} == {assessing.OTHER_FILE}


def test_with_the_car_goes_what_is_known_of_its_health(garage: Garage) -> None:
    for name in ("one", "two", "soft"):
        garage.drive(name)
    garage.assess()

    def remove(session: Any) -> None:
        trips.delete_of_car(session, garage.car_id)
        cars.delete(session, garage.car_id)

    garage.write(remove)
    assert garage.alerts() == []


def test_a_deleted_trip_leaves_its_alert_without_a_link(garage: Garage) -> None:
    made = [garage.drive(name) for name in ("one", "two", "soft", "soft, too")]
    garage.assess()
    garage.write(lambda session: session.delete(session.get_one(Trip, made[2])))
    (alert,) = garage.alerts()
    assert isinstance(alert, Alert)
    assert alert.since_trip_id is None
    garage.assess()
    assert garage.alerts()[0].since_trip_id == made[3]
