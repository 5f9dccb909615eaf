"""Multiple shooting: nodes along the drive, and Newton's method on the defects between them (Sebesta 2010, B.3.1.2).

The first guess is the thesis': a straight line from the first speed to the last. Each interval is integrated for
itself, over the changes of gear inside it.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from app.science.arrays import FloatArray
from app.science.optimal.accelerate.kernels import DriveNumbers
from app.science.optimal.methods.field_kernels import NO_GEAR, best_gear, rates_in
from app.science.optimal.methods.found import Found, MethodFailed, joined
from app.science.optimal.methods.shooting import SLOWEST_MPS, Shot, arc_of, costate_for, shoot
from app.science.optimal.problem import Accelerate
from app.science.progress import Progress

INTERVALS = 8
NEWTON_STEPS = 25
HALVINGS = 8
SHIFT = 1e-6
SETTLED = 1e-10
NOWHERE_MPS = 1e9
ROWS = 13


class Nodes(NamedTuple):
    """What Newton's method varies: speeds and costates at the nodes, (n,) each, and the time of the drive, s."""

    speed_mps: FloatArray
    costate: FloatArray
    time_s: float


@dataclass(frozen=True, slots=True)
class Boundary:
    """What the defects are measured against; scales make them of one size."""

    drive: DriveNumbers
    start_mps: float
    end_mps: float
    time_s: float | None
    costate_scale: float

    def unpacked(self, x: FloatArray) -> Nodes:
        """Return the nodes of a vector of unknowns."""
        inner = x[: 2 * INTERVALS - 1]
        costate = self.costate_scale * inner[::2]
        speed = np.append(self.start_mps, self.end_mps * inner[1::2])
        return Nodes(speed, costate, float(x[-1]) if self.time_s is None else self.time_s)

    def packed(self, nodes: Nodes) -> FloatArray:
        """Return nodes as a vector of unknowns."""
        inner = np.empty(2 * INTERVALS - 1)
        inner[::2], inner[1::2] = nodes.costate / self.costate_scale, nodes.speed_mps[1:] / self.end_mps
        return np.append(inner, nodes.time_s) if self.time_s is None else inner

    def flown(self, nodes: Nodes, k: int, shift_v: float = 0.0, shift_costate: float = 0.0) -> Shot:
        """Integrate from a node over one interval."""
        v, costate = nodes.speed_mps[k] + shift_v, nodes.costate[k] + shift_costate
        return shoot(self.drive, float(v), NOWHERE_MPS, float(costate), nodes.time_s / INTERVALS)

    def defects(self, nodes: Nodes, ends: list[FloatArray]) -> FloatArray:
        """Return how far the intervals miss the nodes after them, the last speed, and H = 0 where time is free."""
        flown = np.array([end[:2] for end in ends])
        wanted = np.column_stack((np.append(nodes.speed_mps[1:], self.end_mps), np.append(nodes.costate[1:], np.nan)))
        miss = ((flown - wanted) / (self.end_mps, self.costate_scale)).ravel()
        # the costate is free at the end; where time is free, too, H vanishes there instead
        miss[-1] = _h(self.drive, *flown[-1]) / self.costate_scale
        return np.asarray(miss if self.time_s is None else miss[:-1])


