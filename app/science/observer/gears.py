"""Which gear is in, read off the ratio of the engine's speed to the wheels'."""

from __future__ import annotations

from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from app.science.arrays import BoolArray, FloatArray, IntArray
from app.science.logger.recording import Recording
from app.science.observer.prepass import engine_speed_before_filtering, speed_before_filtering
from app.science.vehicle.model import Vehicle

NODE_SPACING_S = 0.05
GEAR_TOLERANCE = 0.05
SHIFT_NEAR_S = 0.4


@dataclass(frozen=True, slots=True)
class Gears:
    """Gear at each node, shape (n,), 0 where none is in or it is unknown; and where the drive through it may change.

    ``changing`` marks the neighbourhood of gear changes and of the beginning and end of fuel cuts.
    """

    gear: IntArray
    changing: BoolArray


def read_gears(node_t: FloatArray, recording: Recording, vehicle: Vehicle) -> Gears:
    """Compare the engine's speed with the wheels'; without either, or without known ratios, every gear is 0."""
    gear = np.zeros(len(node_t), np.int64)
    speed = speed_before_filtering(node_t, recording, vehicle)
    omega = engine_speed_before_filtering(node_t, recording, vehicle)
    if speed is None or omega is None or not vehicle.gear_ratios:
        return Gears(gear, np.zeros(len(node_t), np.bool_))
    with np.errstate(divide="ignore", invalid="ignore"):
        ratio = omega * vehicle.wheel_radius_m / speed
    for number, known in enumerate(vehicle.gear_ratios, start=1):
        gear[(np.abs(ratio / known - 1.0) < GEAR_TOLERANCE) & (speed > 1.0)] = number
    gear = _without_flicker(gear)
    silent = np.isnan(omega) & (speed > 1.0)
    return Gears(_through_fuel_cuts(gear, silent), _near_change(np.where(silent, -1, gear)))


def _through_fuel_cuts(gear: IntArray, silent: BoolArray) -> IntArray:
    """Where the engine is silent, keep the gear that was in before and is in after."""
    gear = gear.copy()
    reach = round(SHIFT_NEAR_S / NODE_SPACING_S)
    for start, end in pairwise(np.flatnonzero(np.diff(silent.astype(np.int8))) + 1):
        before, after = gear[max(start - reach, 0) : start], gear[end : end + reach]
        if silent[start] and len(before) and len(after) and before.max() == after.max():
            around = gear[start - len(before) : end + len(after)]
            around[around == 0] = before.max()
    return gear


def _without_flicker(gear: IntArray, shortest: int = 5) -> IntArray:
    """Set runs of a gear shorter than ``shortest`` nodes to 0, and fill holes that short inside one gear."""
    gear = gear.copy()
    for sweep in ("fill", "drop"):
        edges = np.flatnonzero(np.diff(gear)) + 1
        starts = np.concatenate(([0], edges))
        ends = np.concatenate((edges, [len(gear)]))
        for start, end in zip(starts, ends, strict=True):
            if end - start >= shortest:
                continue
            before = gear[start - 1] if start > 0 else 0
            after = gear[end] if end < len(gear) else 0
            if sweep == "fill" and before == after:
                gear[start:end] = before
            elif sweep == "drop":
                gear[start:end] = 0
    return gear


def _near_change(gear: IntArray) -> BoolArray:
    reach = round(SHIFT_NEAR_S / NODE_SPACING_S)
    changed = np.flatnonzero(np.diff(gear) != 0)
    near = np.zeros(len(gear), np.bool_)
    for step in range(-reach + 1, reach + 1):
        near[np.clip(changed + step, 0, max(len(gear) - 1, 0))] = True
    return near
