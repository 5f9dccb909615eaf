"""A car's wheels for controls between 0 and 1, in plain NumPy; takes complex numbers, for exact derivatives."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from app.science.arrays import AnyArray, FloatArray
from app.science.optimal.accelerate.kernels import CVT, GEARS, NEUTRAL, DriveNumbers


class Wheels(NamedTuple):
    """What a control does, each of the shape that speed and control broadcast to.

    Attributes
    ----------
    force_n : array
        At the wheels, before resistance.
    fuel_w : array
    engine_radps, torque_nm : array
        NaN where no engine speed is known.
    """

    force_n: AnyArray
    fuel_w: AnyArray
    engine_radps: AnyArray
    torque_nm: AnyArray


def resistance_n(drive: DriveNumbers, v: AnyArray) -> AnyArray:
    """Return drag and rolling resistance on the level, N."""
    return np.asarray(drive.drag_kgpm * v * v + drive.rolling_n)


def polynomial(drive: DriveNumbers, omega: AnyArray, torque: AnyArray) -> AnyArray:
    """Return fuel power, W."""
    total = np.zeros(np.broadcast_shapes(np.shape(omega), np.shape(torque)), np.result_type(omega, torque, 1.0))
    for i, row in enumerate(drive.engine.fuel_w):
        for j in np.flatnonzero(row):
            total = total + row[j] * omega**i * torque**j
    return np.asarray(total)


def highest_torque_nm(drive: DriveNumbers, omega: AnyArray) -> AnyArray:
    """Return full load at engine speeds, Nm; its derivative is that of the piece the speed lies in."""
    at, nm = drive.engine.full_load_radps, drive.engine.full_load_nm
    if len(at) < 2:
        return np.asarray(np.full(np.shape(omega), min([*nm, drive.engine.highest_nm])) + 0.0 * omega)
    k = np.clip(np.searchsorted(at, np.real(omega)) - 1, 0, len(at) - 2)
    inside = (np.real(omega) > at[0]) & (np.real(omega) < at[-1])
    line = nm[k] + (nm[k + 1] - nm[k]) / (at[k + 1] - at[k]) * (omega - at[k])
    line = np.where(inside, line, np.where(np.real(omega) <= at[0], nm[0], nm[-1]))
    return np.asarray(np.where(np.real(line) < drive.engine.highest_nm, line, drive.engine.highest_nm))


def engine_speed_share(drive: DriveNumbers, turn: AnyArray) -> AnyArray:
    """Return a CVT's engine speed, rad/s, for a share of its range."""
    return np.asarray(drive.engine.lowest_radps + turn * (drive.engine.highest_radps - drive.engine.lowest_radps))


def wheels(drive: DriveNumbers, gear: int | AnyArray, v: AnyArray, share: AnyArray, turn: AnyArray) -> Wheels:
    """Return what a control does.

    Parameters
    ----------
    drive : DriveNumbers
    gear : int or int array
        From 0; −1 is neutral, as a single number only.
    v : array
        Speed, m/s.
    share : array
        Torque (for a Willans drive: power at the wheels) between its lowest, 0, and its highest, 1, at this speed.
    turn : array
        Engine speed of a CVT between its lowest, 0, and its highest, 1.
    """
    if isinstance(gear, int) and gear == NEUTRAL:
        nothing = np.zeros(np.shape(v))
        return Wheels(nothing + 0.0 * v, nothing + drive.idle_w, nothing + np.nan, nothing + np.nan)
    if drive.kind not in (GEARS, CVT):
        low = np.where(drive.power_w[0] > drive.force_n[0] * np.real(v), drive.power_w[0], drive.force_n[0] * v)
        high = np.where(drive.power_w[1] < drive.force_n[1] * np.real(v), drive.power_w[1], drive.force_n[1] * v)
        power = low + share * (high - low)
        c0, c1, c2 = drive.willans
        unknown = np.full(np.shape(power), np.nan)
        return Wheels(power / v, c0 + c1 * power + c2 * power**2, unknown, unknown)
    omega = v * drive.spd_1pm[gear] if drive.kind == GEARS else engine_speed_share(drive, turn) + 0.0 * v
    torque = drive.engine.lowest_nm + share * (highest_torque_nm(drive, omega) - drive.engine.lowest_nm)
    omega, torque = np.broadcast_arrays(omega, torque)
    return Wheels(omega * torque / v, polynomial(drive, omega, torque), omega, torque)


def usable(drive: DriveNumbers, gear: int, v: FloatArray) -> AnyArray:
    """Tell at which speeds a gear can be engaged."""
    if gear == NEUTRAL or drive.kind != GEARS:
        return np.ones(np.shape(v), dtype=bool)
    omega, slack = v * drive.spd_1pm[gear], 1e-9 * drive.engine.highest_radps
    inside = (omega >= drive.engine.lowest_radps - slack) & (omega <= drive.engine.highest_radps + slack)
    return np.asarray(inside & (highest_torque_nm(drive, omega) >= drive.engine.lowest_nm))
