"""What each trip tells of each quantity, and the quantities over the trips."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from app.science.arrays import FloatArray
from app.science.health import words
from app.science.health.baseline import Baseline
from app.science.health.causes import Cause, Explanation, Told
from app.science.health.charts import Episode
from app.science.health.result import HealthAlert, Trend, TripChange, TripHealth
from app.science.health.scale import Scale
from app.science.health.usual import COUNT, QUANTITIES


@dataclass(frozen=True, slots=True)
class Changes:
    """Change of each quantity and its sd, as people are told, shape (4,), from so many trips."""

    change: FloatArray
    sd: FloatArray
    trips: int = 1

    @classmethod
    def of(cls, told: Explanation, scale: Scale, trips: int = 1) -> Changes:
        """Turn an explanation of all four quantities into what people are told."""
        pairs = [scale.true(q, float(told.change[q]), float(told.sd[q])) for q in range(COUNT)]
        change, sd = np.array(pairs).T
        return cls(change, sd, trips)

    def by_quantity(self) -> tuple[TripChange, ...]:
        """Return one entry per quantity."""
        numbers = zip(QUANTITIES, self.change.tolist(), self.sd.tolist(), strict=True)
        return tuple(TripChange(name, change, sd) for name, change, sd in numbers)


def beside(episodes: Sequence[Episode], cause: Cause) -> list[Cause]:
    """Return the causes of other quantities that were there on any trip of a cause."""
    return [
        one.cause
        for one in episodes
        if one.cause.quantity != cause.quantity and one.cause.start < cause.stop and cause.start < one.cause.stop
    ]


def changes_over(told: Told, episodes: Sequence[Episode], start: int, stop: int, scale: Scale) -> Changes:
    """Estimate each quantity over trips; what is known to have changed by then is taken out of the others."""
    change, sd = np.empty(COUNT), np.empty(COUNT)
    for quantity in range(COUNT):
        cause = Cause(quantity, start, stop)
        together = told.explain([*beside(episodes, cause), cause])
        change[quantity], sd[quantity] = together.change[-1], together.sd[-1]
    return Changes.of(Explanation(change, sd, sd), scale, stop - start)


def trend(
    quantity: int, trips: Sequence[TripHealth], baseline: Baseline, now: Changes | None, alerts: Sequence[HealthAlert]
) -> Trend:
    """Put one quantity's changes in a row, with what is usual and what was found.

    Parameters
    ----------
    quantity : int
        Its place in `QUANTITIES`.
    trips : sequence of TripHealth
        All of the car, in driving order.
    baseline : Baseline
    now : Changes or None
        Over the newest watched trips.
    alerts : sequence of HealthAlert
        Of all quantities.
    """
    name = QUANTITIES[quantity]
    shown = [trip for trip in trips if trip.changes]
    healthy_sd = float(np.median([one.sd[quantity] for one in baseline.alone]))
    own = [alert for alert in alerts if alert.quantity == name]
    is_open = [alert.words + "." for alert in own if alert.is_open]
    turned = {trip_id for alert in own for trip_id in (alert.since_trip_id, alert.cleared_trip_id)}
    usually = (
        words.standing([], 0)
        if now is None
        else words.usual_words(name, float(now.change[quantity]), float(now.sd[quantity]), now.trips)
    )
    return Trend(
        quantity=name,
        title=words.TITLES[name],
        unit=words.UNITS[name],
        trip_ids=tuple(trip.trip_id for trip in shown),
        names=tuple(trip.name for trip in shown),
        started_at=tuple(trip.started_at for trip in shown),
        estimate=tuple(trip.changes[quantity].change for trip in shown),
        sd=tuple(trip.changes[quantity].sd for trip in shown),
        usual=0.0,
        usual_sd=healthy_sd / float(np.sqrt(len(baseline.trips))),
        band=2.0 * healthy_sd,
        change_points=tuple(trip.trip_id for trip in shown if trip.trip_id in turned),
        words=is_open[0] if is_open else usually,
    )
