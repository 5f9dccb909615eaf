"""What compiled code says along a drive: points of a phase, the costate's own equation, and the best other control."""

from __future__ import annotations

import math

import numpy as np

from app.science.arrays import FloatArray
from app.science.jit import kernel
from app.science.optimal.accelerate.integral_kernels import Pricing, integrate
from app.science.optimal.accelerate.kernels import CVT, GEARS, NEUTRAL, WILLANS, DriveNumbers, cheapest_in, resistance_n
from app.science.optimal.kernels import fuel_over_speed, fuel_power_w, full_load, over_torque, slope

TORQUES = 120
STANDING_MPS = 1e-9
CVT_SPEEDS = 60


@kernel
def points(gear: int, speeds: FloatArray, price: Pricing, drive: DriveNumbers) -> FloatArray:
    """Return a phase at speeds in driving order.

    Returns
    -------
    array, shape (n, 8)
        Time and distance since the first point, engine speed, torque, fuel power, brakes, acceleration, costate.
    """
    rows = np.zeros((len(speeds), 8))
    for k in range(len(speeds)):
        v = max(speeds[k], STANDING_MPS)
        if k > 0:
            low, high = min(speeds[k], speeds[k - 1]), max(speeds[k], speeds[k - 1])
            sums = integrate(gear, low, high, price, drive)
            rows[k, 0] = rows[k - 1, 0] + sums.time_s
            rows[k, 1] = rows[k - 1, 1] + sums.distance_m
        found = cheapest_in(gear, v, price.mu_w, price.weight, price.sign, drive)
        rows[k, 2], rows[k, 3], rows[k, 4], rows[k, 5] = (
            found.engine_radps,
            found.torque_nm,
            found.fuel_w,
            found.brake_n,
        )
        rows[k, 6] = (found.force_n - found.brake_n - resistance_n(v, drive)) / drive.accelerated_kg
        rows[k, 7] = (found.fuel_w + price.mu_w) / rows[k, 6]
    return rows


@kernel
def costate_slope(gear: int, v: float, costate: float, price: Pricing, drive: DriveNumbers) -> tuple[float, float]:
    """Return dλ/dv along the drive from λ' = −∂H/∂v, and H; a limit that depends on speed is followed."""
    found = cheapest_in(gear, v, price.mu_w, price.weight, price.sign, drive)
    mass = drive.accelerated_kg
    pull = (found.force_n - found.brake_n - resistance_n(v, drive)) / mass
    by_speed = -2.0 * drive.drag_kgpm * v / mass
    fuel_by_speed = follow = follow_fuel = 0.0
    if gear != NEUTRAL and drive.kind == GEARS:
        n = drive.spd_1pm[gear]
        fuel_by_speed = n * fuel_over_speed(found.engine_radps, found.torque_nm, drive.engine)
        highest, rise = full_load(found.engine_radps, drive.engine)
        if found.torque_nm >= highest:
            follow = rise * n * n / mass
            follow_fuel = rise * n * slope(over_torque(found.engine_radps, drive.engine), found.torque_nm)
    elif gear != NEUTRAL:
        by_speed -= found.force_n / (v * mass)
        if drive.kind == WILLANS:
            for k in range(2):
                force = drive.force_n[k]
                if abs(found.force_n - force) <= 1e-12 * abs(force):
                    follow = force / (v * mass)
                    power = found.force_n * v
                    follow_fuel = force * (drive.willans[1] + 2.0 * drive.willans[2] * power)
    change = -(costate * (by_speed + follow) - fuel_by_speed - follow_fuel)
    return change / pull, costate * pull - found.fuel_w


@kernel
def best_other(
    gear: int, v: float, costate: float, mu: float, every_gear: bool, drive: DriveNumbers
) -> tuple[float, int]:
    """Return the largest H − μ over a grid of admissible controls at a speed, and its gear."""
    mass, resistance = drive.accelerated_kg, resistance_n(v, drive)
    best, at = -math.inf, NEUTRAL
    if drive.neutral and (every_gear or gear == NEUTRAL):
        for brake in (0.0, drive.brake_n):
            h = -costate * (resistance + brake) / mass - drive.idle_w - mu
            if h > best:
                best, at = h, NEUTRAL
    brakes = (0.0, drive.brake_n if drive.kind != GEARS else 0.0)
    engine = drive.engine
    for other in range(len(drive.spd_1pm)):
        if not every_gear and other != gear:
            continue
        for i in range(CVT_SPEEDS + 1 if drive.kind == CVT else 1):
            if drive.kind == WILLANS:
                low, high = max(drive.power_w[0], drive.force_n[0] * v), min(drive.power_w[1], drive.force_n[1] * v)
                omega = 1.0
            else:
                omega = v * drive.spd_1pm[other]
                if drive.kind == CVT:
                    omega = engine.lowest_radps + i * (engine.highest_radps - engine.lowest_radps) / CVT_SPEEDS
                low = engine.lowest_nm
                high, _ = full_load(omega, engine)
            if not high >= low:
                continue
            for j in range(TORQUES + 1):
                x = low + j * (high - low) / TORQUES
                if drive.kind == WILLANS:
                    fuel = drive.willans[0] + drive.willans[1] * x + drive.willans[2] * x * x
                else:
                    fuel = fuel_power_w(omega, x, engine)
                for brake in brakes:
                    h = costate * (x * omega / v - brake - resistance) / mass - fuel - mu
                    if h > best:
                        best, at = h, other
    return best, at
