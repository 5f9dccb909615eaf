"""Integrals over speed: what a gear costs between two speeds, to rounding."""

from __future__ import annotations

import math
from typing import NamedTuple

from app.science.jit import kernel
from app.science.optimal.accelerate.kernels import DriveNumbers, cheapest_in, resistance_n

INSET = 1e-9
ACCURATE = 1e-10
SMALL_SHARE = 0.02
TIME_SHARE = 100.0
SHARP = 1e-12
CORNERED = 1e-12
NARROWEST = 1e-9
NODES = (
    0.991455371120812639206854697526329,
    0.949107912342758524526189684047851,
    0.864864423359769072789712788640926,
    0.741531185599394439863864773280788,
    0.586087235467691130294144691693309,
    0.405845151377397166906606412076961,
    0.207784955007898467600689403773245,
    0.0,
)
KRONROD = (
    0.022935322010529224963732008058970,
    0.063092092629978553290700663189204,
    0.104790010322250183839876322541518,
    0.140653259715525918745189590510238,
    0.169004726639267902826583426598550,
    0.190350578064785409913256402421014,
    0.204432940075298892414161999234649,
    0.209482141084727828012999174891714,
)
GAUSS = (
    0.0,
    0.129484966168869693270611432679082,
    0.0,
    0.279705391489276667901467771423780,
    0.0,
    0.381830050505118944950369775488975,
    0.0,
    0.417959183673469387755102040816327,
)


class Sums(NamedTuple):
    """Integrals over a range of speed: running cost and fuel (J), time (s), distance (m)."""

    cost: float
    fuel_j: float
    time_s: float
    distance_m: float


class Pricing(NamedTuple):
    """What is paid: weight · fuel + μ · time; ``sign`` 1 speeds up, −1 slows down; panels end at the pinned speed."""

    mu_w: float
    weight: float
    sign: float
    pin_mps: float


@kernel
def panel(gear: int, a: float, b: float, price: Pricing, drive: DriveNumbers) -> tuple[Sums, float, float]:
    """Gauss–Kronrod integrals over one panel, and the differences to the embedded Gauss rule in cost and time."""
    half, middle = 0.5 * (b - a), 0.5 * (a + b)
    cost = fuel = time = distance = rough = rough_time = 0.0
    for i in range(15):
        k = i if i < 8 else 14 - i
        v = middle - half * NODES[k] if i < 8 else middle + half * NODES[k]
        found = cheapest_in(gear, v, price.mu_w, price.weight, price.sign, drive)
        if not abs(found.cost) < math.inf:
            return Sums(math.inf, math.inf, math.inf, math.inf), 0.0, 0.0
        pull = price.sign * (found.force_n - found.brake_n - resistance_n(v, drive))
        slow = drive.accelerated_kg / pull
        cost += KRONROD[k] * found.cost
        rough += GAUSS[k] * found.cost
        fuel += KRONROD[k] * found.fuel_w * slow
        time += KRONROD[k] * slow
        rough_time += GAUSS[k] * slow
        distance += KRONROD[k] * v * slow
    sums = Sums(half * cost, half * fuel, half * time, half * distance)
    return sums, half * abs(cost - rough), half * abs(time - rough_time)


@kernel
def integrate(gear: int, a: float, b: float, price: Pricing, drive: DriveNumbers) -> Sums:
    """Integrate over speed from a to b > a, dividing panels until the cost is known to `ACCURATE`.

    Time is held to a looser bound: it follows the control, which is less sharply determined than its cost.
    """
    cost = fuel = time = distance = 0.0
    middle = 0.5 * (a + b)
    ends = [b]
    if limit_at(gear, middle, price, drive) != limit_at(gear, b - INSET * (b - a), price, drive):
        ends.append(corner(gear, middle, b, price, drive))
    if limit_at(gear, middle, price, drive) != limit_at(gear, a + INSET * (b - a), price, drive):
        ends.append(corner(gear, a, middle, price, drive))
    low, high = a, ends[-1]
    sums, off, off_time = panel(gear, low, high, price, drive)
    whole, _, _ = panel(gear, a, b, price, drive) if len(ends) > 1 else (sums, off, off_time)
    whole_cost, whole_s = abs(whole.cost), whole.time_s
    while sums.cost < math.inf:
        share = ACCURATE * max((high - low) / (b - a), SMALL_SHARE)
        rough = off > share * whole_cost or off_time > TIME_SHARE * share * whole_s
        if rough and high - low > NARROWEST * (b - a):
            high = corner(gear, low, high, price, drive)
            ends.append(high)
        else:
            cost += sums.cost
            fuel += sums.fuel_j
            time += sums.time_s
            distance += sums.distance_m
            low = ends.pop()
            if len(ends) == 0:
                return Sums(cost, fuel, time, distance)
            high = ends[-1]
        sums, off, off_time = panel(gear, low, high, price, drive)
    return sums


@kernel
def limit_at(gear: int, v: float, price: Pricing, drive: DriveNumbers) -> int:
    """Tell at which limits the cheapest control stands; a corner near a panel's end hides from its nodes."""
    return cheapest_in(gear, v, price.mu_w, price.weight, price.sign, drive).limit


@kernel
def corner(gear: int, a: float, b: float, price: Pricing, drive: DriveNumbers) -> float:
    """Return a speed at which the control reaches or leaves a limit, to divide a panel there; else its middle."""
    low, high = a + INSET * (b - a), b - INSET * (b - a)
    at_low = limit_at(gear, low, price, drive)
    if at_low == limit_at(gear, high, price, drive):
        return 0.5 * (a + b)
    while high - low > CORNERED * b:
        middle = 0.5 * (low + high)
        if limit_at(gear, middle, price, drive) == at_low:
            low = middle
        else:
            high = middle
    v = 0.5 * (low + high)
    return v if a + 1e-6 * (b - a) < v < b - 1e-6 * (b - a) else 0.5 * (a + b)
