"""A control that is held for a while, and the one that gives a force: the plain model, compiled for single steps."""

from __future__ import annotations

import math

from app.science.jit import kernel
from app.science.optimal.accelerate.kernels import CVT, NEUTRAL, WILLANS, DriveNumbers
from app.science.optimal.kernels import fuel_power_w, full_load

STEPS = 2
TURNS = 60
NO_GEAR = -2
SAME_N = 1e-6


@kernel
def pushed(gear: int, v: float, share: float, turn: float, drive: DriveNumbers) -> tuple[float, float]:
    """Return force at the wheels, N, and fuel power, W; ``share`` and ``turn`` as in the plain model."""
    if gear == NEUTRAL:
        return 0.0, drive.idle_w
    if drive.kind == WILLANS:
        low, high = max(drive.power_w[0], drive.force_n[0] * v), min(drive.power_w[1], drive.force_n[1] * v)
        power = low + share * (high - low)
        return power / v, drive.willans[0] + drive.willans[1] * power + drive.willans[2] * power * power
    engine = drive.engine
    omega = v * drive.spd_1pm[gear]
    if drive.kind == CVT:
        omega = engine.lowest_radps + turn * (engine.highest_radps - engine.lowest_radps)
    highest, _ = full_load(min(max(omega, engine.lowest_radps), engine.highest_radps), engine)
    torque = engine.lowest_nm + share * (highest - engine.lowest_nm)
    return omega * torque / v, fuel_power_w(omega, torque, engine)


@kernel
def held(
    gear: int, v: float, share: float, turn: float, seconds: float, drive: DriveNumbers
) -> tuple[float, float, float]:
    """Return speed, distance and fuel after a control was held, by steps of RK4; a speed below 0 ends it."""
    h, x, fuel = seconds / STEPS, 0.0, 0.0
    mass, drag, rolling = drive.accelerated_kg, drive.drag_kgpm, drive.rolling_n
    for _ in range(STEPS):
        f1, p1 = pushed(gear, v, share, turn, drive)
        a1 = (f1 - drag * v * v - rolling) / mass
        v2 = v + 0.5 * h * a1
        if v2 <= 0.0:
            return -1.0, x, fuel
        f2, p2 = pushed(gear, v2, share, turn, drive)
        a2 = (f2 - drag * v2 * v2 - rolling) / mass
        v3 = v + 0.5 * h * a2
        f3, p3 = pushed(gear, v3, share, turn, drive)
        a3 = (f3 - drag * v3 * v3 - rolling) / mass
        v4 = v + h * a3
        if v3 <= 0.0 or v4 <= 0.0:
            return -1.0, x, fuel
        f4, p4 = pushed(gear, v4, share, turn, drive)
        a4 = (f4 - drag * v4 * v4 - rolling) / mass
        x += h * (v + h * (a1 + a2 + a3) / 6.0)
        fuel += h * (p1 + 2.0 * p2 + 2.0 * p3 + p4) / 6.0
        v += h * (a1 + 2.0 * a2 + 2.0 * a3 + a4) / 6.0
    return v, x, fuel


@kernel
def nearest_force(v: float, force_n: float, drive: DriveNumbers) -> tuple[int, float, float]:
    """Return gear, share and turn that give a force at the wheels or come nearest to it, on the least fuel.

    The gear is −2 where none can be engaged. A CVT's engine speeds are looked over.
    """
    off, burned = math.inf, math.inf
    best, best_share, best_turn = NO_GEAR, 0.0, 0.0
    engine = drive.engine
    for gear in range(len(drive.spd_1pm)):
        for k in range(TURNS + 1 if drive.kind == CVT else 1):
            turn = k / TURNS
            if drive.kind == WILLANS:
                low, high = max(drive.power_w[0], drive.force_n[0] * v), min(drive.power_w[1], drive.force_n[1] * v)
                given = min(max(force_n * v, low), high)
                pull, fuel = given / v, drive.willans[0] + drive.willans[1] * given + drive.willans[2] * given * given
            else:
                omega = v * drive.spd_1pm[gear]
                if drive.kind == CVT:
                    omega = engine.lowest_radps + turn * (engine.highest_radps - engine.lowest_radps)
                low = engine.lowest_nm
                high, _ = full_load(omega, engine)
                if not high > low:
                    continue
                given = min(max(force_n * v / omega, low), high)
                pull, fuel = given * omega / v, fuel_power_w(omega, given, engine)
            now = abs(pull - force_n)
            if now < off - SAME_N or (now <= off + SAME_N and fuel < burned):
                off, burned = now, fuel
                best, best_share, best_turn = gear, (given - low) / (high - low), turn
    return best, best_share, best_turn
