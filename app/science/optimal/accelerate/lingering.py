"""Spending time at a speed: holding it, or speeding up and rolling in turn where fuel power is not convex."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.optimize import brentq

from app.science.optimal.accelerate.hold_kernels import Hold, keeping_w, round_trip, steady
from app.science.optimal.accelerate.integral_kernels import Pricing, integrate
from app.science.optimal.accelerate.kernels import DriveNumbers
from app.science.optimal.accelerate.plan import Phase
from app.science.optimal.accelerate.plan_kernels import knots

LOOKS = 33
NARROWINGS = 40
JUST_ABOVE = 1e-9
"""A car that lingers at exactly its price of time would never leave; this relative distance lets it."""
SAME_POWER = 1e-7
SLOWEST_MPS = 1e-4
"""Below it a car counts as standing."""
CYCLES = (1, 2, 5, 10, 20, 50, 100, 200, 400)
FINE = 1e-6
WIDEST_MPS = 5.0


@dataclass(frozen=True, slots=True)
class Place:
    """A speed and the least average fuel power that keeps about it, W; infinite where it can't be kept."""

    speed_mps: float
    fuel_w: float


@dataclass(frozen=True, slots=True)
class Linger:
    """Time spent about a speed.

    Attributes
    ----------
    place : Place
    seconds : float
    hold : Hold
        One control that holds the speed; of infinite fuel power where none does.
    cycle : tuple of Phase
        Up and down again, where that takes less than holding; else empty.
    cycles : int
    """

    place: Place
    seconds: float
    hold: Hold
    cycle: tuple[Phase, ...] = ()
    cycles: int = 0

    @property
    def fuel_j(self) -> float:
        """Fuel energy of what a driver does, J."""
        if self.cycle:
            return self.cycles * sum(phase.fuel_j for phase in self.cycle)
        return self.hold.fuel_w * self.seconds

    @property
    def distance_m(self) -> float:
        """Distance, m."""
        if self.cycle:
            return self.cycles * sum(phase.distance_m for phase in self.cycle)
        return self.place.speed_mps * self.seconds


def keeping(drive: DriveNumbers, v: float, free_changes: bool) -> Place:
    """Return the least average fuel power about a speed."""
    return Place(v, float(keeping_w(v, free_changes, drive)))


def looked_over(drive: DriveNumbers, slow_mps: float, fast_mps: float, free_changes: bool) -> list[Place]:
    """Return places between two speeds, slow ones first, both sides of every limit included."""
    marks = knots(slow_mps, fast_mps, np.nan, drive)
    inset = 1e-9 * fast_mps
    speeds = np.unique(np.concatenate((np.linspace(slow_mps, fast_mps, LOOKS), marks, marks - inset, marks + inset)))
    return [keeping(drive, float(v), free_changes) for v in speeds if slow_mps <= v <= fast_mps]


def cheapest_place(drive: DriveNumbers, slow_mps: float, fast_mps: float, free_changes: bool) -> Place:
    """Return where lingering is cheapest between two speeds."""
    places = looked_over(drive, slow_mps, fast_mps, free_changes)
    powers = [place.fuel_w for place in places]
    at = int(np.argmin(powers))
    best = places[at]
    low, high = places[max(at - 1, 0)].speed_mps, places[min(at + 1, len(places) - 1)].speed_mps
    for _ in range(NARROWINGS):
        third = (high - low) / 3.0
        one, two = (keeping(drive, low + k * third, free_changes) for k in (1, 2))
        best = min(best, one, two, key=lambda place: place.fuel_w)
        low, high = (low, high - third) if one.fuel_w < two.fuel_w else (low + third, high)
    return best


def linger(drive: DriveNumbers, place: Place, seconds: float, total_j: float, free_changes: bool) -> Linger:
    """Return how a driver spends time at a place; ``total_j`` is what the whole drive burns.

    Where two controls in turn beat one, the infimum is reached in the limit of infinitely many cycles only; as many are
    made as bring the drive within `FINE` of it, four hundred at most.
    """
    hold = steady(place.speed_mps, drive)
    whole = Linger(place, seconds, hold)
    if seconds <= 0.0 or hold.fuel_w <= place.fuel_w * (1.0 + SAME_POWER):
        return whole
    turn = round_trip(place.speed_mps, -place.fuel_w * (1.0 - JUST_ABOVE), free_changes, drive)
    for count in CYCLES:
        cycle = _cycle(drive, place, seconds / count, (turn.up, turn.down))
        if cycle:
            whole = Linger(place, seconds, hold, cycle, count)
            if whole.fuel_j - place.fuel_w * seconds <= FINE * total_j:
                break
    return whole


def _cycle(drive: DriveNumbers, place: Place, seconds: float, gears: tuple[int, int]) -> tuple[Phase, ...]:
    """Return the way up from a speed and down again that takes a given time; empty where gears don't reach."""
    v, mu = place.speed_mps, -place.fuel_w * (1.0 - JUST_ABOVE)

    def ways(band: float) -> tuple[Phase, ...]:
        found = []
        for gear, sign in zip(gears, (1.0, -1.0), strict=True):
            price = Pricing(mu, 1.0, sign, np.nan)
            ends = (v, v + band) if sign > 0.0 else (v + band, v)
            sums = integrate(gear, v, v + band, price, drive)
            found.append(Phase(gear, *ends, (), *sums, price))
        return tuple(found)

    def longer(band: float) -> float:
        return sum(phase.time_s for phase in ways(band)) - seconds

    band = 1e-6 * v
    while longer(band) < 0.0:
        band *= 2.0
        if band > v + WIDEST_MPS:
            return ()
    if not np.isfinite(longer(band)):
        return ()
    return ways(float(brentq(longer, 0.5 * band if band > 1e-6 * v else 1e-9 * v, band, xtol=1e-15 * v, rtol=1e-14)))
