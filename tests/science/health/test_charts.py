"""The chart on made-up trips whose statistics are exactly what it assumes."""

from __future__ import annotations

import numpy as np
import pytest

from app.science.arrays import FloatArray
from app.science.health.causes import Told
from app.science.health.charts import ALARM_GAIN, FALSE_ALARMS_PER_200_TRIPS, MEMORY, watch
from app.science.health.evidence import TERMS
from app.science.health.usual import COUNT, EXPECTED_TRIPS, QUANTITIES, Score, Usual

ROLLING, MASS, DRAG, EFFICIENCY = range(COUNT)
TRIP_SD = np.array([4.0, 11.0, 3.0, 0.7])
"""Of a half-hour trip, about as on virtual cars."""


def told(changes: FloatArray) -> Told:
    """Trips that each saw these changes, (n, 4), with `TRIP_SD`; the usual itself is known exactly."""
    information = np.diag(1.0 / TRIP_SD**2)
    usual = Usual(np.zeros(TERMS), np.eye(TERMS), 1.0, TRIP_SD, 0.45, 0.01, None)  # type: ignore[arg-type]  # unused
    nothing = np.zeros(TERMS)
    scores = [
        Score(
            nothing, np.zeros((TERMS, TERMS)), information @ one, information, np.zeros((COUNT, TERMS)), np.full(4, 1e9)
        )
        for one in changes
    ]
    return Told(scores, usual, 919.0)


def trips(count: int, seed: int) -> FloatArray:
    return np.random.default_rng(seed).standard_normal((count, COUNT)) * TRIP_SD


def test_false_alarms_are_as_rare_as_stated() -> None:
    """Largest of all stretches of two to `MEMORY` trips, scatter and mean learnt on ten trips as the baseline's are."""
    rng = np.random.default_rng(7)
    cars, length, learnt = 20_000, 60, 10
    sd = np.sqrt((EXPECTED_TRIPS + rng.chisquare(learnt, (cars, 1, COUNT))) / (EXPECTED_TRIPS + learnt))
    trip = rng.standard_normal((cars, length, COUNT)) / sd
    mean = rng.standard_normal((cars, COUNT)) / np.sqrt(learnt) / sd[:, 0]
    sums = np.concatenate([np.zeros((cars, 1, COUNT)), np.cumsum(trip, axis=1)], axis=1)
    alarmed = np.zeros(cars, np.bool_)
    for stretch in range(2, MEMORY + 1):
        change = sums[:, stretch:] - sums[:, :-stretch] - stretch * mean[:, None]
        alarmed |= (change**2 / (stretch + stretch**2 / learnt) > ALARM_GAIN).any(axis=(1, 2))
    assert float(np.mean(alarmed)) / length * 200.0 == pytest.approx(FALSE_ALARMS_PER_200_TRIPS, rel=0.25)


def test_healthy_trips_raise_nothing() -> None:
    assert watch(told(trips(200, seed=1))) == ()


@pytest.mark.parametrize(
    ("quantity", "change"), [(ROLLING, 18.0), (ROLLING, -18.0), (MASS, 150.0), (DRAG, 25.0), (EFFICIENCY, -6.0)]
)
def test_a_change_is_found_named_and_cleared(quantity: int, change: float) -> None:
    seen = trips(30, seed=2)
    seen[10:18, quantity] += change
    (found,) = watch(told(seen))
    assert found.cause.quantity == quantity
    assert abs(found.cause.start - 10) <= 1
    assert found.raised < 15
    assert abs(found.cause.stop - 18) <= 1
    assert found.cleared is not None
    assert found.cleared < 21
    assert found.chances[quantity] > 0.95


def test_one_odd_trip_is_no_alarm() -> None:
    seen = trips(30, seed=3)
    seen[10, ROLLING] += 30.0
    assert watch(told(seen)) == ()


def test_one_trip_beyond_doubt_is() -> None:
    seen = trips(30, seed=3)
    seen[10, MASS] = 300.0
    (found,) = watch(told(seen))
    assert (found.raised, found.cause.start, found.cause.stop) == (10, 10, 11)


def test_two_things_at_once_are_told_apart() -> None:
    seen = trips(40, seed=4)
    seen[10:, ROLLING] += 25.0
    seen[20:, MASS] += 150.0
    rolling, mass = watch(told(seen))
    assert [QUANTITIES[one.cause.quantity] for one in (rolling, mass)] == ["rolling_resistance", "mass"]
    assert rolling.cleared is None
    assert abs(mass.cause.start - 20) <= 1
    both = told(seen).explain([rolling.cause, mass.cause])
    assert both.change == pytest.approx([25.0, 150.0], abs=8.0)


def test_small_changes_are_not_worth_a_word() -> None:
    """Well measured, but no more than kinds of roads differ by."""
    seen = trips(60, seed=5)
    seen[10:, EFFICIENCY] -= 0.6
    assert watch(told(seen)) == ()
