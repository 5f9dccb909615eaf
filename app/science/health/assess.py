"""A car's health from its trips, in driving order."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from app.science.health import words
from app.science.health.baseline import BASELINE_TRIPS, LEAST_HELD, Baseline, alone, held_windows, learn_baseline
from app.science.health.causes import Told
from app.science.health.charts import FALSE_ALARMS_PER_200_TRIPS, Episode, watch
from app.science.health.evidence import TripDesign, trip_design
from app.science.health.result import CarHealth, HealthAlert, Role, TripChange, TripHealth
from app.science.health.scale import Scale
from app.science.health.trends import Changes, beside, changes_over, trend
from app.science.health.usual import COUNT, QUANTITIES, score
from app.science.roadload.windows import RoadLoadWindows
from app.science.vehicle.model import Vehicle

SHORTEST_S = 120.0
"""Driving with fuel burning that a trip must hold to count."""
RECENT_TRIPS = 5
FREAK = "It differs from all trips around it, so it doesn't say what is usual."
ELSEWHERE = "It was driven at other engine speeds and loads than the trips that say what is usual."


@dataclass(frozen=True, slots=True)
class TripLoad:
    """What a trip's health is read from.

    Attributes
    ----------
    trip_id, name : str
    started_at : float or None
        UTC, seconds since 1970-01-01.
    windows : RoadLoadWindows
    config : str
        Names the car file and the settings that the trip was observed with, as far as they bear on force and fuel.
    """

    trip_id: str
    name: str
    started_at: float | None
    windows: RoadLoadWindows
    config: str = ""


@dataclass(frozen=True, slots=True)
class _Estimates:
    """Changes of one trip, or why there are none."""

    role: Role
    reason: str = ""
    changes: Changes | None = None

    def told(self) -> tuple[TripChange, ...]:
        return () if self.changes is None else self.changes.by_quantity()


def assess(trips: Sequence[TripLoad], vehicle: Vehicle, usual_since: float | None = None) -> CarHealth:
    """Say what changed on a car since its usual was learnt (Sebesta 2010, 3.6 and 5).

    The first ten trips say what is usual: the engine's force over fuel and speed, and by how much healthy trips differ.
    Each later trip then tells by how much rolling resistance, mass, drag or the engine's efficiency would have to
    differ to explain it, and a chart over the trips decides when that is more than chance.

    Parameters
    ----------
    trips : sequence of TripLoad
        In driving order.
    vehicle : Vehicle
        The car's file: what a percent of drag and rolling resistance is a percent of.
    usual_since : float, optional
        UTC from which on the trips say what is usual, seconds since 1970-01-01; trips before it are only shown. A trip
        whose start is not known goes with the one before it.

    Returns
    -------
    CarHealth
        With a ``reason`` and no trends while there are too few trips.
    """
    designs = [trip_design(trip.windows, vehicle.drag_area_kgpm, vehicle.crr) for trip in trips]
    roles = _roles(trips, designs, usual_since)
    counted = [place for place, role in enumerate(roles) if role.role == "watched"]
    baseline = learn_baseline([designs[place] for place in counted], vehicle.drag_area_kgpm, vehicle.crr)
    if baseline is None:
        return _nothing_yet(trips, roles, len(counted))
    watched = _watched(designs, counted, baseline)
    told = Told([score(designs[place], baseline.usual) for place in watched], baseline.usual, vehicle.mass_kg)
    scale = Scale.of(baseline.usual, vehicle.mass_kg)
    episodes = watch(told)
    ids = [trips[place].trip_id for place in watched]
    alerts = tuple(_alert(told, episodes, one, ids, scale) for one in episodes)
    estimates = _estimates(designs, roles, counted, baseline, scale)
    for trip, place in enumerate(watched):
        estimates[place] = _Estimates("watched", changes=changes_over(told, episodes, trip, trip + 1, scale))
    shown = tuple(
        TripHealth(trip.trip_id, trip.name, trip.started_at, one.role, one.reason, one.told())
        for trip, one in zip(trips, estimates, strict=True)
    )
    recent = max(told.trips - RECENT_TRIPS, 0)
    now = changes_over(told, episodes, recent, told.trips, scale) if watched else None
    return CarHealth(
        trips=shown,
        trends=tuple(trend(quantity, shown, baseline, now, alerts) for quantity in range(COUNT)),
        alerts=alerts,
        words=words.standing([alert.words for alert in alerts if alert.is_open], len(watched)),
        false_alarms_per_200_trips=FALSE_ALARMS_PER_200_TRIPS,
        baseline_trips=len(baseline.trips),
        baseline_needed=BASELINE_TRIPS,
    )


def _roles(trips: Sequence[TripLoad], designs: Sequence[TripDesign], usual_since: float | None) -> list[_Estimates]:
    """Return each trip's role before the baseline is chosen; what could count is ``watched``."""
    roles: list[_Estimates] = []
    after = usual_since is None
    for trip, design in zip(trips, designs, strict=True):
        if usual_since is not None and trip.started_at is not None:
            after = trip.started_at >= usual_since
        if trip.config != trips[-1].config:
            roles.append(_Estimates("left_out", "It was observed with another car file: run it again."))
        elif design.seconds < SHORTEST_S:
            minutes = f"{design.seconds / 60.0:.1f}"
            reason = f"It holds {minutes} min of steady driving with fuel; {SHORTEST_S / 60.0:.0f} min are needed."
            roles.append(_Estimates("left_out", reason))
        else:
            roles.append(_Estimates("watched" if after else "before"))
    return roles


