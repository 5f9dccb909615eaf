"""The cheapest control at a speed: least running cost for a change of speed.

On the level without a distance to keep, Pontryagin's principle says at every speed: choose the control for which
(weight · P_fuel + μ) / |v̇| is least (from H = λ v̇ − P = μ). Cost and time are then integrals over speed.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from app.science.arrays import FloatArray
from app.science.jit import kernel
from app.science.optimal.accelerate.quotient_kernels import cheapest_on, limit_of, weighed
from app.science.optimal.kernels import EngineNumbers, fuel_over_speed, full_load, over_torque, slope, value

GEARS, CVT, WILLANS = 0, 1, 2
NEUTRAL = -1
LOOKS = 14
NARROWINGS = 80
JUMP = 0.25
BISECTIONS = 30
SETTLED = 1e-13


class DriveNumbers(NamedTuple):
    """Car, engine and gears; ``spd_1pm`` is ω/v by gear. A Willans drive is bounded in power and force."""

    kind: int
    spd_1pm: FloatArray
    engine: EngineNumbers
    willans: FloatArray
    power_w: FloatArray
    force_n: FloatArray
    accelerated_kg: float
    drag_kgpm: float
    rolling_n: float
    neutral: bool
    idle_w: float
    brake_n: float


class Choice(NamedTuple):
    """A control at a speed: what it costs per m/s of speed change, J s/m, and what the engine and the brakes do.

    ``limit`` tells which limits it stands at: where it changes over speed, the control has a corner.
    """

    cost: float
    torque_nm: float
    engine_radps: float
    force_n: float
    fuel_w: float
    brake_n: float
    limit: int


@kernel
def resistance_n(v: float, drive: DriveNumbers) -> float:
    """Drag and rolling resistance on the level, N."""
    return float(drive.drag_kgpm * v * v + drive.rolling_n)


@kernel
def at_engine_speed(
    v: float, omega: float, mu: float, weight: float, sign: float, brake_n: float, drive: DriveNumbers
) -> tuple[Choice, float]:
    """Return the cheapest torque at an engine speed, and how its cost changes with engine speed at this speed."""
    resistance = resistance_n(v, drive) + brake_n
    highest, rise = full_load(omega, drive.engine)
    p = over_torque(omega, drive.engine)
    gain = omega / v
    cost, torque = cheapest_on(weighed(p, weight, mu), gain, resistance, sign, drive.engine.lowest_nm, highest)
    if not abs(cost) < math.inf:
        return Choice(cost, torque, omega, gain * torque, math.nan, brake_n, 0), math.nan
    fuel = value(p, torque)
    limit = limit_of(torque, drive.engine.lowest_nm, highest)
    pull = sign * (gain * torque - resistance)
    grows = (weight * fuel_over_speed(omega, torque, drive.engine) - cost * sign * torque / v) / pull
    if torque >= highest:
        grows += (weight * slope(p, torque) - cost * sign * gain) / pull * rise
    return Choice(cost * drive.accelerated_kg, torque, omega, gain * torque, fuel, brake_n, limit), grows


@kernel
def variable(v: float, mu: float, weight: float, sign: float, brake_n: float, drive: DriveNumbers) -> Choice:
    """Return the cheapest control of a CVT: engine speeds are looked over, then brackets of a minimum are narrowed.

    A bracket whose tangents meet above the best that is known is passed over.
    """
    low, high = drive.engine.lowest_radps, drive.engine.highest_radps
    step = (high - low) / LOOKS
    slopes, costs, torques = np.empty(LOOKS + 1), np.empty(LOOKS + 1), np.empty(LOOKS + 1)
    best, slopes[0] = at_engine_speed(v, low, mu, weight, sign, brake_n, drive)
    costs[0], torques[0] = best.cost, best.torque_nm
    for i in range(1, LOOKS + 1):
        other, slopes[i] = at_engine_speed(v, low + i * step, mu, weight, sign, brake_n, drive)
        costs[i], torques[i] = other.cost, other.torque_nm
        if other.cost < best.cost:
            best = other
    if not abs(best.cost) < math.inf:
        return best
    for i in range(LOOKS):
        a, b = low + i * step, low + (i + 1) * step
        if abs(torques[i + 1] - torques[i]) > JUMP * (drive.engine.highest_nm - drive.engine.lowest_nm):
            found = around_jump((a, b), (torques[i], torques[i + 1]), v, mu, weight, sign, brake_n, drive)
        else:
            if slopes[i] >= 0.0 or slopes[i + 1] <= 0.0 or (slopes[i] != slopes[i] and slopes[i + 1] != slopes[i + 1]):
                continue
            grow, fall = slopes[i + 1] * drive.accelerated_kg, slopes[i] * drive.accelerated_kg
            if costs[i] + fall * (costs[i] - costs[i + 1] + grow * step) / (grow - fall) >= best.cost:
                continue
            found = narrowed((a, b), (slopes[i], slopes[i + 1]), v, mu, weight, sign, brake_n, drive)
        if found.cost < best.cost:
            best = found
    return edged(best, drive)


@kernel
def around_jump(
    ends: tuple[float, float],
    torques: tuple[float, float],
    v: float,
    mu: float,
    weight: float,
    sign: float,
    brake_n: float,
    drive: DriveNumbers,
) -> Choice:
    """Return the cheapest control between two engine speeds, between which the best torque jumps."""
    a, b = ends
    for _ in range(BISECTIONS):
        middle = 0.5 * (a + b)
        torque = at_engine_speed(v, middle, mu, weight, sign, brake_n, drive)[0].torque_nm
        if abs(torque - torques[0]) < abs(torque - torques[1]):
            a = middle
        else:
            b = middle
    best = Choice(math.inf, math.nan, a, math.nan, math.nan, brake_n, 0)
    for piece in ((ends[0], a), (b, ends[1])):
        first, slope_first = at_engine_speed(v, piece[0], mu, weight, sign, brake_n, drive)
        last, slope_last = at_engine_speed(v, piece[1], mu, weight, sign, brake_n, drive)
        found = first if first.cost < last.cost else last
        if slope_first < 0.0 < slope_last:
            inner = narrowed(piece, (slope_first, slope_last), v, mu, weight, sign, brake_n, drive)
            found = inner if inner.cost < found.cost else found
        if found.cost < best.cost:
            best = found
    return best


@kernel
def narrowed(
    ends: tuple[float, float],
    slopes: tuple[float, float],
    v: float,
    mu: float,
    weight: float,
    sign: float,
    brake_n: float,
    drive: DriveNumbers,
) -> Choice:
    """Return the cheapest control between two engine speeds, by a root of the cost's slope; NaN where nothing moves."""
    (a, b), (at_a, at_b) = ends, slopes
    best = Choice(math.inf, math.nan, a, math.nan, math.nan, brake_n, 0)
    last = math.nan
    for _ in range(NARROWINGS):
        middle = (a * at_b - b * at_a) / (at_b - at_a) if at_a < 0.0 < at_b else 0.5 * (a + b)
        if not a < middle < b or abs(middle - last) < SETTLED * middle:
            break
        last = middle
        other, growing = at_engine_speed(v, middle, mu, weight, sign, brake_n, drive)
        if other.cost < best.cost:
            best = other
        if growing > 0.0 or (growing != growing and at_a < 0.0):
            b, at_b = middle, growing
            at_a *= 0.5
        elif growing < 0.0 or growing != growing:
            a, at_a = middle, growing
            at_b *= 0.5
        else:
            break
    return best


