"""The Hamilton–Jacobi–Bellman equation by the explicit upwind scheme (Sebesta 2010, B.25-B.27).

S is the least cost to go. In time to go, S grows by min over u of L + D S v̇, with D S to the right where the control
speeds the car up and to the left where it slows it down; the step of time keeps k max |v̇| ≤ h, without which the
scheme is unstable (the thesis names no condition). The target is a penalty |v − v*| steep enough to be exact. The drive
follows the costate −∂S/∂v. In a given time that one is blurred towards the end, where arriving late costs the penalty;
the drive then stays in a gear until another is clearly better.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.optimize import brentq

from app.science.arrays import FloatArray
from app.science.optimal.accelerate.kernels import CVT, GEARS, WILLANS, DriveNumbers
from app.science.optimal.methods.field_kernels import NO_GEAR, best_gear, engaged, lead, rates_in
from app.science.optimal.methods.found import Found, MethodFailed
from app.science.optimal.methods.held_steps import Followed, Step, exactly, follow, told
from app.science.optimal.methods.inverse import at_wheels_w
from app.science.optimal.methods.model import highest_torque_nm, resistance_n, usable, wheels
from app.science.optimal.problem import Accelerate
from app.science.progress import Progress

NODES = 320
SHARES = {GEARS: 25, CVT: 9, WILLANS: 33}
TURNS = 25
COURANT = 0.95
STEEP = 3.0
SETTLED = 1e-9
MOST_STEPS = 30_000
KEPT_STEPS = 600
STEP_S = 0.02
CLEARLY = 0.01
DEEPEST = 0.5
LATE = 3.0
SLOWEST_MPS = 1e-2


@dataclass(frozen=True, slots=True)
class Value:
    """Least cost to go, J, shape (times, nodes); one time only where time is free."""

    speed_mps: FloatArray
    togo_s: FloatArray
    cost_j: FloatArray

    def costate(self, togo_s: float, v: float) -> float:
        """Return −∂S/∂v, linear between the middles of the cells and between times."""
        middle = 0.5 * (self.speed_mps[1:] + self.speed_mps[:-1])
        k = int(np.clip(np.searchsorted(self.togo_s, togo_s), 1, len(self.togo_s) - 1)) if len(self.togo_s) > 1 else 0
        now = -np.interp(v, middle, np.diff(self.cost_j[k]) / np.diff(self.speed_mps))
        if k == 0:
            return float(now)
        before = -np.interp(v, middle, np.diff(self.cost_j[k - 1]) / np.diff(self.speed_mps))
        share = (togo_s - self.togo_s[k - 1]) / (self.togo_s[k] - self.togo_s[k - 1])
        return float(before + np.clip(share, 0.0, 1.0) * (now - before))


def hjb_upwind(problem: Accelerate, drive: DriveNumbers, free_s: float, progress: Progress) -> Found:
    """Return the drive that follows the costate of the scheme.

    Raises
    ------
    MethodFailed
        When the scheme does not settle, or its drive does not arrive.
    """
    value = marched(problem, drive, free_s, progress)
    start = max(problem.from_speed_mps, SLOWEST_MPS)
    if problem.time_s is None:
        found = _driven(problem, drive, value, 0.0)
        if found.speed_mps < problem.to_speed_mps:
            raise MethodFailed(f"the drive of the scheme ends at {found.speed_mps:.4g} m/s; take pontryagin.")
        steps = found.steps
    else:
        steps = exactly(drive, start, problem.to_speed_mps, problem.time_s, _nearly(problem, drive, value).steps)
    grid = {"nodes": len(value.speed_mps), "times": len(value.togo_s)}
    return told(drive, start, steps, (), {"grid": grid})


def marched(problem: Accelerate, drive: DriveNumbers, free_s: float, progress: Progress) -> Value:
    """March S in time to go: over the given time, or until it rests."""
    start, end, time_s = max(problem.from_speed_mps, SLOWEST_MPS), problem.to_speed_mps, problem.time_s
    slowest = drive.engine.lowest_radps / drive.spd_1pm.max() if drive.kind == GEARS else DEEPEST * start
    low = max(slowest, DEEPEST * start) if time_s is not None and time_s > free_s else start
    v = np.linspace(low, end, NODES + 1)
    width = float(v[1] - v[0])
    accel, running = _controls(drive, v)
    quickest = float(np.abs(accel[np.isfinite(running)]).max())
    count = int(np.ceil((time_s or free_s) * quickest / (COURANT * width)))
    step = (time_s or free_s) / count
    ratio = np.where(accel > 0.0, running / np.where(accel > 0.0, accel, 1.0), np.inf)
    target = STEEP * float(ratio.min(axis=1)[1:].max()) * np.abs(v - end)
    cost, kept, times = target.copy(), [target.copy()], [0.0]
    every = max(count // KEPT_STEPS, 1)
    up = np.maximum(accel, 0.0)
    down = np.minimum(accel, 0.0)
    for k in range(1, (count if time_s is not None else MOST_STEPS) + 1):
        right = np.append(np.diff(cost), 0.0) / width  # beyond the last speed S is as at it
        left = np.append(np.inf, np.diff(cost) / width)
        left[0] = 0.0
        grown = cost + step * (running + up * right[:, None] + down * left[:, None]).min(axis=1)
        if time_s is None:
            grown = np.minimum(grown, target)
            rest = float(np.abs(grown - cost).max()) <= SETTLED * float(cost.max())
            cost = grown
            if rest:
                return Value(v, np.zeros(1), cost[None, :])
        else:
            cost = grown
            if k % every == 0 or k == count:
                kept.append(cost.copy())
                times.append(k * step)
        if k % 50 == 0:
            progress(min(k / count, 0.9))
    if time_s is None:
        raise MethodFailed("the scheme does not come to rest; pontryagin needs none.")
    return Value(v, np.array(times), np.array(kept))


def _controls(drive: DriveNumbers, v: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Return v̇ and running cost of a grid of controls at each speed, shape (nodes, controls); infinite where none."""
    share, turn = np.linspace(0.0, 1.0, SHARES[drive.kind]), np.zeros(SHARES[drive.kind])
    if drive.kind == CVT:
        share, turn = (g.ravel() for g in np.meshgrid(share, np.linspace(0.0, 1.0, TURNS)))
    accel, running = [], []
    gears = [*range(len(drive.spd_1pm)), *([-1] if drive.neutral else [])]
    for gear in gears:
        at = wheels(drive, gear, v[:, None] + 0.0 * share, share, turn)
        can = usable(drive, gear, v)[:, None] & np.ones(len(share), dtype=bool)
        accel.append(np.where(can, (at.force_n - resistance_n(drive, v[:, None])) / drive.accelerated_kg, 0.0))
        running.append(np.where(can, at.fuel_w, np.inf))
    return np.hstack(accel), np.hstack(running)


