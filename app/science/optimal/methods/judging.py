"""What is known about a drive, whatever found it: the maximum principle along it, and Pontryagin's own answer."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from app.science.arrays import FloatArray
from app.science.optimal.accelerate.kernels import DriveNumbers
from app.science.optimal.accelerate.lingering import SLOWEST_MPS
from app.science.optimal.accelerate.solve import Solution
from app.science.optimal.accelerate.trace_kernels import best_other
from app.science.optimal.answer import Certificate, Independent, Verdict
from app.science.optimal.controllability import bracket_rank
from app.science.optimal.methods.adjoint import Adjoint, fitted
from app.science.optimal.methods.found import Found, acceleration_mps2
from app.science.optimal.problem import Accelerate, RoadLoad

SMOOTH = 1e-6
CLOSED = 1e-5
BEATEN, COARSE = 1e-2, 1e-4
MOST_LOOKS = 120
SPEEDS = 9


@dataclass(frozen=True, slots=True)
class Judged:
    """What is known about a drive, and the costate it was judged by."""

    certificate: Certificate
    adjoint: Adjoint


def judge(problem: Accelerate, drive: DriveNumbers, found: Found, best: Solution | None) -> Judged:
    """Judge a drive.

    Parameters
    ----------
    problem, drive
    found : Found
    best : Solution or None
        Pontryagin's own; None where it has none.
    """
    free = 0.0 if problem.time_s is None else None
    if found.costate is None:
        adjoint = fitted(drive, found, free)
    else:
        adjoint = Adjoint(found.costate, found.mu_w if found.mu_w is not None else 0.0)
    accel, power = acceleration_mps2(drive, found), found.trajectory.fuel_power_w
    h = adjoint.costate * accel - power
    drift = float(np.abs(h - adjoint.mu_w).max())
    most = _largest_h(problem, drive, found, adjoint)
    charges = problem.transmission.shift_cost_j * max(len(found.gears) - 1, 0)
    independent, gap = None, np.inf
    notes = found.notes
    if best is not None:
        theirs = best.fuel_j + problem.transmission.shift_cost_j * _changes(best)
        gap = (found.fuel_j + charges - theirs) / (found.fuel_j + charges)
        independent = Independent("Pontryagin: integrals over speed with a root in the price of time", float(gap))
    peak = float(np.nanmax(np.abs(power)))
    verdict: Verdict = "best found"
    if max(drift, most) <= SMOOTH * peak and abs(gap) <= CLOSED:
        verdict = "extremal"
    elif gap > BEATEN:
        verdict = "rejected"
        notes += (f"Rejected: Pontryagin's drive takes {100.0 * gap:.2g} % less for the same task.",)
    elif gap < -COARSE and best is not None and best.mu_w >= 0.0:
        verdict = "rejected"
        notes += ("Rejected: it claims less than the least, so its steps are too coarse for this problem.",)
    if found.costate is None:
        notes += (
            "The method knows no costate: the adjoint equation was integrated along its drive and scaled to fit.",
        )
    certificate = Certificate(
        hamiltonian_drift_w=drift,
        transversality=float(abs(h[-1] - adjoint.mu_w)),
        max_h_minus_mu_w=most,
        independent=independent,
        verdict=verdict,
        notes=notes,
        more={"shift_charges_j": charges, "controllable": controllable(problem.load, found.trajectory.speed_mps)},
    )
    return Judged(certificate, adjoint)


def _changes(best: Solution) -> int:
    gears = [phase.gear for phase in (*best.slowing.phases, *best.before.phases, *best.rising.phases)]
    return int(np.count_nonzero(np.diff(gears)))


def _largest_h(problem: Accelerate, drive: DriveNumbers, found: Found, adjoint: Adjoint) -> float:
    """Return the largest H − μ of any admissible control along the drive."""
    every = problem.transmission.shift_cost_j == 0.0
    now = found.trajectory
    step = np.diff(now.t_s)
    inside = (np.append(1.0, step) > 0.0) & (np.append(step, 1.0) > 0.0)  # at a change both gears are admissible
    rows = np.flatnonzero(inside & (now.speed_mps > SLOWEST_MPS))
    most = -np.inf
    for k in rows[:: max(len(rows) // MOST_LOOKS, 1)].tolist():
        gear = int(now.gear[k]) - 1 if len(problem.transmission.ratios) else 0
        v, costate = float(now.speed_mps[k]), float(adjoint.costate[k])
        most = max(most, best_other(gear, v, costate, adjoint.mu_w, every, drive)[0])
    return float(most)


def controllable(load: RoadLoad, speed_mps: FloatArray) -> bool:
    """Tell whether a force at the wheels moves distance and speed independently all along a drive (B.1.2)."""
    mass = load.accelerated_mass_kg
    ranks = [
        bracket_rank(
            lambda x: np.array([x[1], -(load.drag_kgpm * x[1] ** 2 + load.rolling_n) / mass]),
            lambda x: np.array([0.0 * x[0], 1.0 / mass + 0.0 * x[0]]),
            (0.0, float(v)),
        )
        for v in np.quantile(speed_mps, np.linspace(0.0, 1.0, SPEEDS))
    ]
    return min(ranks) == 2
