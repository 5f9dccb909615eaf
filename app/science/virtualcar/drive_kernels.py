"""The loop that drives: what the driver wants, what clutch, engine and brakes make of it, and how the car moves."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from app.science.arrays import FloatArray, IntArray
from app.science.jit import kernel
from app.science.virtualcar.kernels import FuelNumbers, curve, fuel_power, sampled

# What driver and clutch are doing.
_STANDING = 0
_LAUNCHING = 1
_IN_GEAR = 2
_SHIFTING = 3
_ROLLING = 4

_RADPS_PER_RPM = math.pi / 30.0
_STOP_BRAKING_MPS2 = 1.5
_PARK_BRAKING_MPS2 = 1.2
_FORCE_LAG_S = 0.15


class RoadNumbers(NamedTuple):
    """The road ahead, sampled every ``step_m``, and where to stop for how long."""

    step_m: float
    pitch_rad: FloatArray
    curvature_v_radpm: FloatArray
    limit_mps: FloatArray
    stop_m: FloatArray
    stop_wait_s: FloatArray


class CarNumbers(NamedTuple):
    """The car: ``ratio_1pm`` is ω/v by gear, ``accelerated_kg`` has the open clutch first."""

    ratio_1pm: FloatArray
    accelerated_kg: FloatArray
    mass_kg: float
    crr: float
    drag_kgpm: float
    gravity_mps2: float
    idle_radps: float
    full_load_radps: FloatArray
    full_load_nm: FloatArray
    drag_nm: float
    drag_nm_per_radps: float
    cut_radps: float


class DriverNumbers(NamedTuple):
    """The driver: styles by place (``from_m`` on), variations by time (every ``variation_s``), lengths of shifts."""

    engine_on_s: float
    leave_s: float
    engine_off_s: float
    from_m: FloatArray
    acceleration_mps2: FloatArray
    pedal: FloatArray
    shift_up_radps: FloatArray
    shift_down_radps: FloatArray
    launch_radps: FloatArray
    speed_share: FloatArray
    variation_s: float
    traffic: FloatArray
    pedal_variation: FloatArray
    shift_s: FloatArray


class DriveNumbers(NamedTuple):
    """What happened, one entry per step, the state at its start; thrust and fuel power are held over the step."""

    speed_mps: FloatArray
    distance_m: FloatArray
    thrust_n: FloatArray
    gear: IntArray
    engine_radps: FloatArray
    fuel_w: FloatArray


@kernel
def wanted_speed(
    t: float, v: float, s: float, gap: float, style: int, road: RoadNumbers, driver: DriverNumbers
) -> float:
    """Speed the driver aims at, m/s: the limit a little ahead, habit, traffic, and the next place to stop."""
    wanted = sampled(s + 0.6 * v, road.step_m, road.limit_mps) * driver.speed_share[style]
    wanted *= sampled(t, driver.variation_s, driver.traffic)
    if gap < 0.5 * v * v / _STOP_BRAKING_MPS2 + 0.3 * v:
        wanted = min(wanted, math.sqrt(2.0 * _STOP_BRAKING_MPS2 * max(gap - 0.3 * v, 0.0)))
    return float(wanted)


@kernel
def better_gear(gear: int, v: float, acceleration: float, style: int, car: CarNumbers, driver: DriverNumbers) -> int:
    """Gear the driver would change to at this speed, or 0 to stay."""
    ratio = car.ratio_1pm
    omega = v * ratio[gear - 1]
    if omega > driver.shift_up_radps[style] and gear < len(ratio) and acceleration > -0.5:
        return gear + 1 if v * ratio[gear] > 1.24 * car.idle_radps else 0
    if omega < driver.shift_down_radps[style] and gear > 1 and acceleration > -0.3:
        return gear - 1 if v * ratio[gear - 2] < 0.98 * driver.shift_up_radps[style] else 0
    return 0


@kernel
def rolling_gear(v: float, style: int, car: CarNumbers, driver: DriverNumbers) -> int:
    """Highest gear that suits the style when the clutch closes again at this speed; 0 to slip into first."""
    chosen = 0
    for gear in range(1, len(car.ratio_1pm) + 1):
        if v * car.ratio_1pm[gear - 1] > max(driver.shift_down_radps[style], 1.3 * car.idle_radps):
            chosen = gear
    if chosen == 0 and v * car.ratio_1pm[0] >= driver.launch_radps[style]:
        chosen = 1
    return chosen


@kernel
def drive(
    step_s: float, steps: int, road: RoadNumbers, car: CarNumbers, fuel: FuelNumbers, driver: DriverNumbers
) -> DriveNumbers:
    """Drive along the road in fixed steps.

    Thrust is held over a step and resistances are taken at its middle, so that v̇ = (F − resistance)/M_a holds exactly
    from step to step and energy is balanced to second order.
    """
    speed_mps = np.zeros(steps)
    distance_m = np.zeros(steps)
    thrust_n = np.zeros(steps)
    gears = np.zeros(steps, dtype=np.int64)
    engine_radps = np.zeros(steps)
    fuel_w = np.zeros(steps)
    first = car.ratio_1pm[0]
    doing, gear, next_gear = _STANDING, 0, 1
    v = s = omega = thrust = 0.0
    stop = style = shifts = 0
    wait_until, shift_until, quiet_until = driver.leave_s, 0.0, 0.0
    parking = False
    for k in range(steps):
        t = k * step_s
        while style + 1 < len(driver.from_m) and s >= driver.from_m[style + 1]:
            style += 1
        gap = road.stop_m[stop] - s if stop < len(road.stop_m) else np.inf
        pitch = sampled(s + 0.5 * step_s * v, road.step_m, road.pitch_rad)
        bend = sampled(s + 0.5 * step_s * v, road.step_m, road.curvature_v_radpm)
        slope = car.mass_kg * car.gravity_mps2 * math.sin(pitch)
        roll = car.mass_kg * car.crr * (car.gravity_mps2 * math.cos(pitch) + bend * v * v)
        resistance = car.drag_kgpm * v * v + roll + slope
        wanted = wanted_speed(t, v, s, gap, style, road, driver)
        parking = parking or t > driver.engine_off_s - 8.0 - v / _PARK_BRAKING_MPS2
        halting = parking or (wanted < 1.0 and gap < 2.0) or gap <= 0.0
        acceleration = min(max(0.9 * (wanted - v), -3.0), driver.acceleration_mps2[style])
        if halting:
            acceleration = min(acceleration, -_PARK_BRAKING_MPS2)
        pedal = min(max(driver.pedal[style] * sampled(t, driver.variation_s, driver.pedal_variation), 0.1), 1.0)
        aim = car.accelerated_kg[gear] * acceleration + resistance
        running = driver.engine_on_s <= t < driver.engine_off_s
        burned = fuel.idle_w
        held = False

        if doing == _STANDING:
            thrust = slope
            held = True
            omega += ((car.idle_radps if running else 0.0) - omega) * step_s / 0.3
            if t >= wait_until and not parking:
                doing, thrust = _LAUNCHING, 0.0
                if gap <= 2.0:
                    stop += 1
        elif doing == _LAUNCHING:
            omega += (driver.launch_radps[style] - omega) * step_s / 0.15
            strongest = max(pedal, 0.8) * curve(omega, car.full_load_radps, car.full_load_nm)
            thrust += (min(max(aim, 0.0), strongest * first) - thrust) * step_s / 0.2
            burned = fuel_power(omega, thrust / first, fuel)
            if v <= 0.0 and thrust < resistance:
                held = True
            if halting:
                doing = _ROLLING
            elif v * first >= omega:
                doing, gear, quiet_until = _IN_GEAR, 1, t + 0.4
        if doing == _SHIFTING:
            thrust = 0.0
            left = shift_until - t
            target = v * car.ratio_1pm[next_gear - 1]
            if left > step_s:
                omega += (target - omega) * step_s / left
            else:
                doing, gear, quiet_until = _IN_GEAR, next_gear, t + 0.8
        if doing == _ROLLING:
            omega += (car.idle_radps - omega) * step_s / 0.35
            thrust = min(thrust, 0.0)
            thrust += (min(aim, 0.0) - thrust) * step_s / _FORCE_LAG_S
            burned = fuel.idle_w
            if acceleration > 0.1:
                thrust = 0.0
                next_gear = rolling_gear(v, style, car, driver)
                if next_gear == 0:
                    doing = _LAUNCHING
                else:
                    doing, shift_until = _SHIFTING, t + 0.3
        if doing == _IN_GEAR:
            ratio = car.ratio_1pm[gear - 1]
            omega = v * ratio
            change = better_gear(gear, v, acceleration, style, car, driver) if t >= quiet_until else 0
            if omega < 1.18 * car.idle_radps:
                doing, gear, thrust = _ROLLING, 0, min(thrust, 0.0)
            elif change > 0:
                doing, gear, next_gear, thrust = _SHIFTING, 0, change, 0.0
                shift_until = t + driver.shift_s[shifts % len(driver.shift_s)]
                shifts += 1
            else:
                thrust += (aim - thrust) * step_s / _FORCE_LAG_S
                thrust = min(thrust, ratio * pedal * curve(omega, car.full_load_radps, car.full_load_nm))
                lowest = -(car.drag_nm + car.drag_nm_per_radps * omega)
                burned = fuel_power(omega, thrust / ratio, fuel)
                if thrust <= ratio * lowest and omega > car.cut_radps:
                    burned = 0.0

        if not running:
            burned = 0.0
        speed_mps[k], distance_m[k], gears[k] = v, s, gear
        thrust_n[k], engine_radps[k], fuel_w[k] = slope if held else thrust, omega, burned
        if held:
            continue
        faster = v + (thrust - resistance) / car.accelerated_kg[gear] * step_s
        if faster > 0.0 and not (faster < 0.05 and halting):
            s += 0.5 * (v + faster) * step_s
            v = faster
            continue
        s += 0.5 * v * step_s
        v = 0.0
        if doing != _LAUNCHING:
            doing, gear = _STANDING, 0
            wait_until = t + (road.stop_wait_s[stop] if gap < 3.0 else 3.0)
    return DriveNumbers(speed_mps, distance_m, thrust_n, gears, engine_radps, fuel_w)
