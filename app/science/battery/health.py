"""What a history of estimates says of a battery's health, as points that don't repeat one another."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from app.science.arrays import FloatArray
from app.science.battery.carrying import CAPACITY_PER_ROOT_DAY

LEAST_NEWS = 0.02
"""An estimate that makes a value less uncertain by less than this share of its variance says nothing new."""

SUREST = 1e-4
"""No capacity is known better than by this share of itself."""


@dataclass(frozen=True, slots=True)
class HealthPoint:
    """What one trip, file or test says of a cell.

    Attributes
    ----------
    at : float
        Days, from any day.
    capacity_ah, capacity_sd, resistance_ohm, resistance_sd : float
        Of one cell, and their standard deviations; NaN where nothing is said.
    charge_ah : float
        What went through the cell since the point before, in and out in all; NaN where that isn't known.
    carried : bool
        Whether the estimate began with what the point before knew.
    """

    at: float
    capacity_ah: float
    capacity_sd: float
    resistance_ohm: float = float("nan")
    resistance_sd: float = float("nan")
    charge_ah: float = float("nan")
    carried: bool = True


@dataclass(frozen=True, slots=True)
class LabTest:
    """A capacity measured in a laboratory, of one cell; ``sd_ah`` is its standard deviation."""

    at: float
    capacity_ah: float
    sd_ah: float


@dataclass(frozen=True, slots=True)
class Points:
    """Values over days with standard deviations that are independent of one another, each (n,).

    ``shared_sd`` is what all of them may be off by together.
    """

    at: FloatArray
    value: FloatArray
    sd: FloatArray
    shared_sd: float = 0.0


def capacities(points: Sequence[HealthPoint]) -> Points:
    """Return the capacities, each freed of what it took over from the one before.

    What they share nevertheless, a current sensor that is always off by the same, is no less than the least of their
    standard deviations.
    """
    known = _news([(one.at, one.capacity_ah, one.capacity_sd, one.carried) for one in points])
    shared = [one.capacity_sd for one in points if one.carried and one.capacity_sd > 0.0]
    return replace(known, shared_sd=min(shared, default=0.0))


def resistances(points: Sequence[HealthPoint]) -> Points:
    """Return the resistances: after a pause nothing is taken over that would count beside what a trip tells."""
    return _news([(one.at, one.resistance_ohm, one.resistance_sd, False) for one in points])


def full_cycles(points: Sequence[HealthPoint], rated_ah: float) -> FloatArray:
    """Return equivalent full cycles up to each point, (n,): charge that went through over twice the rated capacity.

    What a point doesn't know counts as nothing, so they are the ones that were seen.
    """
    charge = np.array([one.charge_ah for one in points], dtype=np.float64)
    return np.asarray(np.cumsum(np.where(np.isfinite(charge), charge, 0.0)) / (2.0 * rated_ah))


def joined(points: Points, tests: Sequence[LabTest]) -> Points:
    """Return points with laboratory tests among them, in order of time."""
    at = np.concatenate([points.at, [one.at for one in tests]])
    order = np.argsort(at, kind="stable")
    value = np.concatenate([points.value, [one.capacity_ah for one in tests]])
    sd = np.concatenate([points.sd, [max(one.sd_ah, SUREST * one.capacity_ah) for one in tests]])
    return Points(at[order], value[order], sd[order], points.shared_sd)


def _news(rows: Sequence[tuple[float, float, float, bool]]) -> Points:
    """Undo the filtering: what a point says beyond the one that it began with, in logarithms.

    A carried estimate m_k, P_k is what the one before (m, P) became by a random walk, P + w² Δt, joined with something
    new (y, r): 1/P_k = 1/(P + w² Δt) + 1/r, and m_k/P_k likewise. That is solved for y and r.
    """
    kept: list[tuple[float, float, float]] = []
    before: tuple[float, float, float] | None = None
    for at, value, sd, carried in rows:
        if not (np.isfinite(value) and value > 0.0 and 0.0 < sd < value):  # less sure than ±100 % says nothing
            continue
        mean, variance = float(np.log(value)), max(sd / value, SUREST) ** 2
        news = (mean, variance)
        if carried and before is not None:
            prior = before[2] + CAPACITY_PER_ROOT_DAY**2 * max(at - before[0], 0.0)
            gained = 1.0 / variance - 1.0 / prior
            news = ((mean / variance - before[1] / prior) / gained, 1.0 / gained) if gained > 0.0 else (mean, np.inf)
        before = (at, mean, variance)
        if news[1] < variance / LEAST_NEWS:
            kept.append((at, *news))
    table = np.array(kept, dtype=np.float64).reshape(-1, 3)
    middle = np.exp(table[:, 1])
    return Points(table[:, 0], middle, middle * np.sqrt(table[:, 2]))
