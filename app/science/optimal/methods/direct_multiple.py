"""Direct multiple shooting: the speed at each interval's start is an unknown, too (Sebesta 2010, B.3.2.2).

Intervals are integrated side by side; that each ends where the next begins is a constraint.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from itertools import pairwise
from typing import NamedTuple

import numpy as np

from app.science.arrays import AnyArray, FloatArray
from app.science.optimal.accelerate.kernels import DriveNumbers
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


class Evaluated(NamedTuple):
    """Cost and constraints with their derivatives by all unknowns."""

    cost: float
    by_cost: FloatArray
    defects: FloatArray
    by_defects: FloatArray


@dataclass
class Programme:
    """Unknowns: seconds of phases, shares, turns, then speeds after each interval but the last, scaled."""

    phases: Phases
    _x: FloatArray = field(default_factory=lambda: np.empty(0))
    _found: Evaluated | None = None

    @property
    def controls(self) -> int:
        """How many unknowns come before the speeds."""
        count = len(self.phases.of_interval)
        return len(self.phases.gears) + count * (2 if self.phases.turns else 1)

    def unpacked(self, x: FloatArray) -> Controls:
        """Return the controls of unknowns."""
        phases, count = len(self.phases.gears), len(self.phases.of_interval)
        return Controls(x[:phases], x[phases : phases + count], x[phases + count : self.controls])

    def evaluated(self, x: FloatArray) -> Evaluated:
        """Return cost and defects; each interval depends on its speed, its controls and its phase's time only."""
        if self._found is not None and np.array_equal(x, self._x):
            return self._found
        phases, count = self.phases, len(self.phases.of_interval)
        of, all_k = np.array(phases.of_interval), np.arange(count)
        now = self.unpacked(x)
        begin = np.append(phases.start_mps, V_SCALE * x[self.controls :])
        parts = [begin, now.share, now.seconds[of] / phases.intervals, *([now.turn] if phases.turns else [])]
        stacked = [np.repeat(part[:, None] + 0j, len(parts) + 1, axis=1) for part in parts]
        for k, part in enumerate(stacked):
            part[:, k + 1] += 1j * STEP
        end, fuel = self._moved(of, stacked)
        where = [
            np.append(-1, self.controls + all_k[:-1]), len(phases.gears) + all_k, of,
            *([len(phases.gears) + count + all_k] if phases.turns else []),
        ]  # fmt: skip
        scales = [V_SCALE, 1.0, 1.0 / phases.intervals, 1.0]
        by_cost, by_defects = np.zeros(len(x)), np.zeros((count, len(x)))
        for k, columns in enumerate(where):
            inside = columns >= 0
            np.add.at(by_cost, columns[inside], scales[k] * np.imag(fuel[inside, k + 1]) / STEP / J_SCALE)
            by_defects[all_k[inside], columns[inside]] += scales[k] * np.imag(end[inside, k + 1]) / STEP / V_SCALE
        after = np.append(x[self.controls :], phases.problem.to_speed_mps / V_SCALE)
        by_defects[all_k[:-1], self.controls + all_k[:-1]] -= 1.0
        defects = np.real(end[:, 0]) / V_SCALE - after
        self._x = x.copy()
        self._found = Evaluated(float(np.real(fuel[:, 0]).sum()) / J_SCALE, by_cost, defects, by_defects)
        return self._found

    def _moved(self, of: AnyArray, parts: list[AnyArray]) -> tuple[AnyArray, AnyArray]:
        end, fuel = np.empty_like(parts[0]), np.empty_like(parts[0])
        for phase, gear in enumerate(self.phases.gears):
            v, share, seconds, *turn = (part[of == phase] for part in parts)
            moved = self.phases.step(gear, v, share, turn[0] if turn else 0.0 * v, seconds, self.phases.substeps)
            end[of == phase], fuel[of == phase] = moved.speed_mps, moved.fuel_j
        return end, fuel

    def first(self, share: float) -> FloatArray:
        """Return a first guess: speeds on a straight line within each phase."""
        guess = self.phases.guessed(share)
        speeds = np.linspace(self.phases.start_mps, self.phases.problem.to_speed_mps, len(self.phases.of_interval) + 1)
        return np.concatenate((*guess, speeds[1:-1] / V_SCALE))

    def bounds(self) -> list[tuple[float, float | None]]:
        """Return limits of the unknowns; a speed is within those of the gears before and after it."""
        of = self.phases.of_interval
        found: list[tuple[float, float | None]] = [(0.0, None)] * len(self.phases.gears)
        found += [(0.0, 1.0)] * (self.controls - len(self.phases.gears))
        for before, after in pairwise(of):
            pairs = [self.phases.limits_mps(phase) for phase in (before, after)]
            low, high = max(low for low, _ in pairs), min(high for _, high in pairs)
            found.append((max(low, 1e-3) / V_SCALE, high / V_SCALE if np.isfinite(high) else None))
        return found

    def constraints(self) -> list[dict[str, object]]:
        """Return what must hold: no defects, and the time where one is given."""
        found: list[dict[str, object]] = [
            {"type": "eq", "fun": lambda x: self.evaluated(x).defects, "jac": lambda x: self.evaluated(x).by_defects}
        ]
        time_s, phases = self.phases.problem.time_s, len(self.phases.gears)
        if time_s is not None:
            total = np.append(np.ones(phases), np.zeros(len(self.bounds()) - phases))
            found.append({"type": "eq", "fun": lambda x: x[:phases].sum() - time_s, "jac": lambda _x: total})
        return found


def direct_multiple_shooting(problem: Accelerate, drive: DriveNumbers, free_s: float, progress: Progress) -> Found:
    """Return the best drive of the programme from two first guesses.

    Raises
    ------
    MethodFailed
        When no guess leads to a drive without defects.
    """
    phases, best = phases_of(problem, drive, free_s), None
    programme = Programme(phases)
    for k, share in enumerate(STARTS):
        x = programme.first(share)
        for again in (False, True):
            part = between(progress, (k + 0.5 * again) / len(STARTS), (k + 0.5 * again + 0.5) / len(STARTS))
            result = minimised(
                lambda x: (programme.evaluated(x).cost, programme.evaluated(x).by_cost),
                programme.constraints(), np.clip(x, *_box(programme)), programme.bounds(), part,
            )  # fmt: skip
            kept = float(np.abs(programme.evaluated(result.x).defects).max()) <= KEPT
            if kept and (best is None or result.fun < best.fun):
                best = result
            x = revived(phases, result.x)
    if best is None:
        raise MethodFailed("the programme keeps its constraints from none of its first guesses; pontryagin needs none.")
    return rolled_out(phases, programme.unpacked(best.x), best)


def _box(programme: Programme) -> tuple[FloatArray, FloatArray]:
    low, high = zip(*programme.bounds(), strict=True)
    return np.array(low), np.array([np.inf if one is None else one for one in high])
