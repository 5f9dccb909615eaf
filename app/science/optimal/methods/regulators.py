"""Linear quadratic regulators that bring the car to its speed (Sebesta 2010, B.2.2).

They minimise squares of error and effort and know nothing of fuel. The one thing to turn is what effort weighs: it is
set so that the car arrives in the given time, or where time is free, on the least fuel. As a regulator only creeps up
to its target, it aims a little beyond.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from scipy.optimize import brentq, minimize_scalar

from app.science.optimal.accelerate.kernels import DriveNumbers
from app.science.optimal.lqr import continuous_gain, discrete_gain
from app.science.optimal.methods.found import Found, MethodFailed
from app.science.optimal.methods.held_kernels import NO_GEAR, nearest_force
from app.science.optimal.methods.held_steps import Followed, Step, exactly, follow, fuel_j, told
from app.science.optimal.methods.model import resistance_n
from app.science.optimal.problem import Accelerate
from app.science.progress import Progress

BEYOND = 0.05
STEP_S, HOLD_S = 0.05, 0.5
EFFORTS_N = (1.0, 1e6)
"""Force that weighs as much as an error of 1 m/s, from very gentle to full load."""
LOOKS = 13
LATE, LONGEST_S = 3.0, 120.0
SLOWEST_MPS = 1e-2


class Regulator(NamedTuple):
    """Force = held + gain · (aim − v), N; newly set every ``hold_s``."""

    gain: float
    held_n: float
    aim_mps: float
    hold_s: float


def lqr(problem: Accelerate, drive: DriveNumbers, progress: Progress) -> Found:
    """Return the drive of a regulator that acts all the time."""
    return _regulated(problem, drive, STEP_S, progress)


def dlqr(problem: Accelerate, drive: DriveNumbers, progress: Progress) -> Found:
    """Return the drive of a regulator that acts every half second."""
    return _regulated(problem, drive, HOLD_S, progress)


def _regulated(problem: Accelerate, drive: DriveNumbers, hold_s: float, progress: Progress) -> Found:
    time_s, start, end = problem.time_s, max(problem.from_speed_mps, SLOWEST_MPS), problem.to_speed_mps
    tried: list[float] = []

    def driven(log_effort: float) -> Followed:
        tried.append(log_effort)
        progress(min(len(tried) / 60.0, 0.99))
        return _follow(problem, drive, regulator(problem, drive, float(np.exp(log_effort)), hold_s))

    low, high = (float(np.log(one)) for one in EFFORTS_N)
    if time_s is None:
        looks = np.linspace(low, high, LOOKS)
        burned = [_burned(drive, start, end, driven(one)) for one in looks]
        if not np.isfinite(burned).any():
            raise MethodFailed("no regulator brings the car to its speed.")
        k = int(np.argmin(burned))
        around = looks[max(k - 1, 0)], looks[min(k + 1, LOOKS - 1)]
        best = minimize_scalar(
            lambda one: _burned(drive, start, end, driven(one)),
            bounds=around,
            method="bounded",
            options={"xatol": 1e-3},
        )
        log_effort = float(best.x) if best.fun < burned[k] else float(looks[k])
        steps = driven(log_effort).steps
    else:
        wanted = time_s

        def late(one: float) -> float:
            found = driven(one)
            return (found.time_s if found.speed_mps >= end else LATE * wanted) - wanted

        if late(high) > 0.0:
            raise MethodFailed(
                f"even the strongest regulator takes longer than {time_s:g} s; pontryagin allows for it."
            )
        log_effort = low if late(low) < 0.0 else float(brentq(late, low, high, xtol=1e-9, maxiter=80))
        steps = exactly(drive, start, end, time_s, driven(log_effort).steps)
    chosen = regulator(problem, drive, float(np.exp(log_effort)), hold_s)
    notes = (
        "A regulator minimises squares of error and effort, not fuel; what effort weighs was set so that it arrives "
        f"{'on the least fuel' if time_s is None else 'in time'}.",
    )
    more = {"gain_n_per_mps": chosen.gain, "aim_mps": chosen.aim_mps, "hold_s": hold_s}
    return told(drive, start, steps, notes, {"regulator": more})


def regulator(problem: Accelerate, drive: DriveNumbers, effort_n: float, hold_s: float) -> Regulator:
    """Return the regulator about the speed aimed at, for a force that weighs as much as an error of 1 m/s."""
    aim = problem.to_speed_mps + BEYOND * (problem.to_speed_mps - problem.from_speed_mps)
    a, b = -2.0 * drive.drag_kgpm * aim / drive.accelerated_kg, 1.0 / drive.accelerated_kg
    one, weight = np.eye(1), np.array([[effort_n**-2.0]])
    if hold_s <= STEP_S:
        gain = continuous_gain(a * one, b * one, one, weight)
    else:
        grown = float(np.exp(a * hold_s))
        gain = discrete_gain(grown * one, b * (grown - 1.0) / a * one if a else b * hold_s * one, one, weight)
    return Regulator(float(gain[0, 0]), float(resistance_n(drive, np.array(aim))), aim, hold_s)


def _follow(problem: Accelerate, drive: DriveNumbers, chosen: Regulator) -> Followed:
    sampled: list[tuple[int, float]] = []

    def law(t: float, v: float) -> Step | None:
        turn = int((t + 1e-9) / chosen.hold_s)
        if not sampled or sampled[-1][0] != turn:
            sampled.append((turn, v))
        return allocated(drive, v, chosen.held_n + chosen.gain * (chosen.aim_mps - sampled[-1][1]))

    longest = LONGEST_S if problem.time_s is None else LATE * problem.time_s
    return follow(drive, max(problem.from_speed_mps, SLOWEST_MPS), problem.to_speed_mps, longest, law)


def allocated(drive: DriveNumbers, v: float, force_n: float) -> Step | None:
    """Return the gear that gives a force, or comes nearest to it, on the least fuel."""
    gear, share, turn = nearest_force(v, force_n, drive)
    return None if gear == NO_GEAR else Step(gear, share, turn, STEP_S)


def _burned(drive: DriveNumbers, start: float, end: float, found: Followed) -> float:
    return fuel_j(drive, start, found.steps) if found.speed_mps >= end else float("inf")
