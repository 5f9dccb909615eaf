"""Dynamic programming over speed and gear: a control is held over each cell of speed (Sebesta 2010, B.2.3).

An exact time is a root in the price of time; as controls on a grid make the time jump there, the drive takes the
cheaper of two neighbouring ones up to the speed at which the time comes out right.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise
from typing import NamedTuple

import numpy as np
from scipy.optimize import brentq

from app.science.arrays import FloatArray, IntArray
from app.science.optimal.accelerate.kernels import CVT, GEARS, DriveNumbers
from app.science.optimal.methods.found import Arc, Found, MethodFailed, joined
from app.science.optimal.methods.model import resistance_n, usable, wheels
from app.science.optimal.problem import Accelerate
from app.science.progress import Progress

CELLS = 160
SHARES, TURNS = 81, 49
COARSE_SHARES = 33
NODES, WEIGHTS = np.polynomial.legendre.leggauss(4)
SLOWEST_MPS = 1e-3
DEAREST_W = 1e9
ROWS = 3


class Held(NamedTuple):
    """A control held between two speeds: gear from 0, shares of torque and of a CVT's engine speeds."""

    gear: int
    from_mps: float
    to_mps: float
    share: float
    turn: float


@dataclass(frozen=True, slots=True)
class Cells:
    """What every control takes in every cell, arrays of shape (cells, gears, controls); infinite where impossible."""

    edges_mps: FloatArray
    share: FloatArray
    turn: FloatArray
    fuel_j: FloatArray
    time_s: FloatArray


def dp_speed(problem: Accelerate, drive: DriveNumbers, progress: Progress) -> Found:
    """Return the cheapest drive that holds one of some controls over each cell of speed.

    Raises
    ------
    MethodFailed
        When no control of the grid speeds the car up somewhere, or rising can't take so much time.
    """
    cells = tabulated(problem, drive)
    progress(0.5)
    charge = problem.transmission.shift_cost_j
    held, mu = _on_time(cells, charge, problem.time_s, drive)
    progress(0.9)
    return driven(drive, held, mu, {"cells": len(cells.edges_mps) - 1, "controls": len(cells.share)})


def tabulated(problem: Accelerate, drive: DriveNumbers) -> Cells:
    """Return what every control takes in every cell."""
    start, end = max(problem.from_speed_mps, SLOWEST_MPS), problem.to_speed_mps
    edges = np.linspace(start, end, CELLS + 1)
    if drive.kind == GEARS:
        limits = np.outer((drive.engine.lowest_radps, drive.engine.highest_radps), 1.0 / drive.spd_1pm).ravel()
        edges = np.union1d(edges, limits[(limits > start) & (limits < end)])
    if drive.kind == CVT:
        share, turn = (g.ravel() for g in np.meshgrid(np.linspace(0, 1, COARSE_SHARES), np.linspace(0, 1, TURNS)))
    else:
        share, turn = np.linspace(0.0, 1.0, SHARES), np.zeros(SHARES)
    gears = len(drive.spd_1pm)
    fuel = np.full((len(edges) - 1, gears, len(share)), np.inf)
    time = fuel.copy()
    for gear in range(gears):
        fuel[:, gear], time[:, gear] = _taken(drive, gear, edges[:-1, None], edges[1:, None], share, turn)
    return Cells(edges, share, turn, fuel, time)


def _taken(
    drive: DriveNumbers, gear: int, low: FloatArray, high: FloatArray, share: FloatArray, turn: FloatArray
) -> tuple[FloatArray, FloatArray]:
    """Return fuel, J, and time, s, of rising from one speed to another; infinite where a control does not."""
    half = 0.5 * (high - low)
    fuel = time = 0.0 * half * share
    can = usable(drive, gear, low) & usable(drive, gear, high)
    for node, weight in zip(NODES, WEIGHTS, strict=True):
        v = 0.5 * (low + high) + half * node
        at = wheels(drive, gear, v, share, turn)
        pull = at.force_n - resistance_n(drive, v)
        can = can & (pull > 0.0) & (at.fuel_w >= 0.0)
        slow = weight * half * drive.accelerated_kg / np.where(pull > 0.0, pull, 1.0)
        fuel, time = fuel + at.fuel_w * slow, time + slow
    return np.where(can, fuel, np.inf), np.where(can, time, np.inf)


def _plan(cells: Cells, charge: float, mu: float) -> tuple[IntArray, IntArray]:
    """Return gear and control in each cell for a price of time."""
    with np.errstate(invalid="ignore"):
        cost = np.where(np.isfinite(cells.time_s), cells.fuel_j + mu * cells.time_s, np.inf)
    control = cost.argmin(axis=2)
    least = cost.min(axis=2)
    count, gears = least.shape
    came = np.zeros((count, gears), dtype=np.int64)
    total = least[0]
    for k in range(1, count):
        other = int(total.argmin())
        change = total[other] + charge
        came[k] = np.where(total <= change, np.arange(gears), other)
        total = np.minimum(total, change) + least[k]
    if not np.isfinite(total.min()):
        raise MethodFailed("no control of the grid speeds the car up all the way; pontryagin is exact about limits.")
    gear = np.zeros(count, dtype=np.int64)
    gear[-1] = int(total.argmin())
    for k in range(count - 1, 0, -1):
        gear[k - 1] = came[k, gear[k]]
    return gear, control[np.arange(count), gear]