def _driven(problem: Accelerate, drive: DriveNumbers, value: Value, more_s: float) -> Followed:
    """Follow the costate; ``more_s`` is added to the time that is left."""
    wanted = problem.time_s or 0.0
    longest = LATE * problem.time_s if problem.time_s is not None else 1e3

    last: list[int] = []

    def law(t: float, v: float) -> Step | None:
        costate = value.costate(wanted + more_s - t, v)
        gear = best_gear(v, costate, drive)
        if wanted and last and gear not in (NO_GEAR, last[-1]) and engaged(last[-1], v, drive):
            kept = rates_in(last[-1], v, costate, drive)
            gear = last[-1] if lead(last[-1], v, costate, drive) < CLEARLY * kept.fuel_w else gear
        last.append(gear)
        return None if gear == NO_GEAR else _held(drive, gear, v, costate)

    return follow(drive, max(problem.from_speed_mps, SLOWEST_MPS), problem.to_speed_mps, longest, law)


def _held(drive: DriveNumbers, gear: int, v: float, costate: float) -> Step:
    now = rates_in(gear, v, costate, drive)
    if drive.kind == WILLANS:
        low, high = at_wheels_w(drive, np.array(v))
        return Step(gear, float((now.force_n * v - low) / (high - low)), 0.0, STEP_S)
    if gear < 0:
        return Step(gear, 0.0, 0.0, STEP_S)
    engine = drive.engine
    room = float(highest_torque_nm(drive, np.array(now.engine_radps))) - engine.lowest_nm
    turn = (now.engine_radps - engine.lowest_radps) / (engine.highest_radps - engine.lowest_radps)
    return Step(gear, (now.torque_nm - engine.lowest_nm) / room, turn, STEP_S)


def _nearly(problem: Accelerate, drive: DriveNumbers, value: Value) -> Followed:
    """Return the drive that arrives nearly on time; the time it takes to be left makes up for the scheme's blur."""
    assert problem.time_s is not None  # noqa: S101 - free time has no such drive
    wanted = problem.time_s

    def late(more_s: float) -> float:
        found = _driven(problem, drive, value, more_s)
        return (found.time_s if found.speed_mps >= problem.to_speed_mps else LATE * wanted) - wanted

    low, high = -0.3 * wanted, 0.3 * wanted
    if late(low) > 0.0 or late(high) < 0.0:
        raise MethodFailed(f"the drive of the scheme does not arrive in {wanted:g} s; take pontryagin.")
    more_s = float(brentq(late, low, high, xtol=1e-6, maxiter=60))
    found = _driven(problem, drive, value, more_s)
    if found.speed_mps < problem.to_speed_mps:
        found = _driven(problem, drive, value, more_s - 1e-5)
    return found
