"""A cruise by two controls in turn as somebody could drive it: so many pulses and glides about the cruising speed."""

from __future__ import annotations

from math import ceil, sqrt

from scipy.optimize import brentq

from app.science.optimal.distance.extremals import Cruise, Extremal
from app.science.optimal.distance.legs import Car, legs

EXCESS = 2e-5
"""Of the fuel: pulses are made short enough to burn no more than that above what infinitely short ones would."""
MOST = 2000


def pulsed(car: Car, from_mps: float, bound: Extremal, cruise: Cruise) -> Extremal:
    """Return a drive of the same length with the fewest pulses whose fuel is near the bound."""
    count = 1
    found = _with_pulses(car, from_mps, bound, cruise, count)
    while found is None or (count < MOST and found.fuel_j > (1.0 + EXCESS) * bound.fuel_j):
        over = 4.0 if found is None else (found.fuel_j / bound.fuel_j - 1.0) / EXCESS
        count = min(max(count + 1, ceil(count * sqrt(over))), 100 * MOST if found is None else MOST)
        found = _with_pulses(car, from_mps, bound, cruise, count)
    return found


def _with_pulses(car: Car, from_mps: float, bound: Extremal, cruise: Cruise, count: int) -> Extremal | None:
    """Return the drive with so many pulses; None where they would have to be too wide."""
    start, end = from_mps, bound.away[-1].to_mps
    middle, price = cruise.speed_mps, bound.price_n

    def drive(width: float) -> Extremal:
        low, high = middle - width, middle + width
        turn, other = (high, low) if start < high else (low, high)
        there, away = legs(car, start, turn, price), legs(car, turn, end, price)
        pair = legs(car, turn, other, price) + legs(car, other, turn, price)
        return Extremal("pulses", there + pair * count, away, price)

    wanted = bound.distance_m
    widest = 0.999 * (middle - end)
    if not drive(widest).distance_m >= wanted:
        return None
    tightest = 1e-9 * middle
    if drive(tightest).distance_m >= wanted:
        return drive(tightest)
    return drive(float(brentq(lambda width: drive(width).distance_m - wanted, tightest, widest, xtol=1e-13)))
