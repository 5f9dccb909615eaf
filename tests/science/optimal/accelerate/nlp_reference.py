"""The same accelerations by another way: collocation in time handed to a general solver (CasADi with IPOPT).

Each gear is a phase of unknown length, divided into elements with Radau points; speed and torque at the points are the
unknowns. It knows nothing of Pontryagin, of costates, or of integrals over speed.
"""

from __future__ import annotations

from dataclasses import dataclass
from itertools import combinations
from typing import Any

import numpy as np

from app.science.optimal.problem import RADPS_PER_RPM, Accelerate, PolynomialEngine

ELEMENTS = 5
DEGREE = 5
UNUSED_MPS = 1e-3


@dataclass(frozen=True)
class Found:
    """What the other way found: fuel, J, speeds at which gears change, and the torque at all points."""

    fuel_j: float
    switch_speeds_mps: tuple[float, ...]
    sequence: tuple[int, ...]


def radau(casadi: Any) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Return points, differentiation matrix and weights on [0, 1]; the first point is the start, without weight."""
    points = np.append(0.0, casadi.collocation_points(DEGREE, "radau"))
    slopes, weights = np.zeros((DEGREE + 1, DEGREE + 1)), np.zeros(DEGREE + 1)
    for j in range(DEGREE + 1):
        basis = np.poly1d([1.0])
        for r in range(DEGREE + 1):
            if r != j:
                basis *= np.poly1d([1.0, -points[r]]) / (points[j] - points[r])
        slopes[:, j] = np.polyder(basis)(points)
        whole = np.polyint(basis)
        weights[j] = whole(1.0) - whole(0.0)
    return points, slopes, weights


def best_in(casadi: Any, problem: Accelerate, sequence: tuple[int, ...]) -> Found | None:
    """Return the least fuel through given gears (from 0) from two starts; None where the solver finds no way."""
    starts = (_from_start(casadi, problem, sequence, share) for share in (0.8, 0.95))
    found = [one for one in starts if one is not None]
    return min(found, key=lambda one: one.fuel_j) if found else None


def _from_start(casadi: Any, problem: Accelerate, sequence: tuple[int, ...], share: float) -> Found | None:
    """Start at a share of the largest torque; gears that are used for no time are left out of the answer."""
    engine, load = problem.engine, problem.load
    assert isinstance(engine, PolynomialEngine)
    _, slopes, weights = radau(casadi)
    opti = casadi.Opti()
    fuel, total, switches = 0.0, 0.0, []
    grow = (problem.to_speed_mps - problem.from_speed_mps) / len(sequence)
    last: Any = problem.from_speed_mps
    for k, gear in enumerate(sequence):
        n = problem.transmission.ratios[gear] / load.wheel_radius_m
        length = opti.variable()
        opti.subject_to(length >= 0.0)
        opti.set_initial(length, (problem.time_s or 12.0) / len(sequence))
        total += length
        for element in range(ELEMENTS):
            v = opti.variable(DEGREE)
            torque = opti.variable(DEGREE)
            opti.set_initial(v, problem.from_speed_mps + grow * (k + (element + 0.5) / ELEMENTS))
            opti.set_initial(torque, share * engine.torque_nm[1])
            states = casadi.vertcat(last, v)
            omega = n * v
            opti.subject_to(
                opti.bounded(engine.speed_rpm[0] * RADPS_PER_RPM, omega, engine.speed_rpm[1] * RADPS_PER_RPM)
            )
            opti.subject_to(opti.bounded(engine.torque_nm[0], torque, engine.torque_nm[1]))
            for (rpm_a, nm_a), (rpm_b, nm_b) in zip(engine.full_load, engine.full_load[1:], strict=False):
                steep = (nm_b - nm_a) / (rpm_b - rpm_a)  # a concave line is the least of its pieces
                opti.subject_to(torque <= nm_a + steep * (omega / RADPS_PER_RPM - rpm_a))
            pull = (n * torque - load.drag_kgpm * v**2 - load.rolling_n) / load.accelerated_mass_kg
            opti.subject_to(casadi.mtimes(slopes[1:], states) == length / ELEMENTS * pull)
            power = sum(c * omega**i * torque**j for (i, j), c in zip(engine.terms, engine.coefficients, strict=True))
            fuel += length / ELEMENTS * casadi.dot(weights[1:], power)
            last = v[DEGREE - 1]
        switches.append(last)
    opti.subject_to(last == problem.to_speed_mps)
    if problem.time_s is not None:
        opti.subject_to(total == problem.time_s)
    opti.minimize(fuel / 1e5)
    quiet = {"print_level": 0, "tol": 1e-10, "max_iter": 800, "sb": "yes", "mu_strategy": "adaptive"}
    opti.solver("ipopt", {"print_time": False}, quiet)
    try:
        done = opti.solve()
    except RuntimeError:  # the solver's word for "no way through these gears"
        return None
    ends = [problem.from_speed_mps, *(float(done.value(v)) for v in switches)]
    used = [k for k in range(len(sequence)) if ends[k + 1] - ends[k] > UNUSED_MPS]
    speeds = tuple(ends[k] for k in used[1:])
    return Found(float(done.value(fuel)), speeds, tuple(sequence[k] for k in used))


def best_of_all(casadi: Any, problem: Accelerate, around: tuple[int, ...]) -> Found:
    """Return the least fuel and charges over sequences of rising gears near a given one, and all runs of gears."""
    gears = len(problem.transmission.ratios)
    tried = {tuple(range(a, b)) for a in range(gears) for b in range(a + 1, gears + 1)}
    tried |= {one for size in range(1, len(around) + 1) for one in combinations(around, size)}
    tried |= {tuple(sorted({*around, gear})) for gear in range(gears)}
    charge = problem.transmission.shift_cost_j
    found = [one for one in (best_in(casadi, problem, sequence) for sequence in tried) if one is not None]
    return min(found, key=lambda one: one.fuel_j + charge * (len(one.sequence) - 1))
