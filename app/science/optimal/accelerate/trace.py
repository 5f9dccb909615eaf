"""A solution as a drive over time."""

from __future__ import annotations

from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from app.science.arrays import FloatArray
from app.science.optimal.accelerate.integral_kernels import INSET, corner, limit_at
from app.science.optimal.accelerate.kernels import GEARS, DriveNumbers, cheapest_in
from app.science.optimal.accelerate.lingering import Linger
from app.science.optimal.accelerate.plan import Phase
from app.science.optimal.accelerate.solve import Solution
from app.science.optimal.accelerate.trace_kernels import points
from app.science.optimal.answer import Trajectory

POINTS = 33
PULSE_POINTS = 3
REFINEMENTS = 4
LOOKS = 49
BESIDE = 3e-8
"""How sharply corners are known, of the speed."""
COARSE = 0.05


@dataclass(frozen=True, slots=True)
class Drive:
    """A drive over time with its costate, each of shape (n,), and the gears with the speeds of their changes."""

    trajectory: Trajectory
    costate: FloatArray
    accel_mps2: FloatArray
    gears: tuple[int, ...]
    switch_speeds_mps: tuple[float, ...]


def traced(solution: Solution, drive: DriveNumbers) -> Drive:
    """Return a solution as a drive over time."""
    parts: list[tuple[int, FloatArray, FloatArray]] = [
        along(phase, drive) for phase in (*solution.slowing.phases, *solution.before.phases)
    ]
    if solution.linger is not None and solution.linger.seconds > 0.0:
        parts += lingered(solution.linger, drive)
    parts += [along(phase, drive) for phase in solution.rising.phases]
    time = distance = 0.0
    rows, speeds, gears = [], [], []
    sequence: list[int] = []
    switches: list[float] = []
    for gear, v, found in parts:
        shifted = found.copy()
        shifted[:, 0] += time
        shifted[:, 1] += distance
        time, distance = shifted[-1, 0], shifted[-1, 1]
        shown = shown_gear(gear, drive)
        if not sequence or shown != sequence[-1]:
            switches += [float(v[0])] if sequence else []
            sequence.append(shown)
        rows.append(shifted)
        speeds.append(v)
        gears.append(np.full(len(v), shown, np.int64))
    table, geared = np.concatenate(rows), drive.kind == GEARS
    trajectory = Trajectory(
        t_s=table[:, 0],
        distance_m=table[:, 1],
        speed_mps=np.concatenate(speeds),
        gear=np.concatenate(gears),
        engine_speed_radps=table[:, 2],
        torque_nm=table[:, 3],
        fuel_power_w=table[:, 4],
        brake_n=table[:, 5],
    )
    ends = (tuple(sequence), tuple(switches)) if geared or 0 in sequence[1:] else ((), ())
    return Drive(trajectory, table[:, 7], table[:, 6], *ends)


def shown_gear(gear: int, drive: DriveNumbers) -> int:
    """Return a gear as people count: from 1, 0 for neutral and for drives without gears."""
    return gear + 1 if drive.kind == GEARS else 0


def along(phase: Phase, drive: DriveNumbers, count: int = POINTS) -> tuple[int, FloatArray, FloatArray]:
    """Return a phase's gear, its speeds in driving order and the rows of `points`."""
    share = 0.5 - 0.5 * np.cos(np.pi * np.linspace(0.0, 1.0, count))
    even = phase.from_mps + (phase.to_mps - phase.from_mps) * (
        share if count > PULSE_POINTS else np.linspace(0, 1, count)
    )
    if count > PULSE_POINTS:
        inner = np.array(cuts(phase, drive)[1:-1])
        even = np.concatenate((even, inner * (1.0 - BESIDE), inner * (1.0 + BESIDE)))
    speeds = np.unique(even)
    slow, fast = sorted((phase.from_mps, phase.to_mps))
    speeds = speeds[(speeds >= slow) & (speeds <= fast)]
    speeds = speeds if phase.to_mps > phase.from_mps else speeds[::-1].copy()
    speeds[0], speeds[-1] = phase.from_mps, phase.to_mps
    rows = points(phase.gear, speeds, phase.price, drive)
    for _ in range(REFINEMENTS if count > PULSE_POINTS else 0):
        power = rows[:, 4]
        steps = np.flatnonzero(np.abs(np.diff(power)) > COARSE * np.abs(power).max())
        if not len(steps):
            break
        speeds = np.insert(speeds, steps + 1, 0.5 * (speeds[steps] + speeds[steps + 1]))
        rows = points(phase.gear, speeds, phase.price, drive)
    return phase.gear, speeds, rows


def cuts(phase: Phase, drive: DriveNumbers) -> list[float]:
    """Return a phase's speeds in driving order at which the control may have a corner or jump, ends included."""
    low, high = sorted((phase.from_mps, phase.to_mps))
    found = [low, *phase.corners_mps, high]
    fine = np.unique(np.concatenate((np.linspace(low, high, LOOKS), np.array(phase.corners_mps))))
    inset = INSET * (high - low)
    near = np.clip(fine, low + inset, high - inset)
    limits = [limit_at(phase.gear, float(v), phase.price, drive) for v in near]
    for k, (one, two) in enumerate(pairwise(limits)):
        if one != two:
            found.append(float(corner(phase.gear, float(fine[k]), float(fine[k + 1]), phase.price, drive)))
    return sorted(set(found), reverse=phase.price.sign < 0.0)


def lingered(stay: Linger, drive: DriveNumbers) -> list[tuple[int, FloatArray, FloatArray]]:
    """Return the time about a speed: held, or up and down in turn."""
    if stay.cycle:
        return [along(phase, drive, PULSE_POINTS) for phase in stay.cycle] * stay.cycles
    v, hold = stay.place.speed_mps, stay.hold
    up = cheapest_in(hold.gear, v, -stay.place.fuel_w * (1.0 - 1e-9), 1.0, 1.0, drive)
    row = [0.0, 0.0, hold.engine_radps, hold.torque_nm, hold.fuel_w, hold.brake_n, 0.0, up.cost]
    end = [stay.seconds, v * stay.seconds, *row[2:]]
    return [(hold.gear, np.array([v, v]), np.array([row, end]))]
