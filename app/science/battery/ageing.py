"""How a battery ages: trends of capacity and resistance with bands, and how long it still serves."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from app.science.arrays import FloatArray
from app.science.battery.ageing_result import Aged, Ageing, Compared
from app.science.battery.ageing_words import warned
from app.science.battery.health import HealthPoint, LabTest, Points, capacities, full_cycles, joined, resistances
from app.science.battery.life import remaining
from app.science.battery.trend import Trend, fit_trend
from app.science.fields import ProblemError
from app.science.vehicle.battery import END_OF_LIFE

__all__ = ["Ageing", "HealthPoint", "LabTest", "ageing"]

LEAST_POINTS, LEAST_SPAN = 3, 1.0
"""No trend is told by fewer points, nor over less than a day or a full cycle."""
TWICE = 2.0
"""Resistance counts as spent at so many times what it was at first."""


def ageing(
    points: Sequence[HealthPoint],
    threshold: float = END_OF_LIFE,
    tests: Sequence[LabTest] = (),
    *,
    rated_ah: float | None = None,
    use_tests: bool = False,
) -> Ageing:
    """Return trends with bands and the remaining life.

    Parameters
    ----------
    points : sequence of HealthPoint
        In any order; where `HealthPoint.carried` says so, each is freed of what it took over from the one before.
    threshold : float
        Share of the rated capacity at which the battery counts as spent.
    tests : sequence of LabTest
        Capacities measured in a laboratory; compared with the trend at their times.
    rated_ah : float or None
        Of one cell when new; None: what the trend, or else the first point, begins with.
    use_tests : bool
        Whether the tests take part in the trend, by their own standard deviations; a comparison is no check then.

    Raises
    ------
    ProblemError
        When the threshold is no share.
    """
    if not 0.05 <= threshold <= 1.0:
        raise ProblemError("threshold", f"{threshold:g} is no share of the rated capacity; allowed is 0.05 to 1.")
    ordered = sorted(points, key=lambda one: one.at)
    known = capacities(ordered)
    if use_tests:
        known = joined(known, tests)
    trend = _trend(known.at, known)
    rated = rated_ah or _first(trend, known)
    ohms = resistances(ordered)
    grown = _trend(ohms.at, ohms)
    first_ohm = _first(grown, ohms)
    cycles = full_cycles(ordered, rated) if ordered and rated == rated else np.zeros(len(ordered))
    at = np.array([one.at for one in ordered])
    return warned(
        Ageing(
            rated_ah=rated,
            first_ohm=first_ohm,
            threshold=threshold,
            capacity=_aged(known, trend, at, cycles, threshold * rated, falling=True),
            resistance=_aged(ohms, grown, at, cycles, TWICE * first_ohm, falling=False),
            cycles=float(cycles[-1]) if len(cycles) and cycles[-1] > 0.0 else None,
            tests=tuple(_compared(test, trend) for test in sorted(tests, key=lambda one: one.at)),
            used_tests=use_tests and bool(tests),
        )
    )


def _aged(
    points: Points, trend: Trend | None, at: FloatArray, cycles: FloatArray, limit: float, *, falling: bool
) -> Aged:
    passed = np.interp(points.at, at, cycles) if len(at) else points.at
    by_cycles = _trend(passed, points)
    return Aged(
        points=points,
        trend=trend,
        by_cycles=by_cycles,
        remaining=None if trend is None else remaining(trend, limit, falling=falling),
        remaining_cycles=None if by_cycles is None else remaining(by_cycles, limit, falling=falling),
    )


def _trend(x: FloatArray, points: Points) -> Trend | None:
    if len(x) < LEAST_POINTS or x[-1] - x[0] < LEAST_SPAN:
        return None
    return fit_trend(x, points.value, points.sd, points.shared_sd)


def _first(trend: Trend | None, points: Points) -> float:
    """Return a value's beginning; NaN where nothing is known."""
    if trend is not None:
        return float(trend.at(np.array([trend.x0]))[0])
    return float(points.value[0]) if len(points.value) else float("nan")


def _compared(test: LabTest, trend: Trend | None) -> Compared:
    if trend is None:
        return Compared(test, None, None, None)
    x = np.array([test.at])
    value, sd = float(trend.at(x)[0]), float(trend.sd(x)[0])
    return Compared(test, value, sd, (test.capacity_ah - value) / float(np.hypot(sd, test.sd_ah)))
