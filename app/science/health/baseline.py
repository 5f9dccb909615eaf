"""Which trips say what is usual, and what each of them would look like to the others."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from app.science.health.causes import Explanation, Told
from app.science.health.domain import Domain, domain_of
from app.science.health.evidence import TripDesign
from app.science.health.usual import Usual, fit_usual, score

BASELINE_TRIPS = 10
"""Trips that say what is usual: with fewer, their scatter and the engine's force are known too poorly."""
FREAK_SDS = 6.0
MOST_FREAKS = 3
LEAST_HELD = 30
"""Windows of a trip, a minute, that must lie where the usual is known."""


@dataclass(frozen=True, slots=True)
class Baseline:
    """The usual and where it comes from.

    Attributes
    ----------
    usual : Usual
    trips : tuple of int
        Places of the trips it was learnt from.
    freaks : tuple of int
        Places of trips passed over because they differ from all others, or were driven where these were not.
    alone : tuple of Explanation
        Per trip of ``trips``, its changes from what the others call usual.
    """

    usual: Usual
    trips: tuple[int, ...]
    freaks: tuple[int, ...]
    alone: tuple[Explanation, ...]


def learn_baseline(designs: Sequence[TripDesign], drag_area_kgpm: float, crr: float) -> Baseline | None:
    """Learn the usual from the first `BASELINE_TRIPS` trips that agree.

    A trip that is more than `FREAK_SDS` off what the others call usual is passed over for the next one, up to
    `MOST_FREAKS` times: one trip with a trailer must not blunt the eye for the next. So is one that was driven at
    engine speeds and loads of which the others know nothing.

    Returns
    -------
    Baseline or None
        None while there are too few trips.
    """
    freaks: list[int] = []
    elsewhere: list[int] = []
    while True:
        passed = {*freaks, *elsewhere}
        places = [place for place in range(len(designs)) if place not in passed][:BASELINE_TRIPS]
        if len(places) < BASELINE_TRIPS:
            return None
        chosen = [designs[place] for place in places]
        held = [held_windows(one, domain_of(_others(chosen, place))) for place, one in enumerate(chosen)]
        if min(held) < LEAST_HELD:
            elsewhere.append(places[int(np.argmin(held))])
            continue
        seen = [_seen_by_others(chosen, place, drag_area_kgpm, crr) for place in range(len(chosen))]
        off = np.array([np.max(np.abs(one.change / one.sd)) for one in seen])
        worst = int(np.argmax(off))
        if off[worst] < FREAK_SDS or len(freaks) == MOST_FREAKS:
            usual = fit_usual(chosen, drag_area_kgpm, crr)
            return Baseline(usual, tuple(places), tuple(sorted(passed)), tuple(seen))
        freaks.append(places[worst])


def _seen_by_others(designs: Sequence[TripDesign], place: int, drag_area_kgpm: float, crr: float) -> Explanation:
    return alone(designs[place], fit_usual(_others(designs, place), drag_area_kgpm, crr))


def _others(designs: Sequence[TripDesign], place: int) -> list[TripDesign]:
    return [*designs[:place], *designs[place + 1 :]]


def held_windows(design: TripDesign, domain: Domain) -> int:
    """Count a trip's windows where the usual is known."""
    return int(np.count_nonzero(domain.holds(design)))


def alone(design: TripDesign, usual: Usual) -> Explanation:
    """Return each quantity's change on one trip as if nothing else had changed."""
    return Told([score(design, usual)], usual, design.mass_kg).each(0, 1)
