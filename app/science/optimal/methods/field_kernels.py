"""The control with the greatest H for a costate, and the augmented system it drives (Sebesta 2010, B.14-B.16).

Written for itself: it maximises H for (v, λ), where the solution by integrals minimises (P + μ) / v̇ for (v, μ).
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from app.science.arrays import FloatArray
from app.science.jit import kernel
from app.science.optimal.accelerate.kernels import CVT, GEARS, NEUTRAL, WILLANS, DriveNumbers
from app.science.optimal.kernels import Polynomial, fuel_over_speed, full_load, over_torque, slope, value

LOOKS = 24
TURNS = 30
NO_GEAR = -2
HALVINGS = 52
AT_LIMIT = 1e-12


class Rates(NamedTuple):
    """The best control in a gear at (v, λ): H, W, rates of speed and costate, and what engine and brakes do."""

    h_w: float
    accel_mps2: float
    costate_rate: float
    fuel_w: float
    force_n: float
    engine_radps: float
    torque_nm: float
    brake_n: float


@kernel
def strongest(p: Polynomial, gain: float, low: float, high: float) -> float:
    """Return x from low to high with the greatest gain · x − p(x): ends, and roots of the slope between looks."""
    best_x, best = low, gain * low - value(p, low)
    at_end = gain * high - value(p, high)
    if at_end > best:
        best_x, best = high, at_end
    step = (high - low) / LOOKS
    a, rise_a = low, gain - slope(p, low)
    for k in range(1, LOOKS + 1):
        b = low + k * step
        rise_b = gain - slope(p, b)
        if rise_a > 0.0 >= rise_b:
            left, right = a, b
            for _ in range(HALVINGS):
                middle = 0.5 * (left + right)
                if gain - slope(p, middle) > 0.0:
                    left = middle
                else:
                    right = middle
            x = 0.5 * (left + right)
            h = gain * x - value(p, x)
            if h > best:
                best_x, best = x, h
        a, rise_a = b, rise_b
    return best_x


@kernel
def gained(omega: float, v: float, costate: float, drive: DriveNumbers) -> tuple[float, float, float]:
    """Return the greatest λ F / M − P at an engine speed, its torque, and how it grows with engine speed.

    Beyond the engine's speeds its full load goes on as it ends, so that an integration may look a step too far.
    """
    engine = drive.engine
    highest, rise = full_load(min(max(omega, engine.lowest_radps), engine.highest_radps), engine)
    if not highest >= engine.lowest_nm:
        return -math.inf, math.nan, math.nan
    p = over_torque(omega, engine)
    per_nm = costate / (v * drive.accelerated_kg)
    torque = strongest(p, per_nm * omega, engine.lowest_nm, highest)
    grows = per_nm * torque - fuel_over_speed(omega, torque, engine)
    if torque >= highest * (1.0 - AT_LIMIT):
        grows += rise * (per_nm * omega - slope(p, torque))
    return per_nm * omega * torque - value(p, torque), torque, grows


@kernel
def best_turn(v: float, costate: float, drive: DriveNumbers) -> float:
    """Return a CVT's engine speed with the greatest H: looked over, then the root of its slope beside the best look."""
    low, high = drive.engine.lowest_radps, drive.engine.highest_radps
    step = (high - low) / TURNS
    best, at = -math.inf, 0
    for k in range(TURNS + 1):
        h, _, _ = gained(low + k * step, v, costate, drive)
        if h > best:
            best, at = h, k
    middle = low + at * step
    _, _, grows = gained(middle, v, costate, drive)
    a = middle if grows > 0.0 else max(low, middle - step)
    b = min(high, middle + step) if grows > 0.0 else middle
    if a == b:
        return middle
    for _ in range(HALVINGS):
        inner = 0.5 * (a + b)
        if gained(inner, v, costate, drive)[2] > 0.0:
            a = inner
        else:
            b = inner
    inner = 0.5 * (a + b)
    return inner if gained(inner, v, costate, drive)[0] > best else middle


