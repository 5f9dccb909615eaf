"""Staying about a speed: the least average fuel power, by one control or by two in turn."""

from __future__ import annotations

import math
from typing import NamedTuple

from app.science.jit import kernel
from app.science.optimal.accelerate.kernels import CVT, NEUTRAL, WILLANS, DriveNumbers, cheapest_in, resistance_n
from app.science.optimal.kernels import fuel_power_w, full_load

CLOSE = 1e-13
STEPS = 100


class Turn(NamedTuple):
    """Going up and down about a speed: cost per m/s, J s/m, and the gears of both ways."""

    cost: float
    up: int
    down: int


class Hold(NamedTuple):
    """A control that holds a speed: fuel power, W, gear from 0, what the engine does, and the brakes, N."""

    fuel_w: float
    gear: int
    engine_radps: float
    torque_nm: float
    brake_n: float


@kernel
def round_trip(v: float, mu: float, free_changes: bool, drive: DriveNumbers) -> Turn:
    """Return the cheapest way up and down again about a speed; in one gear where changes are charged."""
    rise, up = math.inf, NEUTRAL
    fall, down = cheapest_in(NEUTRAL, v, mu, 1.0, -1.0, drive).cost, NEUTRAL
    best = Turn(math.inf, NEUTRAL, NEUTRAL)
    for gear in range(len(drive.spd_1pm)):
        one = cheapest_in(gear, v, mu, 1.0, 1.0, drive).cost
        two = cheapest_in(gear, v, mu, 1.0, -1.0, drive).cost
        if one < rise:
            rise, up = one, gear
        if two < fall:
            fall, down = two, gear
        if one < math.inf and two < math.inf and one + two < best.cost:
            best = Turn(one + two, gear, gear)
    if free_changes and rise < math.inf and fall < math.inf:
        return Turn(rise + fall, up, down)
    return best


@kernel
def steady(v: float, drive: DriveNumbers) -> Hold:
    """Return the control that holds a speed on the least fuel; infinite fuel power where none does."""
    resistance = resistance_n(v, drive)
    best = Hold(math.inf, 0, math.nan, math.nan, 0.0)
    if drive.kind == WILLANS:
        c = drive.willans
        low, high = max(drive.power_w[0], drive.force_n[0] * v), min(drive.power_w[1], drive.force_n[1] * v)
        x = max(low, resistance * v)
        if x <= high and x <= (resistance + drive.brake_n) * v:
            return Hold(c[0] + c[1] * x + c[2] * x * x, 0, math.nan, math.nan, x / v - resistance)
        return best
    if drive.kind == CVT:
        return steady_variable(v, drive)
    for gear in range(len(drive.spd_1pm)):
        omega = v * drive.spd_1pm[gear]
        highest, _ = full_load(omega, drive.engine)
        torque = resistance / drive.spd_1pm[gear]
        if drive.engine.lowest_nm <= torque <= highest:
            fuel = fuel_power_w(omega, torque, drive.engine)
            if fuel < best.fuel_w:
                best = Hold(fuel, gear, omega, torque, 0.0)
    return best


@kernel
def steady_variable(v: float, drive: DriveNumbers) -> Hold:
    """Return how a CVT holds a speed on the least fuel, on a grid of engine speeds that is narrowed."""
    resistance = resistance_n(v, drive)
    low, high = drive.engine.lowest_radps, drive.engine.highest_radps
    best = Hold(math.inf, 0, low, math.nan, 0.0)
    for _ in range(6):
        step = (high - low) / 40
        for i in range(41):
            omega = low + i * step
            highest, _ = full_load(omega, drive.engine)
            torque = max(resistance * v / omega, drive.engine.lowest_nm)
            if torque <= highest and torque * omega <= (resistance + drive.brake_n) * v * (1.0 + CLOSE):
                fuel = fuel_power_w(omega, torque, drive.engine)
                if fuel < best.fuel_w:
                    best = Hold(fuel, 0, omega, torque, max(torque * omega / v - resistance, 0.0))
        low = max(best.engine_radps - step, drive.engine.lowest_radps)
        high = min(best.engine_radps + step, drive.engine.highest_radps)
    return best


@kernel
def keeping_w(v: float, free_changes: bool, drive: DriveNumbers) -> float:
    """Return the least average fuel power that keeps about a speed, W; infinite where the speed can't be kept.

    It is the price of time at which going up and down again costs nothing. Brakes of a CVT or a Willans drive are part
    of both `steady` and the way down.
    """
    held = steady(v, drive).fuel_w
    if not round_trip(v, 0.0, free_changes, drive).cost < math.inf:
        return held
    low, high = -1e3, 0.0
    if held < math.inf:
        low = -held * (1.0 - 1e-9)
        if round_trip(v, low, free_changes, drive).cost >= 0.0:
            return held
    else:
        while round_trip(v, low, free_changes, drive).cost > 0.0:
            low *= 4.0
    at_low, at_high = math.inf, round_trip(v, high, free_changes, drive).cost
    for _ in range(STEPS):
        middle = 0.5 * (low + high)
        if -at_low < math.inf and at_low < 0.0:
            middle = (low * at_high - high * at_low) / (at_high - at_low)
        if high - low < CLOSE * abs(low) or not low < middle < high:
            break
        off = round_trip(v, middle, free_changes, drive).cost
        if off > 0.0:
            settled = high - middle < CLOSE * abs(middle)
            high, at_high, at_low = middle, off, 0.5 * at_low
        else:
            settled = middle - low < CLOSE * abs(middle)
            low, at_low, at_high = middle, off, 0.5 * at_high
        if settled:
            return -middle
    return -0.5 * (low + high)
