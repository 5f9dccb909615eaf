"""The other way round: which control gives a force at the wheels, and what it burns."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from app.science.arrays import BoolArray, FloatArray
from app.science.optimal.accelerate.kernels import CVT, GEARS, WILLANS, DriveNumbers
from app.science.optimal.methods.model import highest_torque_nm, polynomial, usable

TURNS = 61
SLACK = 1e-9


class Forced(NamedTuple):
    """A gear's way to give forces: fuel power, W, infinite where it can't, and shares of torque and engine speed."""

    fuel_w: FloatArray
    share: FloatArray
    turn: FloatArray


def forced(drive: DriveNumbers, gear: int, v: FloatArray, force_n: FloatArray) -> Forced:
    """Return what a force at the wheels takes in a gear (from 0); a CVT takes the cheapest of its engine speeds."""
    v, force_n = np.broadcast_arrays(v, force_n)
    if drive.kind == WILLANS:
        low, high = at_wheels_w(drive, v)
        share = (force_n * v - low) / (high - low)
        c0, c1, c2 = drive.willans
        power = force_n * v
        return _where(_within(share), c0 + c1 * power + c2 * power**2, share, np.zeros(v.shape))
    if drive.kind == GEARS:
        omega = v * drive.spd_1pm[gear]
        return _at(drive, omega, force_n * v / omega, usable(drive, gear, v), np.zeros(v.shape))
    best = Forced(np.full(v.shape, np.inf), np.zeros(v.shape), np.zeros(v.shape))
    span = drive.engine.highest_radps - drive.engine.lowest_radps
    for turn in np.linspace(0.0, 1.0, TURNS):
        omega = np.full(v.shape, drive.engine.lowest_radps + turn * span)
        now = _at(drive, omega, force_n * v / omega, np.ones(v.shape, dtype=bool), np.full(v.shape, turn))
        better = now.fuel_w < best.fuel_w
        best = Forced(*(np.where(better, one, two) for one, two in zip(now, best, strict=True)))
    return best


def _at(drive: DriveNumbers, omega: FloatArray, torque: FloatArray, can: BoolArray, turn: FloatArray) -> Forced:
    lowest = drive.engine.lowest_nm
    room = np.maximum(highest_torque_nm(drive, omega) - lowest, SLACK)
    share = (torque - lowest) / room
    return _where(can & _within(share), polynomial(drive, omega, torque), share, turn)


def _where(can: BoolArray, fuel: FloatArray, share: FloatArray, turn: FloatArray) -> Forced:
    return Forced(np.where(can, fuel, np.inf), np.clip(share, 0.0, 1.0), turn)


def _within(share: FloatArray) -> BoolArray:
    return np.asarray((share >= -SLACK) & (share <= 1.0 + SLACK))


def at_wheels_w(drive: DriveNumbers, v: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Return the lowest and highest power at the wheels of a Willans drive, W."""
    low = np.maximum(drive.power_w[0], drive.force_n[0] * v)
    return low, np.maximum(np.minimum(drive.power_w[1], drive.force_n[1] * v), low + SLACK)


def force_range_n(drive: DriveNumbers, gear: int, v: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Return the least and the greatest force a gear gives, N; a range from ∞ to −∞ where it can't be engaged."""
    if drive.kind == WILLANS:
        low, high = at_wheels_w(drive, v)
        return low / v, high / v
    if drive.kind == CVT:
        omega = np.linspace(drive.engine.lowest_radps, drive.engine.highest_radps, TURNS)[:, None]
        top = omega * highest_torque_nm(drive, omega) / np.ravel(v)
        bottom = omega * drive.engine.lowest_nm / np.ravel(v)
        return bottom.min(axis=0).reshape(np.shape(v)), top.max(axis=0).reshape(np.shape(v))
    omega, can = v * drive.spd_1pm[gear], usable(drive, gear, v)
    low, high = drive.spd_1pm[gear] * drive.engine.lowest_nm, drive.spd_1pm[gear] * highest_torque_nm(drive, omega)
    return np.where(can, low, np.inf), np.where(can, high, -np.inf)
