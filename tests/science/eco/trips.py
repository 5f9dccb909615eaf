"""Trips whose truth is known: a car, its engine as a formula, and drives made of it."""

from __future__ import annotations

from typing import Any

import numpy as np

from app.science.arrays import FloatArray, IntArray
from app.science.vehicle.model import Vehicle

CAR = Vehicle(gear_ratios=(13.25, 9.604, 7.37, 5.796, 4.208, 3.23), crr=0.01)
COEFFICIENTS = (1500.0, 12.0, 0.05, 2.4, 0.002)
IDLE_W = 2964.4
FULL_LOAD = ((1000.0, 60.0), (2000.0, 90.0), (4500.0, 105.0), (5500.0, 85.0))
RPM = np.pi / 30.0


def fuel_w(omega: FloatArray, torque: FloatArray) -> FloatArray:
    """Return the fuel power of the known engine, cut in overrun."""
    k0, k1, k2, a, b = COEFFICIENTS
    return np.maximum(k0 + k1 * omega + k2 * omega**2 + a * omega * torque + b * omega * torque**2, 0.0)


def map_document() -> dict[str, Any]:
    """Return the known engine's map, as if it had been driven everywhere up to full load."""
    cells = []
    for rpm in np.arange(1025.0, 5500.0, 150.0):
        for nm in np.arange(9.0, float(np.interp(rpm, *zip(*FULL_LOAD, strict=True))), 6.0):
            w = rpm * RPM
            eta = w * nm / float(fuel_w(np.array(w), np.array(nm)))
            cells.append({"rpm": rpm, "nm": nm, "n": 200, "efficiency": eta, "sd": 0.01, "bsfc_gpkwh": None})
    idle = {"rpm": 850.0, "fuel_power_w": IDLE_W, "seconds": 60.0}
    return {"cell": {"rpm": 50, "nm": 2}, "cells": cells, "full_load": [list(p) for p in FULL_LOAD], "idle": idle}


def states(
    t_s: FloatArray, speed_mps: FloatArray, accel_mps2: FloatArray, gear: IntArray, pitch_rad: FloatArray | float = 0.0
) -> dict[str, FloatArray]:
    """Return the states of a drive: thrust by its resistances, fuel by the known engine."""
    v, pitch = speed_mps, np.broadcast_to(np.asarray(pitch_rad, dtype=np.float64), speed_mps.shape)
    heavy = np.array([CAR.accelerated_mass_kg(k) for k in range(7)])[gear]
    grip = CAR.mass_kg * CAR.gravity_mps2 * (CAR.crr * np.cos(pitch) + np.sin(pitch))
    thrust = heavy * accel_mps2 + CAR.drag_area_kgpm * v**2 + grip
    ratio = np.array([0.0, *CAR.gear_ratios])[gear] / CAR.wheel_radius_m
    omega = np.where(gear > 0, ratio * v, 850.0 * RPM)
    torque = np.divide(thrust * v, omega, out=np.zeros_like(v), where=gear > 0)
    fuel = np.where(gear > 0, fuel_w(omega, torque), IDLE_W)
    steps = np.diff(t_s, prepend=t_s[0])
    return {
        "t_s": t_s,
        "distance_m": np.cumsum(v * steps),
        "speed_mps": v,
        "thrust_n": thrust,
        "pitch_rad": np.array(pitch),
        "heading_rad": np.zeros_like(v),
        "fuel_power_w": fuel,
        "engine_speed_radps": omega,
        "gear": gear.astype(np.float64),
    }


def driven(shift_up_rpm: float, *, seconds: float = 100.0, top_mps: float = 22.0) -> dict[str, FloatArray]:
    """Return a drive from stop to stop: a steady rise, a steady speed, and brakes, shifting up at an engine speed."""
    t = np.arange(0.0, seconds + 0.025, 0.05)
    rise, fall = 1.2, 1.6
    v = np.minimum(np.minimum(rise * (t - 2.0), top_mps), fall * (seconds - 2.0 - t)).clip(0.0)
    accel = np.gradient(v, t)
    gear = np.zeros(len(t), np.int64)
    now = 1
    for k, speed in enumerate(v.tolist()):
        ratios = [ratio / CAR.wheel_radius_m for ratio in CAR.gear_ratios]
        if speed < 2.6:
            now, gear[k] = 1, 0
            continue
        if now < 6 and speed * ratios[now - 1] > shift_up_rpm * RPM:
            now += 1
        while now > 1 and speed * ratios[now - 1] < 1150.0 * RPM:
            now -= 1
        gear[k] = now
    return states(t, v, accel, gear)
