"""Direct single shooting: controls held over intervals, one integration, a nonlinear programme (Sebesta 2010, B.3.2.1).

Limits of engine speed are constraints at the ends of the phases or, with ``penalty``, a cost that grows until they hold
(B.2.5.3).
"""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import NamedTuple

import numpy as np
from scipy.optimize import OptimizeResult

from app.science.arrays import AnyArray, FloatArray
from app.science.optimal.accelerate.kernels import GEARS, NEUTRAL, DriveNumbers
from app.science.optimal.methods.found import Found, MethodFailed
from app.science.optimal.methods.programme import (
    J_SCALE,
    KEPT,
    STARTS,
    V_SCALE,
    Controls,
    Phases,
    minimised,
    phases_of,
    revived,
    rolled_out,
)
from app.science.optimal.problem import Accelerate
from app.science.progress import Progress, between

STEP = 1e-30
GROWTH = 10.0
ROUNDS = 9
HELD = 1e-4
"""A limit counts as kept when it is left by less than this share of it."""


class Simulated(NamedTuple):
    """A drive by its controls: last speed, fuel, the penalised integral, and speeds at the phases' ends."""

    speed_mps: AnyArray
    fuel_j: AnyArray
    outside_s: AnyArray
    ends_mps: AnyArray


@dataclass
class Programme:
    """The nonlinear programme; the last point that was simulated is kept, as cost and constraints ask for the same."""

    phases: Phases
    weight_w: float | None
    _x: FloatArray = field(default_factory=lambda: np.empty(0))
    _values: tuple[FloatArray, FloatArray] = field(default_factory=lambda: (np.empty(0), np.empty(0)))

    def unpacked(self, x: AnyArray) -> Controls:
        """Return the controls of unknowns, shape (unknowns, …)."""
        phases, count = len(self.phases.gears), len(self.phases.gears) * self.phases.intervals
        return Controls(x[:phases], x[phases : phases + count], x[phases + count :])

    def simulate(self, controls: Controls) -> Simulated:
        """Drive; controls may have a second axis of perturbations."""
        v = self.phases.start_mps + 0.0 * controls.seconds[0]
        fuel = outside = 0.0 * v
        ends = []
        for phase, gear in enumerate(self.phases.gears):
            ends.append(v)
            seconds = controls.seconds[phase] / self.phases.intervals
            for k in range(phase * self.phases.intervals, (phase + 1) * self.phases.intervals):
                turn = controls.turn[k] if self.phases.turns else 0.0 * v
                moved = self.phases.step(gear, v, controls.share[k], turn, seconds, self.phases.substeps)
                before = self.outside(phase, v)
                v, fuel = moved.speed_mps, fuel + moved.fuel_j
                outside = outside + 0.5 * seconds * (before + self.outside(phase, v))
            ends.append(v)
        return Simulated(v, fuel, outside, np.array(ends))

    def outside(self, phase: int, v: AnyArray) -> AnyArray:
        """Return the square of how far, as a share, a speed is outside the gear's."""
        low, high = self.phases.limits_mps(phase)
        over = np.where(np.real(v) > high, v / high - 1.0, 0.0) if np.isfinite(high) else 0.0 * v
        under = np.where(np.real(v) < low, 1.0 - v / low, 0.0) if low > 0.0 else 0.0 * v
        return np.asarray(over**2 + under**2)

    def values(self, x: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Return cost, last speed, room at the limits, and their derivatives, shape (values, unknowns)."""
        if not np.array_equal(x, self._x):
            shifted = x[:, None] + 1j * STEP * np.eye(len(x))
            found = self.simulate(self.unpacked(np.column_stack((x + 0j, shifted))))
            cost = (found.fuel_j + (self.weight_w or 0.0) * found.outside_s) / J_SCALE
            table = np.vstack((cost, found.speed_mps / V_SCALE, self._room(found.ends_mps)))
            self._x, self._values = x.copy(), (np.real(table[:, 0]), np.imag(table[:, 1:]) / STEP)
        return self._values

    def _room(self, ends: AnyArray) -> AnyArray:
        rows = [np.zeros((0, ends.shape[1]))]
        for phase, gear in enumerate(self.phases.gears):
            low, high = self.phases.limits_mps(phase)
            if self.weight_w is None and gear != NEUTRAL and self.phases.drive.kind == GEARS:
                pair = ends[2 * phase : 2 * phase + 2]
                rows += [pair / V_SCALE - low / V_SCALE, high / V_SCALE - pair / V_SCALE]
        return np.vstack(rows)

    def solved(self, x: FloatArray, progress: Progress) -> OptimizeResult:
        """Return SLSQP's result from a first guess."""
        phases, wanted = len(self.phases.gears), self.phases.problem.to_speed_mps / V_SCALE
        time_s = self.phases.problem.time_s
        total = np.append(np.ones(phases), np.zeros(len(x) - phases))
        constraints: list[dict[str, object]] = [
            {"type": "eq", "fun": lambda x: self.values(x)[0][1] - wanted, "jac": lambda x: self.values(x)[1][1]}
        ]
        if len(self.values(x)[0]) > 2:
            constraints.append(
                {"type": "ineq", "fun": lambda x: self.values(x)[0][2:], "jac": lambda x: self.values(x)[1][2:]}
            )
        if time_s is not None:
            constraints.append({"type": "eq", "fun": lambda x: x[:phases].sum() - time_s, "jac": lambda _x: total})
        bounds: list[tuple[float, float | None]] = [(0.0, None)] * phases
        bounds += [(0.0, 1.0)] * (len(x) - phases)
        return minimised(lambda x: (self.values(x)[0][0], self.values(x)[1][0]), constraints, x, bounds, progress)

    def missed(self, x: FloatArray) -> float:
        """Return by how much constraints are missed."""
        values, _ = self.values(x)
        off = abs(values[1] - self.phases.problem.to_speed_mps / V_SCALE)
        return float(max(off, -min(values[2:], default=0.0)))


def direct_single_shooting(
    problem: Accelerate, drive: DriveNumbers, penalty: float | None, free_s: float, progress: Progress
) -> Found:
    """Return the best drive of the programme from two first guesses.

    Parameters
    ----------
    problem, drive
    penalty : float or None
        First weight, W, of the squared share by which engine speed is beyond its limits.
    free_s : float
        Time of the drive in free time: where there is more, a phase to slow down in goes ahead.
    progress : callable

    Raises
    ------
    MethodFailed
        When no guess leads to a drive that keeps the constraints.
    """
    phases = phases_of(problem, drive, free_s)
    found = []
    for k, share in enumerate(STARTS):
        part = between(progress, k / len(STARTS), (k + 1) / len(STARTS))
        x = np.concatenate(phases.guessed(share))
        found.append(_penalised(phases, x, penalty, part) if penalty else _limited(phases, x, part))
    good = [one for one in found if one is not None]
    if not good:
        raise MethodFailed("the programme keeps its constraints from none of its first guesses; pontryagin needs none.")
    return min(good, key=lambda one: one.fuel_j)


def _limited(phases: Phases, x: FloatArray, progress: Progress) -> Found | None:
    """Solve, and once more with the gears that got no time brought back in; the better of both."""
    programme, best = Programme(phases, None), None
    for again in (False, True):
        if again:
            x = revived(phases, x)
        result = programme.solved(x, between(progress, 0.5 * again, 0.5 + 0.5 * again))
        x = result.x
        if programme.missed(x) <= KEPT and (best is None or result.fun < best.fun):
            best = result
    return None if best is None else rolled_out(phases, programme.unpacked(best.x), best)


def _penalised(phases: Phases, x: FloatArray, weight_w: float, progress: Progress) -> Found | None:
    """Let the weight grow until the limits are kept, each time from the drive before."""
    rounds: list[dict[str, float]] = []
    for k in range(ROUNDS):
        programme = Programme(phases, weight_w)
        result = programme.solved(x, between(progress, k / ROUNDS, (k + 1) / ROUNDS))
        x = result.x
        now = programme.simulate(programme.unpacked(x[:, None]))
        left = float(np.sqrt(max(programme.outside(i // 2, v).max() for i, v in enumerate(now.ends_mps))))
        rounds.append({"weight_w": weight_w, "violation": left, "fuel_energy_j": float(now.fuel_j[0])})
        weight_w *= GROWTH
        if left <= HELD:
            break
    if programme.missed(x) > KEPT:
        return None
    return rolled_out(phases, programme.unpacked(x), result, penalty=rounds)
