"""Dynamic programming over speed and time: from node to node at a constant acceleration (Sebesta 2010, B.2.3).

Steps end on nodes of speed, so nothing is interpolated and the drive that is found is one that can be driven. Neutral
is left out: what rolling does to the speed falls between the nodes.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.lib.stride_tricks import sliding_window_view

from app.science.arrays import FloatArray, IntArray
from app.science.optimal.accelerate.kernels import CVT, GEARS, WILLANS, DriveNumbers
from app.science.optimal.methods.found import Arc, Found, MethodFailed, joined
from app.science.optimal.methods.inverse import Forced, force_range_n, forced
from app.science.optimal.methods.model import resistance_n, wheels
from app.science.optimal.problem import Accelerate
from app.science.progress import Progress, between

SPEEDS = {GEARS: 2400, CVT: 800, WILLANS: 2400}
STEPS, FREE_STEPS, FREE_STEP_S = 48, 120, 0.18
LONGEST_STEP_S = 0.4
DEEPEST = 0.5
"""A drive that slows down first is looked for above this share of its first speed."""
LOBATTO = np.array([-1.0, -np.sqrt(0.2), np.sqrt(0.2), 1.0])
WEIGHTS = np.array([1.0, 5.0, 5.0, 1.0]) / 12.0
ROWS = 5
SLOWEST_MPS = 1e-2


@dataclass(frozen=True, slots=True)
class Grid:
    """Nodes of speed and of time, and what each step from a node costs by gear.

    Attributes
    ----------
    speed_mps : array, shape (nodes,)
    start, end : int
        Nodes of the first and of the last speed.
    step_s : float
    first_jump : int
        Nodes that the first column of the costs goes up.
    fuel_j : array, shape (nodes, jumps, gears)
        Infinite where a step can't be driven.
    """

    speed_mps: FloatArray
    start: int
    end: int
    step_s: float
    first_jump: int
    fuel_j: FloatArray


def dp_speed_time(problem: Accelerate, drive: DriveNumbers, free_s: float, progress: Progress) -> Found:
    """Return the cheapest drive over the grid; in free time the number of steps is chosen, too.

    Parameters
    ----------
    problem, drive
    free_s : float
        Time of the drive in free time: where there is more, the grid goes below the first speed.
    progress : callable

    Raises
    ------
    MethodFailed
        When no steps of the grid lead to the speed in that time.
    """
    steps = FREE_STEPS
    if problem.time_s is not None:
        steps = max(STEPS, int(np.ceil(problem.time_s / LONGEST_STEP_S)))
    step_s = FREE_STEP_S if problem.time_s is None else problem.time_s / steps
    deep = problem.time_s is not None and problem.time_s > free_s
    grid = gridded(problem, drive, step_s, deep, between(progress, 0.0, 0.6))
    path = _path(grid, steps, problem, between(progress, 0.6, 1.0))
    return _told(drive, grid, path)


def gridded(problem: Accelerate, drive: DriveNumbers, step_s: float, deep: bool, progress: Progress) -> Grid:
    """Return the grid with the fuel of every step; ``deep`` to below the first speed."""
    start, end = max(problem.from_speed_mps, SLOWEST_MPS), problem.to_speed_mps
    count = SPEEDS[drive.kind]
    width = (end - start) / count
    slowest = max(drive.engine.lowest_radps / drive.spd_1pm.max() if drive.kind == GEARS else SLOWEST_MPS, SLOWEST_MPS)
    lowest = max(slowest, DEEPEST * start)
    below = min(max(int((start - lowest) / width), 0), count // 2) if deep else 0
    speed: FloatArray = np.asarray(start + width * np.arange(-below, count + 1), dtype=np.float64)
    gears = range(len(drive.spd_1pm))
    ranges = [force_range_n(drive, gear, speed) for gear in gears]
    against = resistance_n(drive, speed)
    most = max(float((high - against).max()) for _, high in ranges) / drive.accelerated_kg
    least = min(float((low - against).min()) for low, _ in ranges) / drive.accelerated_kg
    first = int(np.floor(least * step_s / width)) if below else 0
    jumps = np.arange(min(first, 0), min(int(np.ceil(most * step_s / width)), count) + 1)
    accel: FloatArray = np.asarray(jumps * width / step_s, dtype=np.float64)
    fuel = np.empty((len(speed), len(jumps), len(drive.spd_1pm)))
    for gear in gears:
        progress(gear / len(drive.spd_1pm))
        total = np.zeros((len(speed), len(jumps)))
        for node, weight in zip(LOBATTO, WEIGHTS, strict=True):
            v = speed[:, None] + accel * (0.5 + 0.5 * node) * step_s
            v = np.where(v > 0.0, v, np.nan)
            total += weight * step_s * _fuel(drive, gear, v, accel).fuel_w
        fuel[:, :, gear] = np.where(np.isfinite(total), total, np.inf)
    return Grid(speed, below, len(speed) - 1, step_s, int(jumps[0]), fuel)


def _fuel(drive: DriveNumbers, gear: int, v: FloatArray, accel: FloatArray) -> Forced:
    return forced(drive, gear, v, drive.accelerated_kg * accel + resistance_n(drive, v))


def _path(grid: Grid, steps: int, problem: Accelerate, progress: Progress) -> list[tuple[int, int, int]]:
    """Return node, jump and gear of each step."""
    charge = problem.transmission.shift_cost_j
    nodes, jumps, gears = grid.fuel_j.shape
    togo = np.full((nodes, gears), np.inf)
    togo[grid.end] = 0.0
    chosen: list[tuple[IntArray, IntArray]] = []
    best, at, gear = np.inf, -1, 0
    offset = max(-grid.first_jump, 0)
    for k in range(steps):
        progress(k / steps)
        change = togo.min(axis=1, keepdims=True) + charge
        after = np.where(togo <= change, np.arange(gears), togo.argmin(axis=1)[:, None])
        padded = np.full((nodes + jumps - 1 + offset, gears), np.inf)
        padded[offset : offset + nodes] = np.minimum(togo, change)
        ahead = sliding_window_view(padded, jumps, axis=0)[offset + grid.first_jump :][:nodes]
        cost = grid.fuel_j + ahead.transpose(0, 2, 1)
        jump = cost.argmin(axis=1)
        togo = np.take_along_axis(cost, jump[:, None, :], axis=1)[:, 0, :]
        chosen.append((jump, after))
        if (problem.time_s is None or k == steps - 1) and togo[grid.start].min() < best:
            best, at, gear = float(togo[grid.start].min()), k, int(togo[grid.start].argmin())
    if not np.isfinite(best):
        raise MethodFailed("no steps of the grid lead to the speed in that time; pontryagin needs no grid.")
    return _followed(grid, chosen[: at + 1], gear)


def _followed(grid: Grid, chosen: list[tuple[IntArray, IntArray]], gear: int) -> list[tuple[int, int, int]]:
    """Follow the choices forwards from the first gear."""
    node, path = grid.start, []
    for jump, after in reversed(chosen):
        up = int(jump[node, gear])
        path.append((node, up, gear))
        node += up + grid.first_jump
        gear = int(after[node, gear])
    return path


def _told(drive: DriveNumbers, grid: Grid, path: list[tuple[int, int, int]]) -> Found:
    """Return the steps as a drive."""
    arcs, width = [], float(grid.speed_mps[1] - grid.speed_mps[0])
    share = np.linspace(0.0, 1.0, ROWS)
    fuel = x = 0.0
    for k, (node, column, gear) in enumerate(path):
        accel = (column + grid.first_jump) * width / grid.step_s
        elapsed = share * grid.step_s
        v = grid.speed_mps[node] + accel * elapsed
        control = _fuel(drive, gear, v, np.array(accel))
        at = wheels(drive, gear, v, control.share, control.turn)
        way = x + grid.speed_mps[node] * elapsed + 0.5 * accel * elapsed**2
        arcs.append(Arc(gear, k * grid.step_s + elapsed, way, v, at, np.zeros(ROWS)))
        fuel, x = fuel + float(grid.fuel_j[node, column, gear]), float(way[-1])
    return joined(drive, arcs, fuel, more={"grid": {"speeds": len(grid.speed_mps), "steps": len(path)}})
