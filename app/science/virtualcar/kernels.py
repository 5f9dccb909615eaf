"""Hot loops of the virtual car: the engine's fuel, and driver plus longitudinal physics in fixed steps."""

from __future__ import annotations

import math

import numpy as np

from app.science.arrays import FloatArray
from app.science.jit import kernel

# Columns of the style table; one row per stretch of road.
STYLE_FROM_M = 0
STYLE_ACCELERATION = 1
STYLE_PEDAL = 2
STYLE_SHIFT_UP = 3
STYLE_SHIFT_DOWN = 4
STYLE_LAUNCH = 5
STYLE_SPEED = 6
STYLE_COLUMNS = 7

# Columns of the result table; one row per step.
SPEED = 0
DISTANCE = 1
THRUST = 2
GEAR = 3
ENGINE_SPEED = 4
FUEL_POWER = 5
DRIVE_COLUMNS = 6

# What the driver is doing.
_WAITING = 0
_LAUNCHING = 1
_DRIVING = 2
_SHIFTING = 3
_ROLLING = 4


@kernel
def interpolate(x: float, first: float, step: float, values: FloatArray) -> float:
    """Value at ``x`` of an array sampled at ``first + i · step``, linear, held at the ends."""
    position = (x - first) / step
    if position <= 0.0:
        return float(values[0])
    i = int(position)
    if i >= len(values) - 1:
        return float(values[-1])
    return float(values[i] + (position - i) * (values[i + 1] - values[i]))


@kernel
def lookup(x: float, xs: FloatArray, ys: FloatArray) -> float:
    """Value at ``x`` of a short curve, linear, held at the ends."""
    if x <= xs[0]:
        return float(ys[0])
    for i in range(1, len(xs)):
        if x <= xs[i]:
            return float(ys[i - 1] + (ys[i] - ys[i - 1]) * (x - xs[i - 1]) / (xs[i] - xs[i - 1]))
    return float(ys[-1])


@kernel
def engine_fuel_power(
    omega: float,
    torque: float,
    phi: FloatArray,
    table_omega: FloatArray,
    table_nm: FloatArray,
    table_w: FloatArray,
    idle_w: float,
) -> float:
    """Fuel power at an operating point, W, not below idle; polynomial φ unless a table is given."""
    if torque <= 0.0:
        return idle_w
    if len(table_omega) == 0:
        ratio = (
            phi[0] + phi[1] * omega + phi[2] * torque + phi[3] * omega * torque
            + phi[4] * omega * omega + phi[5] * torque * torque
        )  # fmt: skip
        return float(max(idle_w, omega * torque * ratio))
    i = 0
    while i < len(table_omega) - 2 and omega > table_omega[i + 1]:
        i += 1
    j = 0
    while j < len(table_nm) - 2 and torque > table_nm[j + 1]:
        j += 1
    a = (omega - table_omega[i]) / (table_omega[i + 1] - table_omega[i])
    a = min(max(a, 0.0), 1.0)
    b = (torque - table_nm[j]) / (table_nm[j + 1] - table_nm[j])
    b = min(b, 1.0)
    low = table_w[i, j] + a * (table_w[i + 1, j] - table_w[i, j])
    high = table_w[i, j + 1] + a * (table_w[i + 1, j + 1] - table_w[i, j + 1])
    return float(max(idle_w, low + b * (high - low)))


