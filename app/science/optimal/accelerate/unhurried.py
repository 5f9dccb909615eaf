"""More time than the cheapest drive takes: slower upwards, or lingering where that is cheapest (Sebesta 2010, 4.4.2.2).

More time has a negative price μ. As long as −μ stays below the least average fuel power P_c that keeps any speed on the
way, the drive only rises more slowly. Then time is spent at a speed: on the way, or below the start, to which the car
first slows down as long as P_c falls with speed.
"""

from __future__ import annotations

import math
from itertools import pairwise

import numpy as np
from scipy.optimize import brentq

from app.science.optimal.accelerate.exact_time import MISSED, Request, on_time, price_of
from app.science.optimal.accelerate.hold_kernels import round_trip
from app.science.optimal.accelerate.kernels import DriveNumbers
from app.science.optimal.accelerate.lingering import (
    JUST_ABOVE,
    SLOWEST_MPS,
    Linger,
    Place,
    cheapest_place,
    keeping,
    linger,
    looked_over,
)
from app.science.optimal.accelerate.numbers import speed_range_mps
from app.science.optimal.accelerate.plan import Plan, plan
from app.science.optimal.accelerate.rolling import best_turn
from app.science.optimal.problem import Infeasible

Parts = tuple[Plan, Plan, Linger | None, Plan, float, float]
"""Slowing, rise before lingering, lingering, rise, price of time and lower bound, as `Solution` takes them."""

NOTHING = Plan(())
LONGEST_W = 1e9
LONGEST_S = 1e6


def unhurried(request: Request) -> Parts:
    """Return the parts of the drive; the cheaper of lingering on the way and of slowing down first.

    Raises
    ------
    Infeasible
        When the engine's lowest torque pushes the car on, so that the time can't be spent.
    """
    free_changes = request.shift_cost_j == 0.0
    here = cheapest_place(request.drive, max(request.slow_mps, SLOWEST_MPS), request.fast_mps, free_changes)
    if not math.isfinite(here.fuel_w):
        return _without_stay(request)
    found = [_on_the_way(request, here, free_changes), *_below(request, here, free_changes)]
    parts = min(found, key=lambda one: _taken(request, one))
    if not math.isfinite(_taken(request, parts)):
        raise Infeasible(f"{request.time_s:g} s can't be spent: no control and no two in turn keep a speed.", "time_s")
    return (*parts[:5], _bound(request, parts[4]))


def _taken(request: Request, parts: Parts) -> float:
    """Return fuel and charges, J."""
    slowing, before, stay, rising, _, _ = parts
    held = [stay.cycle[0].gear if stay.cycle else stay.hold.gear] if stay else []
    gears = [*slowing.sequence, *before.sequence, *held, *rising.sequence]
    changes = sum(one != two for one, two in pairwise(gears))
    stayed = stay.fuel_j if stay else 0.0
    return slowing.fuel_j + before.fuel_j + stayed + rising.fuel_j + changes * request.shift_cost_j


def _bound(request: Request, mu: float) -> float:
    """Return what no drive can take less than, J: by a price at which staying pays at no speed."""
    lowest = max(speed_range_mps(request.drive)[0], SLOWEST_MPS)
    everywhere = cheapest_place(request.drive, min(lowest, request.slow_mps), request.fast_mps, free_changes=True)
    mu = max(mu, -everywhere.fuel_w * (1.0 - JUST_ABOVE))
    way = request.at(mu)
    return -math.inf if way is None else request.charged(way) + mu * (way.time_s - request.time_s)


def _without_stay(request: Request) -> Parts:
    """Rise as slowly as the lowest torque lets the car."""
    slowest = plan(request.drive, request.slow_mps, request.fast_mps, -1.0, weight=0.0)
    longest = slowest.time_s if slowest is not None else math.nan
    if slowest is None or longest < request.time_s:
        raise Infeasible(
            f"{request.time_s:g} s are too long by {request.time_s - longest:.4g} s: at its lowest torque the engine "
            f"still drives the car up within {longest:.5g} s, and there is no neutral to roll in.",
            "time_s",
        )
    low = -1e4
    while low > -LONGEST_W:
        way = request.at(low)
        if way is not None and way.time_s >= request.time_s:
            break
        low *= 8.0
    found = on_time(request, low, 0.0)
    return NOTHING, NOTHING, None, found.way, found.mu_w, found.bound_j


def _on_the_way(request: Request, here: Place, free_changes: bool) -> Parts:
    """Rise more slowly, and stay at the cheapest place on the way for what is left of the time."""
    pinned = Request(
        request.drive, request.slow_mps, request.fast_mps, request.time_s, request.shift_cost_j, here.speed_mps
    )
    bottom = -here.fuel_w * (1.0 - JUST_ABOVE)
    slow = pinned.at(bottom)
    if slow is None or slow.time_s >= request.time_s:  # none: it only nears a speed that its lowest torque holds
        found = on_time(pinned, bottom, 0.0)
        if abs(found.way.time_s - request.time_s) < MISSED * request.time_s:
            return NOTHING, NOTHING, None, found.way, found.mu_w, found.bound_j
    before, after = _in_time(request, here.speed_mps, bottom)
    left = request.time_s - before.time_s - after.time_s
    stay = linger(request.drive, here, left, before.fuel_j + after.fuel_j + here.fuel_w * left, free_changes)
    return NOTHING, before, stay, after, -here.fuel_w, 0.0


