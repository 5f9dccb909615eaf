"""Gear ratios read off a drive: where engine and wheels turn in the same proportion for long."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

import numpy as np

from app.science.arrays import FloatArray, IntArray
from app.science.optimal.problem import RADPS_PER_RPM
from app.science.vehicle.model import Vehicle

SLOWEST_MPS, SLOWEST_RADPS = 2.0, 80.0
STEADY_S, STEADY = 1.0, 0.012
"""A gear is in where the proportion changes by no more than this share within this time."""
BIN, REACH, APART = 0.01, 0.03, 0.1
"""In the logarithm of the ratio: histogram, half the width of a gear's peak, least distance of two gears."""
CONTRAST = 2.5
LEAST_S = 2.5
NEAR_IDLE = 1.3
"""A car that sails with its clutch open turns the engine in a steady proportion, too, but near idle."""
TOLERANCE = 0.05
SHORTEST_S = 0.5
RANGE = (1.2, 25.0)


def with_gears(columns: Mapping[str, FloatArray], vehicle: Vehicle) -> tuple[Mapping[str, FloatArray], Vehicle]:
    """Return a trip and its car with the gears that engine speed and speed show, where the car's file has none.

    The thrust then counts what the engine's own inertia takes in each gear, as it does for a car with known gears.

    Parameters
    ----------
    columns : mapping of arrays, shape (n,)
        States of the trip.
    vehicle : Vehicle

    Returns
    -------
    tuple
        Both as they were where the file has gears, or the drive shows none.
    """
    needed = {"t_s", "speed_mps", "engine_speed_radps", "thrust_n", "pitch_rad"}
    if vehicle.gear_ratios or not needed <= columns.keys():
        return columns, vehicle
    t, v, omega = columns["t_s"], columns["speed_mps"], columns["engine_speed_radps"]
    turning = (v > SLOWEST_MPS) & (omega > SLOWEST_RADPS)
    ratio = np.where(turning, omega * vehicle.wheel_radius_m / np.where(turning, v, 1.0), np.nan)
    driving = omega > NEAR_IDLE * vehicle.idle_rpm * RADPS_PER_RPM
    ratios = shown_ratios(t, np.where(driving, ratio, np.nan))
    if not ratios:
        return columns, vehicle
    geared = replace(vehicle, gear_ratios=ratios)
    gear = _gears(t, ratio, ratios)
    grip = vehicle.crr * np.cos(columns["pitch_rad"]) + np.sin(columns["pitch_rad"])
    against = vehicle.drag_area_kgpm * v**2 + vehicle.mass_kg * vehicle.gravity_mps2 * grip
    accel = (columns["thrust_n"] - against) / vehicle.accelerated_mass_kg(0)
    heavier = [geared.accelerated_mass_kg(k) - vehicle.accelerated_mass_kg(0) for k in range(len(ratios) + 1)]
    thrust = columns["thrust_n"] + np.array(heavier)[gear] * accel
    return {**columns, "gear": gear.astype(np.float64), "thrust_n": thrust}, geared


def shown_ratios(t_s: FloatArray, ratio: FloatArray) -> tuple[float, ...]:
    """Return the total ratios in which a car was driven for some seconds, the largest first.

    Parameters
    ----------
    t_s : array, shape (n,)
        In even steps.
    ratio : array, shape (n,)
        Turns of the engine for one of the wheels; NaN where unknown.
    """
    step = float(np.median(np.diff(t_s)))
    x = np.log(ratio)
    lag = max(round(STEADY_S / step), 1)
    steady = np.abs(x[lag:] - x[:-lag]) < STEADY
    x = (0.5 * (x[lag:] + x[:-lag]))[steady]
    edges = np.arange(np.log(RANGE[0]), np.log(RANGE[1]), BIN)
    seconds = np.histogram(x, edges)[0] * step
    half = round(REACH / BIN)
    inside = np.convolve(seconds, np.ones(2 * half + 1), mode="same")
    wide = np.convolve(seconds, np.ones(6 * half + 3), mode="same")
    around = 0.5 * (wide - inside)
    centres = 0.5 * (edges[1:] + edges[:-1])
    found: list[float] = []
    for k in np.argsort(-inside).tolist():
        if inside[k] < LEAST_S:
            break
        if inside[k] <= CONTRAST * around[k]:
            continue
        own = float(np.median(x[np.abs(x - centres[k]) < REACH + BIN]))
        if all(abs(own - other) > APART for other in found):
            found.append(own)
    return tuple(float(np.exp(one)) for one in sorted(found, reverse=True))


def _gears(t_s: FloatArray, ratio: FloatArray, ratios: tuple[float, ...]) -> IntArray:
    """Return the gear at each moment, 0 where none is seen or only for a moment."""
    off = np.abs(np.log(ratio)[:, np.newaxis] - np.log(np.array(ratios)))
    near = np.nan_to_num(off, nan=np.inf)
    gear = np.where(near.min(axis=1) < TOLERANCE, near.argmin(axis=1) + 1, 0)
    edges = np.concatenate(([0], np.flatnonzero(np.diff(gear)) + 1, [len(gear)]))
    for begin, end in zip(edges[:-1].tolist(), edges[1:].tolist(), strict=True):
        if t_s[end - 1] - t_s[begin] < SHORTEST_S:
            gear[begin:end] = 0
    return np.asarray(gear, dtype=np.int64)