@kernel
def drive_kernel(
    step_s: float,
    steps: int,
    engine_on_s: float,
    leave_s: float,
    engine_off_s: float,
    road_step_m: float,
    road_pitch: FloatArray,
    road_curvature_v: FloatArray,
    road_limit: FloatArray,
    stop_m: FloatArray,
    stop_wait_s: FloatArray,
    styles: FloatArray,
    traffic: FloatArray,
    pedal: FloatArray,
    variation_step_s: float,
    shift_s: FloatArray,
    ratios_1pm: FloatArray,
    accelerated_mass: FloatArray,
    mass: float,
    crr: float,
    drag_area: float,
    gravity: float,
    idle_radps: float,
    full_load_radps: FloatArray,
    full_load_nm: FloatArray,
    drag_nm: float,
    drag_nm_per_radps: float,
    cut_radps: float,
    phi: FloatArray,
    table_omega: FloatArray,
    table_nm: FloatArray,
    table_w: FloatArray,
    idle_w: float,
) -> FloatArray:
    """Drive along the road; return one row of `DRIVE_COLUMNS` per step, the state at its start.

    Thrust is held over a step; resistances are taken at its middle, so that energy is balanced to second order.
    ``ratios_1pm`` are ω/v in each gear, 1/m; ``accelerated_mass`` has the open clutch first.
    """
    out = np.zeros((steps, 6))
    gears = len(ratios_1pm)
    mode = _WAITING
    gear = 0
    next_gear = 1
    v = 0.0
    s = 0.0
    omega = 0.0
    thrust = 0.0
    wait_until = leave_s
    stop = 0
    style = 0
    shift_count = 0
    shift_until = 0.0
    quiet_until = 0.0
    parking = False
    for k in range(steps):
        t = k * step_s
        while style + 1 < len(styles) and s >= styles[style + 1, 0]:
            style += 1
        pitch = interpolate(s + 0.5 * step_s * v, 0.0, road_step_m, road_pitch)
        curvature = interpolate(s + 0.5 * step_s * v, 0.0, road_step_m, road_curvature_v)
        roll = mass * crr * (gravity * math.cos(pitch) + curvature * v * v)
        slope = mass * gravity * math.sin(pitch)
        resistance = drag_area * v * v + roll + slope
        factor = interpolate(t, 0.0, variation_step_s, traffic)
        wanted = interpolate(s + 0.6 * v, 0.0, road_step_m, road_limit) * styles[style, 6] * factor
        if not parking and t > engine_off_s - 8.0 - v / 1.2:
            parking = True
        gap = 1e9
        if stop < len(stop_m):
            gap = stop_m[stop] - s
        braking = 1.5
        if gap < 0.5 * v * v / braking + 0.3 * v:
            wanted = min(wanted, math.sqrt(2.0 * braking * max(gap - 0.3 * v, 0.0)))
        halting = parking or (wanted < 1.0 and gap < 2.0) or gap <= 0.0
        acceleration = min(max(0.9 * (wanted - v), -3.0), styles[style, 1])
        if halting:
            acceleration = min(acceleration, -1.2)
        running = engine_on_s <= t < engine_off_s
        rpm = omega * 30.0 / math.pi
        cap = styles[style, 2] * interpolate(t, 0.0, variation_step_s, pedal)
        cap = min(max(cap, 0.05), 1.0)
        torque = 0.0
        fuel = 0.0
        held = False
        aim = accelerated_mass[gear] * acceleration + resistance

        if mode == _WAITING:
            thrust = slope
            omega += (idle_radps - omega) * min(1.0, step_s / 0.3)
            fuel = idle_w
            if t >= wait_until and not parking:
                mode = _LAUNCHING
                thrust = 0.0
                if gap <= 2.0:
                    stop += 1
        elif mode == _LAUNCHING:
            slip_speed = styles[style, 5] * math.pi / 30.0
            omega += (slip_speed - omega) * min(1.0, step_s / 0.15)
            torque = min(max(aim / ratios_1pm[0], 0.0), cap * lookup(omega, full_load_radps, full_load_nm))
            thrust += (torque * ratios_1pm[0] - thrust) * min(1.0, step_s / 0.2)
            torque = thrust / ratios_1pm[0]
            fuel = engine_fuel_power(omega, torque, phi, table_omega, table_nm, table_w, idle_w)
            if v <= 0.0 and thrust < resistance:
                held = True
            if halting:
                mode = _ROLLING
                thrust = 0.0
                fuel = idle_w
                torque = 0.0
            elif v * ratios_1pm[0] >= omega:
                mode = _DRIVING
                gear = 1
                quiet_until = t + 0.4
        elif mode == _SHIFTING:
            thrust = 0.0
            left = shift_until - t
            target = v * ratios_1pm[next_gear - 1]
            if left <= step_s:
                omega = target
                gear = next_gear
                mode = _DRIVING
                quiet_until = t + 0.8
            else:
                omega += (target - omega) * min(1.0, step_s / max(left, step_s))
            fuel = idle_w
        elif mode == _ROLLING:
            omega += (idle_radps - omega) * min(1.0, step_s / 0.35)
            fuel = idle_w
            thrust += (min(aim, 0.0) - thrust) * min(1.0, step_s / 0.15)
            if acceleration > 0.1:
                chosen = 0
                for g in range(gears):
                    if v * ratios_1pm[g] * 30.0 / math.pi > max(styles[style, 4], 1100.0):
                        chosen = g + 1
                thrust = 0.0
                if chosen == 0:
                    if v * ratios_1pm[0] < styles[style, 5] * math.pi / 30.0:
                        mode = _LAUNCHING
                    else:
                        chosen = 1
                if chosen > 0:
                    mode = _SHIFTING
                    next_gear = chosen
                    shift_until = t + 0.3

        if mode == _DRIVING:
            omega = v * ratios_1pm[gear - 1]
            rpm = omega * 30.0 / math.pi
            ratio = ratios_1pm[gear - 1]
            aim = accelerated_mass[gear] * acceleration + resistance
            thrust += (aim - thrust) * min(1.0, step_s / 0.15)
            torque = thrust / ratio
            highest = cap * lookup(omega, full_load_radps, full_load_nm)
            lowest = -(drag_nm + drag_nm_per_radps * omega)
            if torque > highest:
                torque = highest
                thrust = torque * ratio
            if torque < lowest:
                torque = lowest
            fuel = engine_fuel_power(omega, torque, phi, table_omega, table_nm, table_w, idle_w)
            if torque <= lowest and omega > cut_radps:
                fuel = 0.0
            changed = 0
            if t >= quiet_until:
                if rpm > styles[style, 3] and gear < gears and acceleration > -0.5:
                    if v * ratios_1pm[gear] > 1050.0 * math.pi / 30.0:
                        changed = gear + 1
                elif (
                    rpm < styles[style, 4]
                    and gear > 1
                    and acceleration > -0.3
                    and v * ratios_1pm[gear - 2] * 30.0 / math.pi < 0.98 * styles[style, 3]
                ):
                    changed = gear - 1
            if rpm < 1000.0:
                mode = _ROLLING
                gear = 0
                thrust = min(thrust, 0.0)
                fuel = idle_w
            elif changed > 0:
                next_gear = changed
                shift_until = t + shift_s[shift_count % len(shift_s)]
                shift_count += 1
                mode = _SHIFTING
                gear = 0
                thrust = 0.0
                fuel = idle_w

        if not running:
            fuel = 0.0
            omega = 0.0 if t < engine_on_s else omega * math.exp(-step_s / 0.2)
            if omega < 1.0:
                omega = 0.0
        out[k, 0] = v
        out[k, 1] = s
        out[k, 2] = slope if held else thrust
        out[k, 3] = gear
        out[k, 4] = omega
        out[k, 5] = fuel
        if mode == _WAITING or held:
            continue
        pull = (thrust - resistance) / accelerated_mass[gear]
        faster = v + pull * step_s
        if faster <= 0.0 or (faster < 0.05 and halting):
            s += 0.5 * v * step_s
            v = 0.0
            if mode != _LAUNCHING:
                mode = _WAITING
                gear = 0
                wait_until = t + 3.0
                if gap < 3.0:
                    wait_until = t + stop_wait_s[stop]
        else:
            s += 0.5 * (v + faster) * step_s
            v = faster
    return out