def _in_time(request: Request, stay_mps: float, mu: float) -> tuple[Plan, Plan]:
    """Return the ways up to a speed and on from there at nearly a price; at the price itself they may never arrive."""
    charge = request.shift_cost_j
    for share in (0.0, *np.geomspace(1e-12, 0.3, 40).tolist()):
        price = mu * (1.0 - share)
        before = plan(request.drive, request.slow_mps, stay_mps, price, shift_cost_j=charge)
        after = plan(request.drive, stay_mps, request.fast_mps, price, shift_cost_j=charge)
        if before is not None and after is not None and before.time_s + after.time_s <= request.time_s:
            return before, after
    raise Infeasible(f"{request.time_s:g} s can't be spent on the way up; allow neutral, or another time.", "time_s")


def _below(request: Request, here: Place, free_changes: bool) -> list[Parts]:
    """Slow down first, as far as the time and falling fuel power allow; nothing where that can't be, or doesn't pay."""
    bottom = _lowest_reached(request.drive, request.slow_mps)
    if bottom >= request.slow_mps:
        return []
    turn = best_turn(request, bottom) if request.shift_cost_j > 0.0 else None
    turned = [(turn[0], NOTHING, None, turn[1], turn[2], 0.0)] if turn is not None else []
    cheaper: list[Place] = []
    for place in reversed(looked_over(request.drive, bottom, request.slow_mps, free_changes)):
        if place.fuel_w < (cheaper[-1].fuel_w if cheaper else here.fuel_w) * (1.0 - 1e-12):
            cheaper.append(place)
    short = None
    for place in cheaper:
        mu = -place.fuel_w * (1.0 - JUST_ABOVE)
        if _there_and_up(request, place.speed_mps, mu)[2] > request.time_s:
            turning = _turning(request, short, place, free_changes)
            staying = _staying(request, short, free_changes) if short else None
            return [*turned, *(one for one in (turning, staying) if one is not None)]
        short = place
    return [*turned, *([_staying(request, cheaper[-1], free_changes)] if cheaper else [])]


def _staying(request: Request, place: Place, free_changes: bool) -> Parts:
    """Slow down to a place, stay there for what is left of the time, and rise."""
    slowing, rising, taken = _there_and_up(request, place.speed_mps, -place.fuel_w * (1.0 - JUST_ABOVE))
    left = request.time_s - taken
    total = slowing.fuel_j + rising.fuel_j + place.fuel_w * left
    return slowing, NOTHING, linger(request.drive, place, left, total, free_changes), rising, -place.fuel_w, 0.0


def _turning(request: Request, short: Place | None, long: Place, free_changes: bool) -> Parts | None:
    """Turn at the speed from which the drive just takes the time at the price of staying there."""
    above = short.speed_mps if short else request.slow_mps

    def longer(v: float) -> float:
        mu = -keeping(request.drive, v, free_changes).fuel_w * (1.0 - JUST_ABOVE)
        return min(_there_and_up(request, v, mu)[2] - request.time_s, LONGEST_S)

    turn = long.speed_mps
    if longer(above) < 0.0:
        turn = float(brentq(longer, turn, above, xtol=1e-12 * above, rtol=1e-14))
    mu = -keeping(request.drive, turn, free_changes).fuel_w * (1.0 - JUST_ABOVE)

    def make(price: float) -> Plan | None:
        slowing, rising, taken = _there_and_up(request, turn, price)
        return Plan((*slowing.phases, *rising.phases)) if math.isfinite(taken) else None

    def too_short(share: float) -> bool:
        way = make(mu * share)
        return way is not None and way.time_s < request.time_s

    cheap, dear = 1.0, 1.0
    while too_short(cheap) and cheap < 4.0:
        cheap = 1.0 + 2.0 * max(cheap - 1.0, 1e-9)
    while not too_short(dear) and dear > 1e-6:
        dear = 1.0 - 2.0 * max(1.0 - dear, 1e-9)
    if too_short(cheap) or not too_short(dear):
        return None
    price = price_of(make, request.time_s, mu * cheap, mu * dear)
    slowing, rising, taken = _there_and_up(request, turn, price)
    if abs(taken - request.time_s) > MISSED * request.time_s:
        return None
    return slowing, NOTHING, None, rising, price, 0.0


def _there_and_up(request: Request, turn: float, mu: float) -> tuple[Plan, Plan, float]:
    """Return the way down to a speed, the way up from it, and the time of both; infinite where there is none."""
    charge = request.shift_cost_j
    slowing = plan(request.drive, turn, request.slow_mps, mu, sign=-1.0, shift_cost_j=charge)
    rising = plan(request.drive, turn, request.fast_mps, mu, shift_cost_j=charge)
    if slowing is None or rising is None:
        return NOTHING, NOTHING, math.inf
    return slowing, rising, slowing.time_s + rising.time_s


def _lowest_reached(drive: DriveNumbers, start: float) -> float:
    """Return the lowest speed to which the car can slow down and from which it can rise again."""

    def turns(v: float) -> bool:
        return bool(round_trip(v, 0.0, True, drive).cost < math.inf)

    lowest = max(speed_range_mps(drive)[0], SLOWEST_MPS)
    if lowest >= start or not turns(start * (1.0 - 1e-9)):
        return start
    reached = start
    for v in np.linspace(start * (1.0 - 1e-9), lowest * (1.0 + 1e-12), 65):
        if not turns(float(v)):
            low, high = float(v), reached
            while high - low > 1e-10 * start:
                middle = 0.5 * (low + high)
                low, high = (low, middle) if turns(middle) else (middle, high)
            return high
        reached = float(v)
    return reached
