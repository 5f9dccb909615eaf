"""All drives over a distance that Pontryagin's principle allows, and the one that burns least.

At a price of distance λ_x a drive ends where λ_v = 0: at the speed F_min/λ_x. Before that it may

- run straight to its end, in one direction;
- speed up, turn round where holding the speed costs as much as it brings, P_c(v) = λ_x v, and coast to its end;
- go to the speed v_c at which a metre costs least, stay as long as needed at λ_x = P_c(v_c)/v_c, and coast to its end.

P_c(v) is the least mean fuel power that keeps a speed. Brakes never pay: λ_v ≥ 0, because F_min ≥ 0 burns on as long as
the drive takes. Each family is searched for every drive of the wanted length; the cheapest of all is the optimum.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np
from scipy.optimize import brentq, minimize_scalar

from app.science.arrays import FloatArray
from app.science.optimal.distance.legs import Car, Leg, legs

LOOKS = 40
CLOSE = 3e-6
"""Of the cruising speed: nearer to it than that, the car is taken to have reached it; that costs the square of it."""
SAME = 1e-6


@dataclass(frozen=True, slots=True)
class Cruise:
    """The speed at which a metre costs least.

    Attributes
    ----------
    speed_mps, price_n : float
        The second is λ_x, J for a metre.
    low_w, high_w : float
        Powers at the wheels of two controls in turn; the same where one keeps the speed.
    at_end_of_curve : bool
        Whether the speed is the one that the least fuel power itself keeps.
    marginal : float
        Fuel power for one more watt at the wheels there.
    """

    speed_mps: float
    price_n: float
    low_w: float
    high_w: float
    at_end_of_curve: bool
    marginal: float

    @property
    def in_turns(self) -> bool:
        """Whether only two controls in turn reach it."""
        return self.high_w > self.low_w


@dataclass(frozen=True, slots=True)
class Extremal:
    """A drive of legs, with a cruise of ``held_m`` metres between those of ``there`` and those of ``away``.

    Attributes
    ----------
    family : {"straight", "turn", "cruise", "pulses"}
    there, away : tuple of Leg
    price_n : float
    held_m, held_mps, held_j : float
    """

    family: str
    there: tuple[Leg, ...]
    away: tuple[Leg, ...]
    price_n: float
    held_m: float = 0.0
    held_mps: float = 0.0
    held_j: float = 0.0

    @property
    def legs(self) -> tuple[Leg, ...]:
        """All legs, in driving order."""
        return self.there + self.away

    @property
    def fuel_j(self) -> float:
        """Fuel energy, J."""
        return sum(part.fuel_j for part in self.legs) + self.held_j

    @property
    def time_s(self) -> float:
        """Time, s."""
        return sum(part.time_s for part in self.legs) + (self.held_m / self.held_mps if self.held_m else 0.0)

    @property
    def distance_m(self) -> float:
        """Distance, m."""
        return sum(part.distance_m for part in self.legs) + self.held_m


def coasting_speed_mps(car: Car) -> float:
    """Return the speed that the least fuel power keeps; 0 where it pushes nothing."""
    power, _ = car.curve.cheapest_w(0.0)
    if power <= 0.0:
        return 0.0
    roots = np.roots([car.load.drag_kgpm, 0.0, car.load.rolling_n, -power])
    return float(max(root.real for root in roots if abs(root.imag) <= 1e-9 * abs(root)))


def top_speed_mps(car: Car) -> float:
    """Return the highest speed that can be kept; 0 where none can."""

    def spare(v: float) -> float:
        return car.curve.strongest_w(v) - v * car.load.resistance_n(v)

    speeds = np.geomspace(0.01, 500.0, 200)
    able = [v for v in speeds if spare(v) > 0.0]
    return float(brentq(spare, able[-1], 1e6)) if able else 0.0


def cheapest_cruise(car: Car) -> Cruise | None:
    """Return where a metre costs least; None where no speed can be kept."""
    low, high = max(coasting_speed_mps(car), 1e-3), top_speed_mps(car)
    if high <= low:
        return None

    def price(v: float) -> float:
        at = np.array([v])
        return float(car.curve.mixture(at, car.resisted_w(at)).fuel_w[0] / v)

    low *= 1.0 + 1e-12
    speeds = np.linspace(low, high * (1.0 - 1e-9), 400)
    prices = np.array([price(v) for v in speeds])
    k = int(prices.argmin())
    found = minimize_scalar(
        price, bounds=(speeds[max(k - 1, 0)], speeds[min(k + 1, 399)]), method="bounded", options={"xatol": 1e-11}
    )
    corner = k == 0 and price(low) <= found.fun
    v = low if corner else float(found.x)
    mixed = car.curve.mixture(np.array([v]), car.resisted_w(np.array([v])))
    powers = float(mixed.low_w[0]), float(mixed.high_w[0])
    if corner:
        powers = (powers[0], powers[0])
    # where a metre costs least, its price is the marginal fuel power times d(resisted power)/dv
    slope = 3.0 * car.load.drag_kgpm * v**2 + car.load.rolling_n
    return Cruise(v, price(v), *powers, corner, price(v) / slope)


def extremals(car: Car, from_mps: float, distance_m: float, cruise: Cruise | None) -> list[Extremal]:
    """Return every drive of that length that the principle allows."""
    end = _Ends(car, from_mps, cruise)
    found = _of_length(distance_m, end.straight_range(), end.straight)
    if cruise is None:
        return found
    if from_mps < cruise.speed_mps:
        found += _of_length(distance_m, end.turn_range(), end.turn)
    held = end.cruise()
    if held is not None and held.distance_m <= distance_m:
        more = distance_m - held.distance_m
        found.append(replace(held, held_m=more, held_j=held.held_j + more * cruise.price_n))
    return found


@dataclass(frozen=True, slots=True)
class _Ends:
    """Builds each family's drive from the one number that it has left open."""

    car: Car
    from_mps: float
    best: Cruise | None

    def straight_range(self) -> FloatArray:
        """Speeds at the end of a straight drive, from the shortest drive to the longest."""
        start, rest = self.from_mps, coasting_speed_mps(self.car)
        if start < rest:
            return _towards(max(start, 1e-6 * rest), rest)
        if start == 0.0:
            return np.zeros(0)
        _, least = self.car.curve.cheapest_w(start)
        last = rest
        if self.best is not None:
            at = np.array([start])
            kept = float(self.car.curve.mixture(at, self.car.resisted_w(at)).fuel_w[0]) / start
            price = self.best.price_n if start >= self.best.speed_mps or not np.isfinite(kept) else kept
            last = max(least / price, rest)
        return _towards(start, last)

    def straight(self, last_mps: float) -> Extremal:
        """Return the drive to a speed at its end."""
        _, least = self.car.curve.cheapest_w(last_mps)
        price = least / last_mps
        start = self.from_mps
        middle = self.best.speed_mps if self.best is not None else start
        if not last_mps < middle < start:
            return Extremal("straight", legs(self.car, start, last_mps, price), (), price)
        there, away = legs(self.car, start, middle, price), legs(self.car, middle, last_mps, price)
        return Extremal("straight", there + away, (), price)

    def turn_range(self) -> FloatArray:
        """Speeds at which a drive turns round, from the start to the cruise."""
        low = max(self.from_mps, coasting_speed_mps(self.car), 1e-3)
        return _towards(low, self._best().speed_mps)

    def turn(self, turn_mps: float) -> Extremal:
        """Return the drive that speeds up to a speed and coasts from there."""
        at = np.array([turn_mps])
        price = float(self.car.curve.mixture(at, self.car.resisted_w(at)).fuel_w[0] / turn_mps)
        _, least = self.car.curve.cheapest_w(turn_mps)
        there = legs(self.car, self.from_mps, turn_mps, price)
        return Extremal("turn", there, legs(self.car, turn_mps, min(least / price, turn_mps), price), price)

    def cruise(self) -> Extremal | None:
        """Return the drive to the cruise and, at once, from it to the end."""
        best = self._best()
        _, least = self.car.curve.cheapest_w(best.speed_mps)
        near = 0.0 if best.in_turns else CLOSE * best.speed_mps
        start, v, price = self.from_mps, best.speed_mps, best.price_n
        arrival = start if abs(start - v) <= near else v + near * float(np.sign(start - v))
        there = legs(self.car, start, arrival, price)
        leaving = arrival if best.at_end_of_curve else v - near
        away = () if best.at_end_of_curve else legs(self.car, leaving, least / price, price)
        # what the car still loses while it cruises needn't be burned
        spared = 0.5 * self.car.load.accelerated_mass_kg * (arrival**2 - leaving**2) * best.marginal
        found = Extremal("cruise", there, away, price, 0.0, v, -spared)
        return found if np.isfinite(found.distance_m) else None

    def _best(self) -> Cruise:
        if self.best is None:
            raise LookupError("families with a cruise are built only where there is one.")
        return self.best


def _towards(start: float, end: float) -> FloatArray:
    """Return numbers from start to end, even at first and ever closer to the end."""
    share = np.concatenate((np.linspace(0.0, 0.9, LOOKS), 1.0 - 0.1 * 0.3 ** np.arange(1.0, 28.0)))
    return np.asarray(start + (end - start) * share)


def _of_length(wanted_m: float, numbers: FloatArray, drive: Callable[[float], Extremal]) -> list[Extremal]:
    """Return a family's drives of the wanted length."""
    lengths = np.array([drive(float(x)).distance_m for x in numbers])
    found = []
    for k in range(len(numbers) - 1):
        one, two = lengths[k] - wanted_m, lengths[k + 1] - wanted_m
        if np.isfinite(one) and np.isfinite(two) and (one <= 0.0) != (two <= 0.0):
            root = brentq(lambda x: drive(x).distance_m - wanted_m, numbers[k], numbers[k + 1], xtol=1e-14, rtol=1e-15)
            found.append(drive(float(root)))
    # two lengths on either side of the wanted one needn't mean a drive of it: closest to a limit the length jumps
    return [one for one in found if abs(one.distance_m - wanted_m) <= SAME * wanted_m]