def _on_time(cells: Cells, charge: float, time_s: float | None, drive: DriveNumbers) -> tuple[list[Held], float]:
    """Return the drive cell by cell and the price of time it was planned with."""

    def time_of(plan: tuple[IntArray, IntArray]) -> float:
        return float(cells.time_s[np.arange(len(plan[0])), plan[0], plan[1]].sum())

    plan = _plan(cells, charge, 0.0)
    if time_s is None:
        return _held(cells, plan), 0.0
    slow = fast = plan
    low = high = 0.0
    step = 100.0
    while time_of(fast) > time_s:
        low, slow = high, fast
        high += step
        step *= 4.0
        if high > DEAREST_W:
            raise MethodFailed(f"{time_s:g} s are too short for the controls of the grid; pontryagin is exact.")
        fast = _plan(cells, charge, high)
    can = np.isfinite(cells.time_s)
    least = float((cells.fuel_j[can] / cells.time_s[can]).min())
    if time_of(slow) < time_s:
        low, slow = -least * (1.0 - 1e-9), _plan(cells, charge, -least * (1.0 - 1e-9))
        if time_of(slow) < time_s:
            raise MethodFailed(
                f"rising in {time_of(slow):.4g} s is the slowest that pays; a drive of {time_s:g} s stays or slows "
                "down on the way, which dp_speed_time can."
            )
    while high - low > 1e-9 * max(abs(high), abs(low), 1.0):
        middle = 0.5 * (low + high)
        plan = _plan(cells, charge, middle)
        if time_of(plan) > time_s:
            low, slow = middle, plan
        else:
            high, fast = middle, plan
    return _mixed(_held(cells, fast), _held(cells, slow), time_s, drive), high


def _held(cells: Cells, plan: tuple[IntArray, IntArray]) -> list[Held]:
    return [
        Held(int(gear), float(a), float(b), float(cells.share[control]), float(cells.turn[control]))
        for (a, b), gear, control in zip(pairwise(cells.edges_mps), *plan, strict=True)
    ]


def _mixed(fast: list[Held], slow: list[Held], time_s: float, drive: DriveNumbers) -> list[Held]:
    """Return the first drive up to a speed and the second from there, so that the time is as wanted."""
    of_fast, of_slow = ([_time(drive, one) for one in held] for held in (fast, slow))
    total = sum(of_slow)
    for k in range(len(fast)):
        shorter = total + of_fast[k] - of_slow[k]
        if shorter <= time_s:
            a, b = fast[k].from_mps, fast[k].to_mps

            def off(v: float, k: int = k, before: float = total - of_slow[k]) -> float:
                first, second = fast[k]._replace(to_mps=v), slow[k]._replace(from_mps=v)
                return before + _time(drive, first) + _time(drive, second) - time_s

            v = float(brentq(off, a, b, xtol=1e-14)) if off(a) > 0.0 > off(b) else b
            split = [fast[k]._replace(to_mps=v), slow[k]._replace(from_mps=v)]
            return [*fast[:k], *(one for one in split if one.to_mps > one.from_mps), *slow[k + 1 :]]
        total = shorter
    return fast


def _time(drive: DriveNumbers, held: Held) -> float:
    ends = np.array([held.from_mps]), np.array([held.to_mps])
    return float(_taken(drive, held.gear, *ends, np.array([held.share]), np.array([held.turn]))[1][0])


def driven(drive: DriveNumbers, held: Sequence[Held], mu: float, grid: dict[str, int]) -> Found:
    """Return controls held over speeds as a drive."""
    arcs: list[Arc] = []
    time = distance = fuel = 0.0
    for one in held:
        v = np.linspace(one.from_mps, one.to_mps, ROWS)
        share, turn = np.array([one.share]), np.array([one.turn])
        t, x = [time], [distance]
        for a, b in pairwise(v):
            low, high = np.array([a]), np.array([b])
            burned, taken = _taken(drive, one.gear, low, high, share, turn)
            fuel += float(burned[0])
            x.append(x[-1] + _metres(drive, one, low, high))
            t.append(t[-1] + float(taken[0]))
        time, distance = t[-1], x[-1]
        at = wheels(drive, one.gear, v, share, turn)
        arcs.append(Arc(one.gear, np.array(t), np.array(x), v, at, np.zeros(ROWS)))
    return joined(drive, arcs, fuel, mu_w=mu, more={"grid": grid})


def _metres(drive: DriveNumbers, held: Held, low: FloatArray, high: FloatArray) -> float:
    v = 0.5 * (low + high) + 0.5 * (high - low) * NODES
    at = wheels(drive, held.gear, v, np.array([held.share]), np.array([held.turn]))
    pull = at.force_n - resistance_n(drive, v)
    return float((0.5 * (high - low) * WEIGHTS * v * drive.accelerated_kg / pull).sum())
