"""What a trip takes over from the car's earlier ones: from which, and that it can't come back to itself."""

from __future__ import annotations

from collections.abc import Callable
from datetime import UTC, datetime, timedelta
from typing import Any

import pytest
from sqlalchemy.orm import Session

from app.accounts.models import DEFAULT_FLEET_ID as FLEET
from app.cars import service as cars
from app.science.observer.tuning import DEFAULT, tuning_to_dict
from app.storage.keys import stage_key
from app.storage.resources import Resources
from app.trips.carrying import NOTHING, SUMMARY, CarriedOver, carried_over
from app.trips.keys import options_of
from app.trips.models import Trip
from tests.yards import Yard

NOON = datetime(2009, 10, 27, 12, tzinfo=UTC)
Change = Callable[[Trip], None]


@pytest.fixture
def yard(resources: Resources) -> Yard:
    return Yard(resources)


def observed(yard: Yard, name: str, days: float, change: Change = lambda trip: None) -> str:
    """Make a healthy trip that began some days after noon of the first."""
    trip_id = yard.new_trip(name)

    def describe(session: Session) -> None:
        trip = session.get_one(Trip, trip_id)
        trip.started_at, trip.verdict = NOON + timedelta(days=days), "healthy"
        trip.observe_key = stage_key("observe", name=name)
        sha256 = cars.config(session, yard.car_id).sha256
        trip.provenance = {"config_sha256": sha256, "tuning": tuning_to_dict(DEFAULT), "load_kg": 75.0}
        trip.summary = {SUMMARY: {"mean": [0.1, 0.0, -0.1], "sd": [0.01, 0.01, 0.01]}}
        change(trip)

    yard.write(describe)
    return trip_id


def carried(yard: Yard, trip_id: str, **options: Any) -> CarriedOver:
    with yard.resources.database.transaction(FLEET, read_only=True) as session:
        trip = session.get_one(Trip, trip_id)
        return carried_over(session, trip, cars.config(session, yard.car_id), options_of(options))


def sources(yard: Yard, trip_id: str, **options: Any) -> list[str]:
    return [source for source, _ in carried(yard, trip_id, **options).trips]


def test_a_trip_takes_over_from_those_that_began_before_it_and_says_which(yard: Yard) -> None:
    first, third, second = (observed(yard, name, days) for name, days in (("first", 0), ("third", 2), ("second", 1)))
    assert carried(yard, first) == NOTHING
    assert sources(yard, second) == [first]
    assert sources(yard, third) == [second, first]
    said = carried(yard, second).provenance()
    assert said is not None
    assert said["trips"] == [{"trip_id": first, "observe_key": stage_key("observe", name="first")}]
    assert said["mean_mps2"] == pytest.approx([0.1, 0.0, -0.1])
    assert said["sd_mps2"] == pytest.approx([0.07141] * 3, abs=1e-4)


def test_running_a_trip_again_takes_over_the_same(yard: Yard) -> None:
    """However often the others ran meanwhile: a trip's own result is in nothing that it takes over."""
    first, second = observed(yard, "first", 0), observed(yard, "second", 1)
    before = carried(yard, second)

    def run_again(session: Session) -> None:
        trip = session.get_one(Trip, second)
        trip.observe_key, trip.summary = stage_key("again"), {SUMMARY: {"mean": [9.0] * 3, "sd": [0.01] * 3}}

    yard.write(run_again)
    observed(yard, "third", 2)
    assert carried(yard, second) == before
    assert carried(yard, first) == NOTHING


@pytest.mark.parametrize(
    "change",
    [
        lambda trip: setattr(trip, "verdict", "doubtful"),
        lambda trip: setattr(trip, "observe_key", None),
        lambda trip: setattr(trip, "duration_s", 100_000.0),
        lambda trip: setattr(trip, "summary", {}),
        lambda trip: setattr(trip, "summary", {SUMMARY: None}),
        lambda trip: setattr(trip, "provenance", trip.provenance | {"config_sha256": "another mounting"}),
        lambda trip: setattr(trip, "provenance", trip.provenance | {"tuning": {"name": "thesis-2010"}}),
    ],
    ids=[
        "doubtful",
        "not observed",
        "not over",
        "of an earlier version",
        "without accelerometer",
        "other file",
        "other tuning",
    ],
)
def test_what_can_not_be_relied_on_is_not_taken_over(yard: Yard, change: Change) -> None:
    observed(yard, "before", 0, change)
    assert carried(yard, observed(yard, "now", 1)) == NOTHING


def test_nothing_is_taken_over_when_not_wanted(yard: Yard) -> None:
    first = observed(yard, "before", 0)
    now = observed(yard, "now", 1)
    assert sources(yard, now) == [first]
    assert carried(yard, now, carry_over=False) == NOTHING
    assert carried(yard, now, without=["acc"]) == NOTHING


def test_of_a_trip_without_a_clock_the_arrival_counts(yard: Yard) -> None:
    early = observed(yard, "early", 0)
    now = observed(yard, "now", 1, lambda trip: setattr(trip, "started_at", None))
    assert sources(yard, now) == [early]
    assert now not in sources(yard, early)
