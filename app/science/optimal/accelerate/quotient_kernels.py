"""The least of a polynomial over a line: the cheapest control of one engine speed, exactly and without a guess."""

from __future__ import annotations

import math

from app.science.jit import kernel
from app.science.optimal.kernels import Polynomial, slope, value

NEWTON_STEPS = 60
BARELY = 1e-13


@kernel
def bends(p: Polynomial, low: float, high: float) -> tuple[float, float, float]:
    """Return the places between low and high where a polynomial changes its curvature, in order; NaN for none."""
    none = math.nan
    a, b, c, d = 2.0 * p[2], 6.0 * p[3], 12.0 * p[4], 20.0 * p[5]
    if d == 0.0:
        if c == 0.0:
            at = -a / b if b != 0.0 else none
            return (at, none, none) if low < at < high else (none, none, none)
        first, second = quadratic_roots(a, b, c)
        if not low < first < high:
            first = none
        if not low < second < high:
            second = none
        return (first, second, none) if first == first else (second, none, none)
    turn, other = quadratic_roots(b, 2.0 * c, 3.0 * d)
    found = (none, none, none)
    count, begin = 0, low
    for k in range(3):
        end = high
        if k == 0 and low < turn < high:
            end = turn
        elif k <= 1 and begin < other < high:
            end = other
        at = cubic_root(a, b, c, d, begin, end)
        if at == at:
            if count == 0:
                found = (at, none, none)
            elif count == 1:
                found = (found[0], at, none)
            else:
                found = (found[0], found[1], at)
            count += 1
        if end == high:
            break
        begin = end
    return found


@kernel
def quadratic_roots(a: float, b: float, c: float) -> tuple[float, float]:
    """Return the real roots of a + b x + c x², the smaller first; NaN for none."""
    under = b * b - 4.0 * a * c
    if under < 0.0 or c == 0.0:
        return math.nan, math.nan
    half = -0.5 * (b + math.copysign(math.sqrt(under), b))
    one = half / c
    two = a / half if half != 0.0 else one
    return min(one, two), max(one, two)


@kernel
def cubic_root(a: float, b: float, c: float, d: float, low: float, high: float) -> float:
    """Return where a monotone cubic crosses zero between low and high by bisection; NaN where it does not."""
    at_low = ((d * low + c) * low + b) * low + a
    at_high = ((d * high + c) * high + b) * high + a
    if (at_low < 0.0) == (at_high < 0.0):
        return math.nan
    for _ in range(60):
        middle = 0.5 * (low + high)
        if ((((d * middle + c) * middle + b) * middle + a) < 0.0) == (at_low < 0.0):
            low = middle
        else:
            high = middle
    return 0.5 * (low + high)


@kernel
def cheapest_on(
    q: Polynomial, gain: float, resistance: float, sign: float, lowest: float, highest: float
) -> tuple[float, float]:
    """Return the least q(x) / (sign · (gain x − resistance)) between two controls, and its x; infinite if none moves.

    With D = sign · (q′ (gain x − resistance) − gain q), the derivative's sign, D′ = q″ · |gain x − resistance|: between
    two bends of q there is one least value at most, and none where q is concave.
    """
    balance = resistance / gain
    low, high = lowest, highest
    if sign > 0.0:
        low = max(low, balance)
    else:
        high = min(high, balance)
    if not high > low:
        return math.inf, math.nan
    barely = BARELY * (abs(resistance) + gain * max(abs(low), abs(high)))
    best, found = math.inf, math.nan
    cuts = bends(q, low, high)
    begin = low
    for k in range(4):
        cut = cuts[k] if k < 3 else math.nan
        end = cut if cut == cut else high
        for x in (begin, end):
            pull = sign * (gain * x - resistance)
            if pull > barely:
                cost = value(q, x) / pull
                if cost < best:
                    best, found = cost, x
            elif value(q, x) < 0.0:
                return -math.inf, x
        x = stationary(q, gain, resistance, sign, begin, end)
        if x == x:
            cost = value(q, x) / (sign * (gain * x - resistance))
            if cost < best:
                best, found = cost, x
        if cut != cut:
            break
        begin = end
    return best, found


@kernel
def stationary(q: Polynomial, gain: float, resistance: float, sign: float, low: float, high: float) -> float:
    """Return where the cost is least inside a stretch in which q is convex; NaN where it has no such place."""
    at_low = sign * (slope(q, low) * (gain * low - resistance) - gain * value(q, low))
    at_high = sign * (slope(q, high) * (gain * high - resistance) - gain * value(q, high))
    if not (at_low < 0.0 < at_high):
        return math.nan
    x = 0.5 * (low + high)
    for _ in range(NEWTON_STEPS):
        off = sign * (slope(q, x) * (gain * x - resistance) - gain * value(q, x))
        if off > 0.0:
            high = x
        else:
            low = x
        curve = ((20.0 * q[5] * x + 12.0 * q[4]) * x + 6.0 * q[3]) * x + 2.0 * q[2]
        steep = curve * sign * (gain * x - resistance)
        after = x - off / steep if steep > 0.0 else low
        if not low < after < high:
            after = 0.5 * (low + high)
        if abs(after - x) <= 4e-16 * (abs(x) + abs(high)):
            return after
        x = after
    return x


@kernel
def limit_of(x: float, low: float, high: float) -> int:
    """Tell at which limit a control stands: 1 the lowest, 2 the highest, 0 none."""
    if x <= low:
        return 1
    return 2 if x >= high else 0


@kernel
def weighed(p: Polynomial, weight: float, mu: float) -> Polynomial:
    """Return weight · p + μ."""
    return weight * p[0] + mu, weight * p[1], weight * p[2], weight * p[3], weight * p[4], weight * p[5]