@kernel
def engaged(gear: int, v: float, drive: DriveNumbers) -> bool:
    """Tell whether a gear (from 0; −1 is neutral) can be engaged at a speed."""
    if gear == NEUTRAL:
        return drive.neutral
    if drive.kind != GEARS:
        return True
    highest, _ = full_load(v * drive.spd_1pm[gear], drive.engine)
    return highest >= drive.engine.lowest_nm


@kernel
def rates_in(gear: int, v: float, costate: float, drive: DriveNumbers) -> Rates:
    """Return the best control in a gear (from 0; −1 is neutral) and what follows from it."""
    mass = drive.accelerated_kg
    resistance = drive.drag_kgpm * v * v + drive.rolling_n
    brake = drive.brake_n if costate < 0.0 and (gear == NEUTRAL or drive.kind != GEARS) else 0.0
    by_speed = -2.0 * drive.drag_kgpm * v / mass
    fuel_by_speed = 0.0
    omega = torque = math.nan
    if gear == NEUTRAL:
        force, fuel = 0.0, drive.idle_w
    elif drive.kind == WILLANS:
        c = drive.willans
        p = (c[0], c[1], c[2], 0.0, 0.0, 0.0)
        low, high = max(drive.power_w[0], drive.force_n[0] * v), min(drive.power_w[1], drive.force_n[1] * v)
        x = strongest(p, costate / (v * mass), low, high)
        force, fuel = x / v, value(p, x)
        if force >= drive.force_n[1] * (1.0 - AT_LIMIT) or x <= drive.force_n[0] * v * (1.0 - AT_LIMIT) < 0.0:
            fuel_by_speed = force * slope(p, x)
        else:
            by_speed -= force / (v * mass)
    else:
        omega = best_turn(v, costate, drive) if drive.kind == CVT else v * drive.spd_1pm[gear]
        h, torque, _ = gained(omega, v, costate, drive)
        if not h > -math.inf:
            return Rates(-math.inf, math.nan, math.nan, math.nan, math.nan, omega, torque, brake)
        p = over_torque(omega, drive.engine)
        force, fuel = omega * torque / v, value(p, torque)
        if drive.kind == CVT:
            by_speed -= force / (v * mass)
        else:
            n = drive.spd_1pm[gear]
            fuel_by_speed = n * fuel_over_speed(omega, torque, drive.engine)
            highest, rise = full_load(omega, drive.engine)
            if torque >= highest * (1.0 - AT_LIMIT):
                by_speed += rise * n * n / mass
                fuel_by_speed += rise * n * slope(p, torque)
    accel = (force - brake - resistance) / mass
    return Rates(costate * accel - fuel, accel, fuel_by_speed - costate * by_speed, fuel, force, omega, torque, brake)


@kernel
def best_gear(v: float, costate: float, drive: DriveNumbers) -> int:
    """Return the gear with the greatest H; −2 where none can be engaged."""
    best, at = -math.inf, NO_GEAR
    for gear in range(NEUTRAL, len(drive.spd_1pm)):
        if engaged(gear, v, drive):
            h = rates_in(gear, v, costate, drive).h_w
            if h > best:
                best, at = h, gear
    return at


@kernel
def lead(gear: int, v: float, costate: float, drive: DriveNumbers) -> float:
    """Return how far the H of the best other gear is above this one's, W; −∞ where there is no other."""
    best = -math.inf
    for other in range(NEUTRAL, len(drive.spd_1pm)):
        if other != gear and engaged(other, v, drive):
            best = max(best, rates_in(other, v, costate, drive).h_w)
    return best - rates_in(gear, v, costate, drive).h_w if best > -math.inf else best


@kernel
def rows_in(gear: int, v: FloatArray, costate: FloatArray, drive: DriveNumbers) -> FloatArray:
    """Return `Rates` for many points, shape (8, n)."""
    rows = np.empty((8, len(v)))
    for k in range(len(v)):
        found = rates_in(gear, v[k], costate[k], drive)
        rows[0, k], rows[1, k], rows[2, k], rows[3, k] = (
            found.h_w,
            found.accel_mps2,
            found.costate_rate,
            found.fuel_w,
        )
        rows[4, k], rows[5, k], rows[6, k], rows[7, k] = (
            found.force_n,
            found.engine_radps,
            found.torque_nm,
            found.brake_n,
        )
    return rows
