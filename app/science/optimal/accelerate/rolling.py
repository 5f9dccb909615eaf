"""Slowing down and rising once where shifts are charged: the speed to turn at, each with a price of its own."""

from __future__ import annotations

import math
from itertools import pairwise

import numpy as np

from app.science.optimal.accelerate.exact_time import MISSED, Makes, Request, price_of
from app.science.optimal.accelerate.plan import Plan, plan

LOOKS = 13
NARROWINGS = 6
FIRST_W = 200.0
WIDEST_W = 1e7


def best_turn(request: Request, lowest_mps: float) -> tuple[Plan, Plan, float] | None:
    """Return the way down, the way up and the price of time of the cheapest drive that turns once; None without any.

    Parameters
    ----------
    request : Request
    lowest_mps : float
        Lowest speed the car can turn at.
    """
    low, high = lowest_mps, request.slow_mps
    best: tuple[float, float, tuple[Plan, Plan, float]] | None = None
    for count in (LOOKS, *(3 for _ in range(NARROWINGS))):
        speeds = np.linspace(low, high, count + 2)[:-1] if count == LOOKS else np.linspace(low, high, count + 2)[1:-1]
        for v in speeds.tolist():
            found = turning_at(request, v)
            if found is not None and (best is None or _taken(request, found) < best[0]):
                best = (_taken(request, found), v, found)
        if best is None:
            return None
        step = float(speeds[1] - speeds[0])
        low, high = max(best[1] - step, lowest_mps), min(best[1] + step, request.slow_mps)
    return best[2] if best is not None else None


def turning_at(request: Request, turn_mps: float) -> tuple[Plan, Plan, float] | None:
    """Return the way down, the way up and the price of time of a drive that turns at a speed; None where it can't."""
    charge = request.shift_cost_j

    def ways(mu: float) -> tuple[Plan, Plan] | None:
        down = plan(request.drive, turn_mps, request.slow_mps, mu, sign=-1.0, shift_cost_j=charge)
        up = plan(request.drive, turn_mps, request.fast_mps, mu, shift_cost_j=charge)
        return (down, up) if down is not None and up is not None else None

    def joined(mu: float) -> Plan | None:
        both = ways(mu)
        return Plan((*both[0].phases, *both[1].phases)) if both is not None else None

    make = Makes(joined)

    def off(mu: float) -> float:
        way = make(mu)
        return math.inf if way is None else way.time_s - request.time_s

    if not math.isfinite(off(0.0)):
        return None
    step = FIRST_W if off(0.0) > 0.0 else -FIRST_W
    while abs(step) < WIDEST_W and (off(step) > 0.0) == (step > 0.0):
        step *= 4.0
    if (off(step) > 0.0) == (step > 0.0):
        return None
    mu = price_of(make, request.time_s, min(0.0, step), max(0.0, step))
    both = ways(mu)
    return (*both, mu) if both is not None and abs(off(mu)) < MISSED * request.time_s else None


def _taken(request: Request, found: tuple[Plan, Plan, float]) -> float:
    """Return fuel and charges, J; the change of gear at the turn is one, too."""
    sequence = [phase.gear for part in found[:2] for phase in part.phases]
    changes = sum(one != two for one, two in pairwise(sequence))
    return found[0].fuel_j + found[1].fuel_j + request.shift_cost_j * changes