def multiple_shooting(problem: Accelerate, drive: DriveNumbers, progress: Progress) -> Found:
    """Return the extremal through nodes without defects.

    Raises
    ------
    MethodFailed
        When Newton's method does not come to rest, with the defect that is left.
    """
    start = max(problem.from_speed_mps, SLOWEST_MPS)
    nodes = _line(drive, start, problem.to_speed_mps, problem.time_s)
    at = Boundary(drive, start, problem.to_speed_mps, problem.time_s, float(nodes.costate.mean()))
    x = at.packed(nodes)
    ends = _ends(at, x)
    defects = at.defects(nodes, ends)
    steps = 0
    while np.abs(defects).max() > SETTLED:
        progress(min(steps / NEWTON_STEPS, 0.99))
        move = np.asarray(np.linalg.solve(_jacobian(at, x, ends), -defects))
        x, ends, defects, better = _damped(at, x, ends, defects, move)
        steps += 1
        if not better or steps == NEWTON_STEPS:
            break
    nodes = at.unpacked(x)
    left = float(np.abs(defects).max())
    if left > 1e3 * SETTLED:
        raise MethodFailed(
            f"Newton's method stops at a defect of {left:.2g} from a straight line as its first guess; single_shooting "
            "needs no guess of the speeds."
        )
    shots = [at.flown(nodes, k) for k in range(INTERVALS)]
    arcs, fuel, begin, distance = [], 0.0, 0.0, 0.0
    for shot in shots:
        for leg in shot.legs:
            if leg.end_s > leg.begin_s:
                arc = arc_of(drive, leg, ROWS)
                arcs.append(arc.later(begin, distance))
        fuel, begin, distance = fuel + float(shot.last[3]), begin + shot.end_s, distance + float(shot.last[2])
    mu = _h(drive, start, float(nodes.costate[0]))
    return joined(
        drive,
        arcs,
        fuel,
        mu_w=mu,
        more={"shooting": {"intervals": INTERVALS, "newton_steps": steps, "largest_defect": left}},
    )


def _line(drive: DriveNumbers, start: float, end: float, time_s: float | None) -> Nodes:
    """Return the first guess: speeds on a straight line, the costates that make H vanish there."""
    speed = np.linspace(start, end, INTERVALS + 1)
    costate = np.array([costate_for(drive, float(v), 0.0) for v in speed])
    accel = [rates_in(best_gear(v, c, drive), v, c, drive).accel_mps2 for v, c in zip(speed, costate, strict=True)]
    return Nodes(speed[:-1], costate[:-1], time_s or float(np.trapezoid(1.0 / np.array(accel), speed)))


def _h(drive: DriveNumbers, v: float, costate: float) -> float:
    gear = best_gear(v, costate, drive)
    return float("nan") if gear == NO_GEAR else float(rates_in(gear, v, costate, drive).h_w)


def _ends(at: Boundary, x: FloatArray) -> list[FloatArray]:
    nodes = at.unpacked(x)
    return [_end(at.flown(nodes, k), nodes) for k in range(INTERVALS)]


def _end(shot: Shot, nodes: Nodes) -> FloatArray:
    """Return where an interval ends; not a number where no gear carries on."""
    whole = shot.end_s >= nodes.time_s / INTERVALS * (1.0 - 1e-12)
    return shot.last if whole else np.full(4, np.nan)


def _jacobian(at: Boundary, x: FloatArray, ends: list[FloatArray]) -> FloatArray:
    """Return ∂defects/∂x: every unknown but the time moves one interval's end and one node."""
    nodes, base = at.unpacked(x), at.defects(at.unpacked(x), ends)
    columns = []
    for i in range(len(x)):
        moved = x.copy()
        moved[i] += SHIFT * max(abs(x[i]), 1e-3)
        shifted = at.unpacked(moved)
        if i == 2 * INTERVALS - 1:
            other = _ends(at, moved)
        else:
            k = (i + 1) // 2
            other = [*ends[:k], _end(at.flown(shifted, k), nodes), *ends[k + 1 :]]
        columns.append((at.defects(shifted, other) - base) / (moved[i] - x[i]))
    return np.column_stack(columns)


def _damped(
    at: Boundary, x: FloatArray, ends: list[FloatArray], defects: FloatArray, move: FloatArray
) -> tuple[FloatArray, list[FloatArray], FloatArray, bool]:
    """Take as much of a step as makes the defects smaller."""
    share = 1.0
    for _ in range(HALVINGS):
        trial = x + share * move
        if np.isfinite(trial).all() and at.unpacked(trial).speed_mps.min() > 0.0 and at.unpacked(trial).time_s > 0.0:
            there = _ends(at, trial)
            off = at.defects(at.unpacked(trial), there)
            if np.linalg.norm(off) < np.linalg.norm(defects):
                return trial, there, off, True
        share *= 0.5
    return x, ends, defects, False
