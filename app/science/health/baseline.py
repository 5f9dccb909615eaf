"""Which trips say what is usual, and what each of them would look like to the others."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from app.science.health.causes import Explanation, Told
from app.science.health.evidence import TripDesign
from app.science.health.usual import Usual, fit_usual, score

BASELINE_TRIPS = 10
"""Trips that say what is usual: with fewer, their scatter and the engine's force are known too poorly."""
FREAK_SDS = 6.0
MOST_FREAKS = 3


@dataclass(frozen=True, slots=True)
class Baseline:
    """The usual and where it comes from.

    Attributes
    ----------
    usual : Usual
    trips : tuple of int
        Places of the trips it was learnt from.
    freaks : tuple of int
        Places of trips passed over because they differ from all others.
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
    `MOST_FREAKS` times: one trip with a trailer must not blunt the eye for the next.

    Returns
    -------
    Baseline or None
        None while there are too few trips.
    """
    freaks: list[int] = []
    while True:
        places = [place for place in range(len(designs)) if place not in freaks][:BASELINE_TRIPS]
        if len(places) < BASELINE_TRIPS:
            return None
        chosen = [designs[place] for place in places]
        alone = [_seen_by_others(chosen, place, drag_area_kgpm, crr) for place in range(len(chosen))]
        off = np.array([np.max(np.abs(one.change / one.sd)) for one in alone])
        worst = int(np.argmax(off))
        if off[worst] < FREAK_SDS or len(freaks) == MOST_FREAKS:
            return Baseline(fit_usual(chosen, drag_area_kgpm, crr), tuple(places), tuple(freaks), tuple(alone))
        freaks.append(places[worst])


def _seen_by_others(designs: Sequence[TripDesign], place: int, drag_area_kgpm: float, crr: float) -> Explanation:
    usual = fit_usual([*designs[:place], *designs[place + 1 :]], drag_area_kgpm, crr)
    return alone(designs[place], usual)


def alone(design: TripDesign, usual: Usual) -> Explanation:
    """Return each quantity's change on one trip as if nothing else had changed."""
    return Told([score(design, usual)], usual, design.mass_kg).each(0, 1)
