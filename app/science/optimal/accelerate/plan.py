"""Which gear between which speeds: the cheapest sequence for a given value of time."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from app.science.arrays import FloatArray, IntArray
from app.science.optimal.accelerate.integral_kernels import Pricing
from app.science.optimal.accelerate.kernels import NEUTRAL, DriveNumbers
from app.science.optimal.accelerate.plan_kernels import cheapest_along, chosen, everything, planned

SAME_SPEED_MPS = 1e-9


@dataclass(frozen=True, slots=True)
class Phase:
    """One gear between two speeds, and what that takes.

    Attributes
    ----------
    gear : int
        From 0, as in the drive; −1 is neutral.
    from_mps, to_mps : float
    corners_mps : tuple of float
        Speeds between at which a limit of the engine has a corner.
    cost : float
        Weighted fuel plus μ times time, J.
    fuel_j, time_s, distance_m : float
    price : Pricing
    """

    gear: int
    from_mps: float
    to_mps: float
    corners_mps: tuple[float, ...]
    cost: float
    fuel_j: float
    time_s: float
    distance_m: float
    price: Pricing


@dataclass(frozen=True, slots=True)
class Plan:
    """Phases one after the other; neighbours are in different gears."""

    phases: tuple[Phase, ...]

    @property
    def cost(self) -> float:
        """Weighted fuel plus μ times time, J; without charges for changes of gear."""
        return sum(phase.cost for phase in self.phases)

    @property
    def fuel_j(self) -> float:
        """Fuel energy, J."""
        return sum(phase.fuel_j for phase in self.phases)

    @property
    def time_s(self) -> float:
        """Time, s."""
        return sum(phase.time_s for phase in self.phases)

    @property
    def distance_m(self) -> float:
        """Distance, m."""
        return sum(phase.distance_m for phase in self.phases)

    @property
    def sequence(self) -> tuple[int, ...]:
        """Gears in driving order."""
        return tuple(phase.gear for phase in self.phases)


def plan(
    drive: DriveNumbers,
    slow_mps: float,
    fast_mps: float,
    mu: float,
    *,
    weight: float = 1.0,
    sign: float = 1.0,
    shift_cost_j: float = 0.0,
    pin_mps: float = np.nan,
) -> Plan | None:
    """Return the cheapest way from one speed to a higher one, or down from it with ``sign`` −1; None if there is none.

    Gears change where two cost the same, or where one reaches the end of its engine speeds; which of these places are
    used is decided by dynamic programming over the sections between them, so that a charge for changing is exact.

    Parameters
    ----------
    drive : DriveNumbers
    slow_mps, fast_mps : float
    mu : float
        Price of a second, W.
    weight : float
        Of the fuel; 0 for the fastest way.
    sign : float
    shift_cost_j : float
    pin_mps : float
        A speed that integrals are divided at: where the car nearly stands still in speed.
    """
    if fast_mps - slow_mps < SAME_SPEED_MPS:
        return Plan(())
    price = Pricing(mu, weight, sign, pin_mps)
    places, columns, sums = planned(slow_mps, fast_mps, shift_cost_j, price, drive)
    if columns[0] < 0 or not np.isfinite(sums[:, 0]).all():
        return None
    return merged(places, columns, sums, price, drive)


def plan_along(
    drive: DriveNumbers, slow_mps: float, fast_mps: float, mu: float, sequence: Sequence[int]
) -> Plan | None:
    """Return the cheapest way up through given gears, all of them and in this order; None if there is none."""
    price = Pricing(mu, 1.0, 1.0, np.nan)
    places, sums = everything(slow_mps, fast_mps, price, drive)
    columns = cheapest_along(sums[:, :, 0].copy(), np.array(sequence, dtype=np.int64))
    if columns[0] < 0:
        return None
    found = merged(places, columns, chosen(sums, columns), price, drive)
    return found if np.isfinite(found.cost) else None


def merged(places: FloatArray, columns: IntArray, sums: FloatArray, price: Pricing, drive: DriveNumbers) -> Plan:
    """Return sections of rising speed as phases in driving order."""
    speeds = places
    if price.sign < 0.0:
        columns, sums, speeds = columns[::-1], sums[::-1], places[::-1]
    phases: list[Phase] = []
    begin = 0
    for k in range(1, len(columns) + 1):
        if k < len(columns) and columns[k] == columns[begin]:
            continue
        gear = int(columns[begin]) if columns[begin] < len(drive.spd_1pm) else NEUTRAL
        corners = tuple(float(v) for v in speeds[begin + 1 : k])
        whole = sums[begin:k].sum(axis=0)
        cost, fuel, time, distance = (float(one) for one in whole)
        ends = float(speeds[begin]), float(speeds[k])
        phases.append(Phase(gear, *ends, corners, cost, fuel, time, distance, price))
        begin = k
    return Plan(tuple(phases))
