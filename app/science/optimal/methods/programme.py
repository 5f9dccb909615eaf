"""What direct methods have in common: phases of gears in rising order, controls held over intervals, and RK4 steps.

Durations of phases are unknowns, so a gear that isn't worth using gets none. Derivatives are complex steps through the
integration, exact to rounding.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from scipy.optimize import OptimizeResult, minimize

from app.science.arrays import AnyArray, FloatArray
from app.science.optimal.accelerate.kernels import CVT, GEARS, NEUTRAL, DriveNumbers
from app.science.optimal.methods.found import Arc, Found, MethodFailed, joined
from app.science.optimal.methods.model import resistance_n, wheels
from app.science.optimal.problem import Accelerate
from app.science.progress import Progress

PER_GEAR, ALONE = 4, 16
SUBSTEPS, CORNERED_SUBSTEPS, FINE = 2, 6, 8
SLOWEST_MPS = 1e-2
J_SCALE, V_SCALE = 1e5, 10.0
STARTS = (0.95, 0.7)
KEPT = 1e-7
UNUSED_S, REVIVED_S = 1e-6, 0.3
ITERATIONS = 150
PRECISE = 1e-10


class Controls(NamedTuple):
    """Unknowns of a drive: seconds of each phase, and shares of torque and of a CVT's engine speed by interval."""

    seconds: AnyArray
    share: AnyArray
    turn: AnyArray


@dataclass(frozen=True, slots=True)
class Phases:
    """Gears in driving order, from 0 or −1 for neutral, each with as many intervals."""

    problem: Accelerate
    drive: DriveNumbers
    gears: tuple[int, ...]
    intervals: int

    @property
    def start_mps(self) -> float:
        """Speed at the start; a car that stands still rolls a little, as its ratio has no number there."""
        return max(self.problem.from_speed_mps, SLOWEST_MPS)

    @property
    def substeps(self) -> int:
        """RK4 steps of an interval; more where full load has corners, which they round off."""
        return CORNERED_SUBSTEPS if len(self.drive.engine.full_load_radps) > 1 else SUBSTEPS

    @property
    def of_interval(self) -> list[int]:
        """The phase that each interval belongs to."""
        return [phase for phase in range(len(self.gears)) for _ in range(self.intervals)]

    @property
    def turns(self) -> bool:
        """Whether engine speed is a control."""
        return self.drive.kind == CVT

    def limits_mps(self, phase: int) -> tuple[float, float]:
        """Return the speeds between which a phase's gear can be engaged."""
        gear, engine = self.gears[phase], self.drive.engine
        if self.drive.kind != GEARS or gear == NEUTRAL:
            return 0.0, np.inf
        return engine.lowest_radps / self.drive.spd_1pm[gear], engine.highest_radps / self.drive.spd_1pm[gear]

    def step(self, gear: int, v: AnyArray, share: AnyArray, turn: AnyArray, seconds: AnyArray, count: int) -> Moved:
        """Return speed, distance and fuel after a control has been held, by ``count`` steps of RK4."""

        def rates(at: AnyArray) -> tuple[AnyArray, AnyArray]:
            now = wheels(self.drive, gear, at, share, turn)
            return (now.force_n - resistance_n(self.drive, at)) / self.drive.accelerated_kg, now.fuel_w

        h = seconds / count
        fuel = distance = 0.0 * v
        for _ in range(count):
            a1, p1 = rates(v)
            a2, p2 = rates(v + 0.5 * h * a1)
            a3, p3 = rates(v + 0.5 * h * a2)
            a4, p4 = rates(v + h * a3)
            distance = distance + h * (v + h * (a1 + a2 + a3) / 6.0)
            fuel = fuel + h * (p1 + 2.0 * p2 + 2.0 * p3 + p4) / 6.0
            v = v + h * (a1 + 2.0 * a2 + 2.0 * a3 + a4) / 6.0
        return Moved(v, distance, fuel)

    def guessed(self, share: float) -> Controls:
        """Return a first guess: one share of the torque everywhere, each rising phase as much of the speed."""
        rising = [k for k in range(len(self.gears)) if not self._coasts(k)]
        ends = np.linspace(self.start_mps, self.problem.to_speed_mps, len(rising) + 1)
        seconds = np.full(len(self.gears), 1.0)
        for k, a, b in zip(rising, ends[:-1], ends[1:], strict=True):
            v = np.array(np.clip(0.5 * (a + b), *self.limits_mps(k)))
            now = wheels(self.drive, self.gears[k], v, np.array(share), np.array(0.5))
            pull = float(now.force_n - resistance_n(self.drive, v)) / self.drive.accelerated_kg
            seconds[k] = (b - a) / max(pull, 0.05)
        if self.problem.time_s is not None and len(rising) < len(self.gears):
            seconds[0] = max(self.problem.time_s - seconds[1:].sum(), 1.0)
        elif self.problem.time_s is not None:
            seconds *= self.problem.time_s / seconds.sum()
        count = len(self.gears) * self.intervals
        shares = np.array([0.0 if self._coasts(k) else share for k in self.of_interval])
        return Controls(seconds, shares, np.full(count if self.turns else 0, 0.5))

    def _coasts(self, phase: int) -> bool:
        return phase + 1 < len(self.gears) and (
            self.gears[phase] == NEUTRAL or self.gears[phase] > self.gears[phase + 1]
        )


