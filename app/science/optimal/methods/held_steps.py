"""Drives made step by step by a feedback law: at each step it says gear and control, which are then held."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from app.science.arrays import FloatArray
from app.science.optimal.accelerate.kernels import DriveNumbers
from app.science.optimal.methods.found import Arc, Found, MethodFailed, joined
from app.science.optimal.methods.held_kernels import held
from app.science.optimal.methods.model import wheels

ROWS = 2
AS_WANTED = 1e-10
NEWTON_STEPS = 30
SHIFT_S = 1e-5


class Step(NamedTuple):
    """A control held for a time: gear from 0, shares of torque and of a CVT's engine speed."""

    gear: int
    share: float
    turn: float
    seconds: float


Law = Callable[[float, float], Step | None]
"""Takes time and speed, says what is held next; None where nothing can be."""


@dataclass(frozen=True, slots=True)
class Followed:
    """Steps that a law gave, and the speed and time they end at."""

    steps: tuple[Step, ...]
    speed_mps: float
    time_s: float


def follow(drive: DriveNumbers, start_mps: float, end_mps: float, longest_s: float, law: Law) -> Followed:
    """Follow a law until the speed is reached; the last step is cut there."""
    v, t = start_mps, 0.0
    steps: list[Step] = []
    while t < longest_s:
        step = law(t, v)
        if step is None:
            break
        after = held(step.gear, v, step.share, step.turn, step.seconds, drive)[0]
        if not after > 0.0:
            break
        if after >= end_mps:
            step = step._replace(seconds=_cut(drive, v, end_mps, step))
            return Followed((*steps, step), end_mps, t + step.seconds)
        steps.append(step)
        v, t = after, t + step.seconds
    return Followed(tuple(steps), v, t)


def _cut(drive: DriveNumbers, v: float, end_mps: float, step: Step) -> float:
    low, high = 0.0, step.seconds
    for _ in range(60):
        middle = 0.5 * (low + high)
        if held(step.gear, v, step.share, step.turn, middle, drive)[0] < end_mps:
            low = middle
        else:
            high = middle
    return high


def ended(drive: DriveNumbers, start_mps: float, steps: tuple[Step, ...]) -> tuple[float, float]:
    """Return the speed and the time at which steps end."""
    v = start_mps
    for step in steps:
        v = held(step.gear, v, step.share, step.turn, step.seconds, drive)[0]
    return v, sum(step.seconds for step in steps)


def exactly(
    drive: DriveNumbers, start_mps: float, end_mps: float, time_s: float, steps: tuple[Step, ...]
) -> tuple[Step, ...]:
    """Return the steps with two of them a little longer or shorter, so that speed and time come out as wanted.

    Raises
    ------
    MethodFailed
        When two steps can't make up for what is missing.
    """
    gains = [
        held(step.gear, v, step.share, step.turn, 0.01, drive)[0] - v
        for step, v in _with_speeds(drive, start_mps, steps)
    ]
    pair = int(np.argmax(gains)), int(np.argmin(gains))
    now = list(steps)
    for _ in range(NEWTON_STEPS):
        v, t = ended(drive, start_mps, tuple(now))
        off = np.array([v - end_mps, t - time_s])
        if np.abs(off / (end_mps, time_s)).max() < AS_WANTED:
            return tuple(now)
        slopes = []
        for k in pair:
            moved = [*now[:k], now[k]._replace(seconds=now[k].seconds + SHIFT_S), *now[k + 1 :]]
            slopes.append([(ended(drive, start_mps, tuple(moved))[0] - v) / SHIFT_S, 1.0])
        change = np.linalg.solve(np.array(slopes).T, -off)
        for k, seconds in zip(pair, change, strict=True):
            now[k] = now[k]._replace(seconds=now[k].seconds + float(seconds))
        if min(now[k].seconds for k in pair) <= 0.0:
            break
    raise MethodFailed(f"the drive misses {time_s:g} s by more than two of its steps can make up for.")


def _with_speeds(drive: DriveNumbers, start_mps: float, steps: tuple[Step, ...]) -> list[tuple[Step, float]]:
    v, found = start_mps, []
    for step in steps:
        found.append((step, v))
        v = held(step.gear, v, step.share, step.turn, step.seconds, drive)[0]
    return found


def fuel_j(drive: DriveNumbers, start_mps: float, steps: tuple[Step, ...]) -> float:
    """Return what steps burn, J."""
    return sum(
        held(step.gear, v, step.share, step.turn, step.seconds, drive)[2]
        for step, v in _with_speeds(drive, start_mps, steps)
    )


def told(
    drive: DriveNumbers, start_mps: float, steps: tuple[Step, ...], notes: tuple[str, ...], more: dict[str, object]
) -> Found:
    """Return steps as a drive."""
    arcs: list[Arc] = []
    t = x = fuel = 0.0
    for step, v in _with_speeds(drive, start_mps, steps):
        after, metres, burned = held(step.gear, v, step.share, step.turn, step.seconds, drive)
        speeds: FloatArray = np.array([v, after])
        at = wheels(drive, step.gear, speeds, np.array(step.share), np.array(step.turn))
        ends = np.array([t, t + step.seconds]), np.array([x, x + metres])
        arcs.append(Arc(step.gear, *ends, speeds, at, np.zeros(ROWS)))
        t, x, fuel = t + step.seconds, x + metres, fuel + burned
    return joined(drive, arcs, fuel, notes=notes, more=more)