@kernel
def edged(best: Choice, drive: DriveNumbers) -> Choice:
    """Return a CVT's control with the limits of its engine speed told, too."""
    more = 4 * limit_of(best.engine_radps, drive.engine.lowest_radps, drive.engine.highest_radps)
    return Choice(
        best.cost, best.torque_nm, best.engine_radps, best.force_n, best.fuel_w, best.brake_n, best.limit + more
    )


@kernel
def at_wheels(v: float, mu: float, weight: float, sign: float, brake_n: float, drive: DriveNumbers) -> Choice:
    """Return the cheapest wheel power of a Willans drive."""
    c = drive.willans
    q = (weight * c[0] + mu, weight * c[1], weight * c[2], 0.0, 0.0, 0.0)
    low, high = max(drive.power_w[0], drive.force_n[0] * v), min(drive.power_w[1], drive.force_n[1] * v)
    cost, x = cheapest_on(q, 1.0 / v, resistance_n(v, drive) + brake_n, sign, low, high)
    fuel = c[0] + c[1] * x + c[2] * x * x
    return Choice(cost * drive.accelerated_kg, math.nan, math.nan, x / v, fuel, brake_n, limit_of(x, low, high))


@kernel
def unbraked(gear: int, v: float, mu: float, weight: float, sign: float, brake_n: float, drive: DriveNumbers) -> Choice:
    """Return the cheapest control in a gear (from 0) with a given force of the brakes; a CVT has one gear."""
    if drive.kind == WILLANS:
        return at_wheels(v, mu, weight, sign, brake_n, drive)
    if drive.kind == CVT:
        return variable(v, mu, weight, sign, brake_n, drive)
    return at_engine_speed(v, v * drive.spd_1pm[gear], mu, weight, sign, brake_n, drive)[0]


@kernel
def cheapest_in(gear: int, v: float, mu: float, weight: float, sign: float, drive: DriveNumbers) -> Choice:
    """Return the cheapest control in a gear (from 0) or in neutral, brakes included where they may act."""
    if gear == NEUTRAL:
        return rolling(v, mu, weight, sign, drive)
    best = unbraked(gear, v, mu, weight, sign, 0.0, drive)
    if sign < 0.0 and drive.brake_n > 0.0 and drive.kind != GEARS:
        other = unbraked(gear, v, mu, weight, sign, drive.brake_n, drive)
        if other.cost < best.cost:
            return other
    return best


@kernel
def rolling(v: float, mu: float, weight: float, sign: float, drive: DriveNumbers) -> Choice:
    """Return what neutral costs: it only slows down, and brakes where that is cheaper."""
    if sign > 0.0 or not drive.neutral:
        return Choice(math.inf, math.nan, math.nan, 0.0, math.nan, 0.0, 0)
    running = weight * drive.idle_w + mu
    brake = drive.brake_n if running > 0.0 else 0.0
    against = resistance_n(v, drive) + brake
    cost = running * drive.accelerated_kg / against if against > 0.0 else math.inf
    return Choice(cost, math.nan, math.nan, 0.0, drive.idle_w, brake, 0)
