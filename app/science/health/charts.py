"""When a change is more than chance: a sequential test after each trip, and its end."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from app.science.arrays import FloatArray
from app.science.health.causes import Cause, Told, chances
from app.science.health.usual import COUNT

ALARM_GAIN = 25.0
"""Square of a change over its sd that raises an alarm."""
FALSE_ALARMS_PER_200_TRIPS = 0.037
"""Of `ALARM_GAIN` with four quantities, `MEMORY`, and scatter learnt on ten trips: tests/science/health/test_charts.py
draws it anew."""
SURE_GAIN = 100.0
"""One trip alone raises an alarm only from here."""
AGREEING = 1.0
"""In sds: each of the two newest trips of a change must show at least so much of it, in the same direction."""
WORTH = np.array([6.0, 30.0, 8.0, 1.5])
"""Smallest change worth an alarm, in %, kg, %, %: less may be another kind of road."""
MEMORY = 20
"""A change may have begun at most so many trips ago when it is found."""
BACK_GAIN = 12.0
"""By how much "back at the usual since" must explain the trips better than "still changed" to clear an alarm."""
DOUBT = 0.05
"""Chance from which on the second most probable cause is named."""


@dataclass(frozen=True, slots=True)
class Episode:
    """A change found by the watch; trips by their place.

    Attributes
    ----------
    cause : Cause
        From its first trip to, not including, the one at which the car was back at its usual, or the end.
    raised : int
        Trip at which it was sure enough.
    cleared : int or None
        Trip at which the end was seen.
    chances : array, shape (4,)
        Probability of each quantity to be the cause.
    """

    cause: Cause
    raised: int
    cleared: int | None
    chances: FloatArray

    @property
    def other(self) -> int | None:
        """The second most probable quantity, where it can't be ruled out."""
        order = np.argsort(self.chances)[::-1]
        second = int(order[1] if order[0] == self.cause.quantity else order[0])
        return second if self.chances[second] >= DOUBT else None


def watch(told: Told) -> tuple[Episode, ...]:
    """Go through a car's trips in driving order and raise and clear alarms as each one comes.

    After each trip every quantity and every trip of the last `MEMORY` as its first is tried as a new cause beside
    those that are open (a generalised likelihood ratio chart). The best one above `ALARM_GAIN` is believed. The cause
    of an open alarm is judged anew with each trip, as more trips tell causes apart.

    Returns
    -------
    tuple of Episode
        In the order they were raised.
    """
    open_: list[Episode] = []
    closed: list[Episode] = []
    for trip in range(told.trips):
        stop = trip + 1
        open_ = [replace(one, cause=replace(one.cause, stop=stop)) for one in open_]
        for place in range(len(open_)):
            open_[place] = _judged_again(told, open_, place)
        for one in list(open_):
            back = _back_since(told, open_, one)
            if back is not None:
                open_.remove(one)
                closed.append(replace(one, cause=replace(one.cause, stop=back), cleared=trip))
        ended = max((one.cause.stop for one in closed), default=0)
        found = _new_cause(told, open_, max(ended, stop - MEMORY), stop)
        if found is not None:
            open_.append(found)
    return tuple(sorted([*closed, *open_], key=lambda one: one.raised))


def _gain(told: Told, beside: Sequence[Cause], cause: Cause) -> float:
    """Return how much better trips are explained with a cause than without, as its change over its scatter, squared."""
    together = told.explain([*beside, cause])
    return float(together.change[-1] / together.scatter_sd[-1]) ** 2


def _judged(told: Told, beside: Sequence[Cause], start: int, stop: int) -> tuple[FloatArray, FloatArray]:
    """Return each quantity's change and sd as the cause from a trip on, shape (4,) each; taken ones have none."""
    if not beside:
        alone = told.each(start, stop)
        return alone.change, alone.sd
    changes, sds = np.zeros(COUNT), np.full(COUNT, np.inf)
    for quantity in set(range(COUNT)) - {one.quantity for one in beside}:
        together = told.explain([*beside, Cause(quantity, start, stop)])
        changes[quantity], sds[quantity] = together.change[-1], together.sd[-1]
    return changes, sds


def _new_cause(told: Told, open_: Sequence[Episode], earliest: int, stop: int) -> Episode | None:
    if len(open_) == COUNT:
        return None
    beside = [one.cause for one in open_]
    best: Episode | None = None
    highest = ALARM_GAIN
    for start in range(earliest, stop):
        changes, sds = _judged(told, beside, start, stop)
        likely = chances(changes, sds)
        quantity = int(np.argmax(likely))
        cause, change = Cause(quantity, start, stop), float(changes[quantity])
        gain = (change / float(sds[quantity])) ** 2
        if gain > highest and abs(change) >= WORTH[quantity] and _is_borne_out(told, cause, change, gain):
            highest = gain
            best = Episode(cause, stop - 1, None, likely)
    return best


def _is_borne_out(told: Told, cause: Cause, change: float, gain: float) -> bool:
    """Whether the two newest trips each show the change by themselves; one trip alone must be very sure."""
    if cause.stop - cause.start == 1:
        return gain > SURE_GAIN
    for trip in (cause.stop - 2, cause.stop - 1):
        alone = told.each(trip, trip + 1)
        if np.sign(change) * alone.change[cause.quantity] < AGREEING * alone.scatter_sd[cause.quantity]:
            return False
    return True


def _judged_again(told: Told, open_: Sequence[Episode], place: int) -> Episode:
    """Find the cause of an open alarm anew, first its quantity, then its first trip."""
    one = open_[place]
    beside = [other.cause for other in open_ if other is not one]
    changes, sds = _judged(told, beside, one.cause.start, one.cause.stop)
    likely = chances(changes, sds)
    quantity = int(np.argmax(likely))
    near = range(max(one.cause.start - 2, 0), min(one.cause.start + 3, one.raised + 1))
    start = max(near, key=lambda trip: _gain(told, beside, Cause(quantity, trip, one.cause.stop)))
    return replace(one, cause=Cause(quantity, start, one.cause.stop), chances=likely)


def _back_since(told: Told, open_: Sequence[Episode], one: Episode) -> int | None:
    """Return the trip since which the car is back at its usual; None while it isn't."""
    beside = [other.cause for other in open_ if other is not one]
    begun, newest = one.cause.start, one.cause.stop
    ended = {
        trip: _gain(told, beside, Cause(one.cause.quantity, begun, trip))
        for trip in range(max(begun + 1, newest - MEMORY), newest)
    }
    if not ended:
        return None
    trip = max(ended, key=lambda place: ended[place])
    sure = BACK_GAIN if newest - trip > 1 else 2.0 * BACK_GAIN
    return trip if ended[trip] - _gain(told, beside, one.cause) > sure else None