def _nothing_yet(trips: Sequence[TripLoad], roles: Sequence[_Estimates], counted: int) -> CarHealth:
    missing = max(BASELINE_TRIPS - counted, 1)
    reason = (
        f"{BASELINE_TRIPS} trips that agree say what is usual for a car; there {'is' if counted == 1 else 'are'} "
        f"{counted} so far. Upload {missing} more."
    )
    shown = tuple(
        TripHealth(
            trip.trip_id, trip.name, trip.started_at, "baseline" if one.role == "watched" else one.role, one.reason
        )
        for trip, one in zip(trips, roles, strict=True)
    )
    return CarHealth(
        shown, (), (), "Its usual is not known yet.", FALSE_ALARMS_PER_200_TRIPS, counted, BASELINE_TRIPS, reason
    )


def _watched(designs: Sequence[TripDesign], counted: Sequence[int], baseline: Baseline) -> list[int]:
    """Return the places of the trips behind the baseline's last that can be judged."""
    last = counted[max([*baseline.trips, *baseline.freaks])]
    return [place for place in counted if place > last and _can_be_judged(designs[place], baseline)]


def _can_be_judged(design: TripDesign, baseline: Baseline) -> bool:
    return held_windows(design, baseline.usual.domain) >= LEAST_HELD


def _estimates(
    designs: Sequence[TripDesign],
    roles: Sequence[_Estimates],
    counted: Sequence[int],
    baseline: Baseline,
    scale: Scale,
) -> list[_Estimates]:
    """Return what every trip tells by itself."""
    learnt = {counted[place]: one for place, one in zip(baseline.trips, baseline.alone, strict=True)}
    freaks = {counted[place] for place in baseline.freaks}
    estimates: list[_Estimates] = []
    for place, (design, role) in enumerate(zip(designs, roles, strict=True)):
        if role.role == "left_out":
            estimates.append(role)
            continue
        if place not in learnt and not _can_be_judged(design, baseline):
            estimates.append(_Estimates("left_out", ELSEWHERE))
            continue
        told = learnt[place] if place in learnt else alone(design, baseline.usual)
        changes = Changes.of(told, scale)
        if place in learnt:
            estimates.append(_Estimates("baseline", changes=changes))
        elif place in freaks:
            estimates.append(_Estimates("left_out", FREAK, changes))
        else:
            estimates.append(_Estimates(role.role, changes=changes))
    return estimates


def _alert(told: Told, episodes: Sequence[Episode], one: Episode, trip_ids: Sequence[str], scale: Scale) -> HealthAlert:
    together = told.explain([*beside(episodes, one.cause), one.cause])
    quantity = QUANTITIES[one.cause.quantity]
    change, sd = scale.true(one.cause.quantity, float(together.change[-1]), float(together.sd[-1]))
    trips = one.cause.stop - one.cause.start
    other = None if one.other is None else QUANTITIES[one.other]
    say = words.open_words if one.cleared is None else words.cleared_words
    return HealthAlert(
        quantity=quantity,
        since_trip_id=trip_ids[one.cause.start],
        raised_trip_id=trip_ids[one.raised],
        last_trip_id=trip_ids[one.cause.stop - 1],
        cleared_trip_id=None if one.cleared is None else trip_ids[one.cleared],
        trips=trips,
        change=change,
        change_sd=sd,
        unit=words.UNITS[quantity],
        chance=float(one.chances[one.cause.quantity]),
        other=other or "",
        words=say(quantity, change, trips),
        advice=words.advice(quantity, change, other, 0.0 if one.other is None else float(one.chances[one.other])),
    )
