"""One section after the other: the best drive over the same road, and what the driven one took more."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from app.science.eco.best import Car, Solver, ride_of_plan, route
from app.science.eco.driven import Driven, Stretch
from app.science.eco.losses import Drive
from app.science.eco.result import Section
from app.science.eco.ride import Ride, burnt
from app.science.eco.road import Freedom, KnownLimits, road_of
from app.science.optimal.problem import Infeasible, Road
from app.science.progress import Progress

UNKNOWN_SHARE = 0.05


@dataclass(frozen=True, slots=True)
class Compared:
    """A scored section with both drives.

    Attributes
    ----------
    section : Section
        Its parts are filled in where litres are known.
    rows : slice
        Of the trip's ride.
    road : Road
    driven, best : Drive
    """

    section: Section
    rows: slice
    road: Road
    driven: Drive
    best: Drive


def compare(
    trip: Driven,
    stretch: Stretch,
    car: Car,
    solver: Solver,
    progress: Progress,
    freedom: Freedom,
    limits: KnownLimits | None = None,
) -> Compared | Section:
    """Look for the best drive of a stretch between two stops; where there is none, say why.

    Where the drive that is found takes more than the driven one, the driven one is the best that is known.

    Parameters
    ----------
    trip : Driven
    stretch : Stretch
    car : Car
    solver : callable
        Solves a route.
    progress : callable
    freedom : Freedom
    limits : KnownLimits, optional
    """
    ride = trip.ride.part(stretch.rows)
    section = _section(trip, stretch, ride)
    driven = Drive(ride, burnt(ride, car.load, car.model))
    reason = stretch.reason or _unknown(driven)
    if reason:
        return replace(section, reason=reason)
    road = road_of(ride, freedom, limits)
    problem = route(car, road, float(ride.speed_mps[0]), float(ride.speed_mps[-1]), driven.time_s)
    try:
        found = solver(problem, progress)
    except Infeasible as error:
        return replace(section, reason=f"No best drive was found: {error}")
    other = ride_of_plan(found, car, road, section.from_s)
    best = Drive(other, burnt(other, car.load, car.model))
    verdict = "best found"
    if best.fuel_j > driven.fuel_j:
        other, best, verdict = ride, driven, "as driven"
    scored = replace(
        section,
        scored=True,
        driven_j=driven.fuel_j,
        best_j=best.fuel_j,
        best_s=best.time_s,
        shifts=shifts(ride),
        best_shifts=shifts(other),
        verdict=verdict,
    )
    return Compared(scored, stretch.rows, road, driven, best)


def missed_percent(compared: Sequence[Compared]) -> float:
    """Return by how much the modelled fuel of whole sections is off, in percent of all, as chance errors add up.

    Where engine and gear are asked for seldom, or the formula was learnt from a single trip, the sections differ by
    more than a model's error at a working point: the driven drive itself isn't better known than this.
    """
    off = np.array([one.driven.fuel_j - one.section.measured_j for one in compared])
    return float(100.0 * np.sqrt(off @ off) / sum(one.driven.fuel_j for one in compared))


def shifts(ride: Ride) -> int:
    """Return how often a drive changes into another gear; an open clutch between is no change."""
    gears = ride.gear[ride.gear > 0]
    return int(np.count_nonzero(np.diff(gears)))


def _section(trip: Driven, stretch: Stretch, ride: Ride) -> Section:
    return Section(
        from_s=float(ride.t_s[0]),
        to_s=float(ride.t_s[-1] + ride.dt_s[-1]),
        from_m=float(ride.distance_m[0]),
        to_m=float(ride.distance_m[-1] + ride.speed_mps[-1] * ride.dt_s[-1]),
        scored=False,
        reason="",
        measured_j=trip.measured_j(stretch.rows),
    )


def _unknown(driven: Drive) -> str:
    """Say what of the driving is not known: the motion, or the engine's speed although it pulls."""
    if not np.isfinite(driven.fuel_j + float(driven.ride.sin_slope.sum())):
        return "The car's motion is not known all along it."
    blind = ~driven.took.pulls & (driven.took.engine_w > 0.0)
    share = float(driven.ride.dt_s[blind].sum()) / driven.time_s
    return f"The engine's speed is not known in {100.0 * share:.0f} % of it." if share > UNKNOWN_SHARE else ""
