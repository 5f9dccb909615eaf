"""A drive that takes exactly the time it is given: the price of time is found, by gears where shifts are charged."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
from scipy.optimize import brentq

from app.science.optimal.accelerate.integral_kernels import Pricing
from app.science.optimal.accelerate.kernels import DriveNumbers
from app.science.optimal.accelerate.plan import Plan, plan, plan_along
from app.science.optimal.accelerate.plan_kernels import everything
from app.science.optimal.problem import Infeasible

ON_TIME = 1e-10
MISSED = 1e-7
WIDEST_W = 1e9
MOST_SEQUENCES = 200


@dataclass(frozen=True, slots=True)
class Request:
    """Up from one speed to another in a time, with a charge for each change of gear."""

    drive: DriveNumbers
    slow_mps: float
    fast_mps: float
    time_s: float
    shift_cost_j: float
    pin_mps: float = np.nan

    def at(self, mu: float) -> Plan | None:
        """Return the plan for a price of time."""
        return plan(self.drive, self.slow_mps, self.fast_mps, mu, shift_cost_j=self.shift_cost_j, pin_mps=self.pin_mps)

    def charged(self, way: Plan) -> float:
        """Return fuel and charges of a plan, J."""
        return way.fuel_j + self.shift_cost_j * max(len(way.phases) - 1, 0)


@dataclass(frozen=True, slots=True)
class Priced:
    """A plan that takes the time, its price of a second, and a lower bound on fuel and charges of any drive, J."""

    way: Plan
    mu_w: float
    bound_j: float


class Makes:
    """Plans by their price of time, each made once."""

    def __init__(self, make: Callable[[float], Plan | None]) -> None:
        self._make = make
        self._made: dict[float, Plan | None] = {}

    def __call__(self, mu: float) -> Plan | None:
        """Return the plan for a price."""
        if mu not in self._made:
            self._made[mu] = self._make(mu)
        return self._made[mu]


def price_of(make: Callable[[float], Plan | None], time_s: float, low: float, high: float) -> float:
    """Return the price between two for which a plan takes a time; at a jump, the price of the jump."""

    def longer(mu: float) -> float:
        way = make(mu)
        off = (np.inf if way is None else way.time_s) - time_s
        return 0.0 if abs(off) < ON_TIME * time_s else max(min(off, 1e6), -1e6)

    return float(brentq(longer, low, high, xtol=1e-12 * max(abs(low), abs(high)), rtol=8.9e-16, maxiter=200))


def on_time(request: Request, low: float, high: float, make: Makes | None = None) -> Priced:
    """Return the cheapest plan that takes the time; between the two prices it must pass from too long to too short.

    Charges for shifts make the sequence of gears, and with it the time, jump at some price. There every sequence whose
    Lagrangian does not rule it out is priced for itself (weak duality: what a sequence costs at any price of time,
    less that price times the time, bounds what it takes from below).
    """
    make = make or Makes(request.at)
    mu = price_of(make, request.time_s, low, high)
    way = make(mu)
    if way is None:  # beyond a jump the car never arrives: take the price on this side
        mu = mu + 1e-9 * abs(mu)
        way = make(mu)
    if way is None:
        raise Infeasible(f"no price of time gives a drive of {request.time_s:g} s; take another time.", "time_s")
    bound = request.charged(way) + mu * (way.time_s - request.time_s)
    if abs(way.time_s - request.time_s) < MISSED * request.time_s:
        return Priced(way, mu, bound)
    best: Priced | None = None
    for lagrangian, sequence in _sequences(request, mu):
        if best is not None and lagrangian >= request.charged(best.way):
            break
        found = _along(request, sequence, mu, bound)
        if found is not None and (best is None or request.charged(found.way) < request.charged(best.way)):
            best = found
    return best if best is not None else Priced(way, mu, bound)


def _along(request: Request, sequence: Sequence[int], near: float, bound: float) -> Priced | None:
    """Price one sequence of gears; None where it can't take the time."""

    make = Makes(lambda mu: plan_along(request.drive, request.slow_mps, request.fast_mps, mu, sequence))
    here = make(near)
    if here is None:
        return None
    step = 0.1 * abs(near) + 100.0
    too_long = here.time_s > request.time_s
    low = high = near
    while step < WIDEST_W:
        other = near + step if too_long else near - step
        way = make(other)
        if way is None:
            return None
        if (way.time_s > request.time_s) != too_long:
            low, high = min(near, other), max(near, other)
            mu = price_of(make, request.time_s, low, high)
            found = make(mu)
            on = found is not None and abs(found.time_s - request.time_s) < MISSED * request.time_s
            return Priced(found, mu, bound) if found is not None and on else None
        step *= 3.0
    return None


def _sequences(request: Request, mu: float) -> list[tuple[float, tuple[int, ...]]]:
    """Return sequences of gears with their Lagrangian at a price, the most promising first."""
    _, sums = everything(request.slow_mps, request.fast_mps, Pricing(mu, 1.0, 1.0, np.nan), request.drive)
    costs = sums[:, :, 0]
    labels: dict[tuple[int, ...], float] = {
        (int(gear),): float(costs[0, gear]) for gear in np.flatnonzero(np.isfinite(costs[0]))
    }
    for row in costs[1:]:
        after: dict[tuple[int, ...], float] = {}
        for sequence, cost in labels.items():
            for gear in np.flatnonzero(np.isfinite(row)):
                longer = sequence if sequence[-1] == gear else (*sequence, int(gear))
                charge = 0.0 if longer is sequence else request.shift_cost_j
                total = cost + charge + float(row[gear])
                if total < after.get(longer, np.inf):
                    after[longer] = total
        kept = sorted(after.items(), key=lambda item: item[1])[:MOST_SEQUENCES]
        labels = dict(kept)
    return sorted((cost - mu * request.time_s, sequence) for sequence, cost in labels.items())