class Moved(NamedTuple):
    """Speed, distance since, and fuel since, after a control was held."""

    speed_mps: AnyArray
    distance_m: AnyArray
    fuel_j: AnyArray


def phases_of(problem: Accelerate, drive: DriveNumbers, free_s: float) -> Phases:
    """Return rising gears that reach into the speeds; before them, where there is time, one to slow down in."""
    if drive.kind != GEARS:
        return Phases(problem, drive, (0,), ALONE)
    low = drive.engine.lowest_radps / drive.spd_1pm
    high = drive.engine.highest_radps / drive.spd_1pm
    kept = np.flatnonzero((high > problem.from_speed_mps) & (low < problem.to_speed_mps))
    first = np.flatnonzero((low <= problem.from_speed_mps) & (high >= problem.from_speed_mps))
    if not len(first):
        raise MethodFailed(f"no gear can be engaged at {problem.from_speed_mps:.4g} m/s.")
    gears = tuple(int(gear) for gear in kept)
    if problem.time_s is not None and problem.time_s > free_s:
        gears = (NEUTRAL if drive.neutral else int(first[-1]), *gears)
    return Phases(problem, drive, gears, PER_GEAR)


def minimised(
    cost: Callable[[FloatArray], tuple[float, FloatArray]],
    constraints: list[dict[str, object]],
    x: FloatArray,
    bounds: list[tuple[float, float | None]],
    progress: Progress,
) -> OptimizeResult:
    """Return SLSQP's result; ``cost`` gives a value and its gradient."""
    steps: list[float] = []

    def tell(_x: FloatArray) -> None:
        steps.append(0.0)
        progress(min(len(steps) / 100.0, 0.99))

    return minimize(
        cost, x, jac=True, method="SLSQP", bounds=bounds, constraints=constraints, callback=tell,
        options={"maxiter": ITERATIONS, "ftol": PRECISE},
    )  # fmt: skip


def revived(phases: Phases, x: FloatArray) -> FloatArray:
    """Return unknowns in which phases without time get some, at much torque: at none, nothing draws them back."""
    again, count = x.copy(), len(phases.gears)
    for phase in np.flatnonzero(x[:count] < UNUSED_S):
        again[phase] = REVIVED_S
        again[count + phase * phases.intervals : count + (phase + 1) * phases.intervals] = STARTS[0]
    return again


def rolled_out(phases: Phases, controls: Controls, result: OptimizeResult, **more: object) -> Found:
    """Return controls as a drive, integrated with fine steps; by how much these miss the last speed is told."""
    drive, arcs = phases.drive, []
    told = {"intervals": len(phases.of_interval), "unknowns": len(result.x), "steps": int(result.nit)}
    v, t, x, fuel = np.array(phases.start_mps), 0.0, 0.0, 0.0
    for k, phase in enumerate(phases.of_interval):
        seconds = float(controls.seconds[phase]) / phases.intervals
        if seconds * phases.intervals < UNUSED_S:
            continue
        share = np.array(controls.share[k])
        turn = np.array(controls.turn[k] if phases.turns else 0.0)
        rows = [(t, x, float(v))]
        step = np.array(seconds / FINE)
        for _ in range(FINE):
            moved = phases.step(phases.gears[phase], v, share, turn, step, phases.substeps)
            v, fuel = moved.speed_mps, fuel + float(moved.fuel_j)
            t, x = t + seconds / FINE, x + float(moved.distance_m)
            rows.append((t, x, float(v)))
        times, ways, speeds = (np.array(column) for column in zip(*rows, strict=True))
        at = wheels(drive, phases.gears[phase], speeds, share, turn)
        arcs.append(Arc(phases.gears[phase], times, ways, speeds, at, np.zeros(len(times))))
    missed = float(v) - phases.problem.to_speed_mps
    return joined(drive, arcs, fuel, more={"programme": {**told, "missed_mps": missed}, **more})
