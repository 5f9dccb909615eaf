"""How one knows that a drive is the best: the maximum principle along it, and another method's lower bound."""

from __future__ import annotations

from itertools import pairwise

import numpy as np
from scipy.integrate import solve_ivp

from app.science.optimal.accelerate.brute_force import least_lagrangian
from app.science.optimal.accelerate.kernels import DriveNumbers
from app.science.optimal.accelerate.lingering import SLOWEST_MPS, cheapest_place
from app.science.optimal.accelerate.numbers import speed_range_mps
from app.science.optimal.accelerate.plan import Phase
from app.science.optimal.accelerate.solve import Solution
from app.science.optimal.accelerate.trace import BESIDE, Drive, cuts
from app.science.optimal.accelerate.trace_kernels import best_other, costate_slope, points
from app.science.optimal.answer import Certificate, Independent, Verdict
from app.science.optimal.problem import Accelerate

SMOOTH = 1e-6
CLOSED = 1e-5
SAME_COSTATE = 1e-7
NEAR_STANDSTILL = 1e-3
MOST_LOOKS = 120


def certify(problem: Accelerate, solution: Solution, drive: DriveNumbers, shown: Drive) -> Certificate:
    """Return what is known about a solution."""
    phases = (*solution.slowing.phases, *solution.before.phases, *solution.rising.phases)
    drift, notes = costate_drift(phases, drive, solution.mu_w)
    most, at = largest_h(problem, drive, shown, solution.mu_w)
    if at:
        notes += (at,)
    peak = float(np.nanmax(np.abs(shown.trajectory.fuel_power_w)))
    end_h = float(shown.costate[-1] * shown.accel_mps2[-1] - shown.trajectory.fuel_power_w[-1])
    charges = problem.transmission.shift_cost_j * max(len(shown.gears) - 1, 0)
    taken = solution.fuel_j + charges
    mu = bounding_price(problem, drive, solution.mu_w)
    bound = least_lagrangian(problem, drive, mu) - mu * solution.time_s
    gap = (taken - bound) / taken
    method = "dynamic programming over speed on a grid of controls, as a lower bound by weak duality"
    if gap > CLOSED and charges > 0.0 and solution.mu_w > 0.0:
        method += ", through the same gears"
        own = least_lagrangian(problem, drive, mu, solution.rising.sequence) - mu * solution.time_s
        gap = (taken - own) / taken
        notes += (
            f"The bound over all gears is {taken - bound:.4g} J lower: charges make the time jump with the sequence of "
            "gears. Every sequence that the bound leaves was solved with a price of its own.",
        )
    unsure = solution.mu_w < 0.0 and problem.transmission.shift_cost_j > 0.0
    verdict: Verdict = "optimal"
    if most > SMOOTH * peak:
        verdict = "rejected"
    elif solution.linger is not None and solution.linger.cycle:
        verdict = "best found"
    elif drift > SMOOTH * peak or abs(gap) > CLOSED:
        verdict = "best found" if unsure else "extremal"
    return Certificate(
        hamiltonian_drift_w=drift,
        transversality=abs(end_h - solution.mu_w),
        max_h_minus_mu_w=most,
        independent=Independent(method, gap),
        verdict=verdict,
        notes=notes,
        more={"lower_bound_j": bound, "shift_charges_j": charges},
    )


def bounding_price(problem: Accelerate, drive: DriveNumbers, mu: float) -> float:
    """Return the price of time nearest to the solution's at which staying pays nowhere, so that rising is best."""
    if mu >= 0.0:
        return mu
    lowest = min(max(speed_range_mps(drive)[0], SLOWEST_MPS), problem.from_speed_mps)
    everywhere = cheapest_place(drive, max(lowest, SLOWEST_MPS), problem.to_speed_mps, free_changes=True)
    return max(mu, -everywhere.fuel_w)


def costate_drift(phases: tuple[Phase, ...], drive: DriveNumbers, mu: float) -> tuple[float, tuple[str, ...]]:
    """Return the largest |H − μ| with the costate integrated by its own equation, and where it jumps.

    Where two gears cost the same the costate is continuous; where a gear ends at the engine's limit it jumps, as the
    maximum principle with limits on the state allows (Sebesta 2010, 4.4.2), and H does not.
    """
    worst, notes = 0.0, []
    costate: float | None = None
    for phase in phases:
        first = points(phase.gear, np.array([phase.from_mps]), phase.price, drive)[0]
        turns = abs(first[6]) < NEAR_STANDSTILL
        if costate is not None and not turns and abs(costate - first[7]) > SAME_COSTATE * abs(first[7]):
            notes.append(
                f"The costate jumps by {first[7] - costate:.4g} J s/m at {phase.from_mps:.4g} m/s, where a limit on "
                "speed forces the change."
            )
            costate = None
        if costate is None or turns:
            costate = float(first[7])
        for a, b in pairwise(cuts(phase, drive)):
            costate, off = _arc(phase, a, b, costate, drive, mu)
            worst = max(worst, off)
    return worst, tuple(notes)


def _arc(phase: Phase, a: float, b: float, costate: float, drive: DriveNumbers, mu: float) -> tuple[float, float]:
    """Integrate the costate over one smooth arc; beside a place where the car hardly changes speed it starts anew."""
    slowest = np.abs(points(phase.gear, np.array([a, b]), phase.price, drive)[:, 6]) < NEAR_STANDSTILL
    slowest |= np.array([a, b]) == 0.0
    beside = np.sign(b - a) * min(BESIDE * max(abs(a), abs(b)), 1e-3 * abs(b - a))  # a control may jump at either end
    inset = np.where(slowest, 1e-2 * (b - a), beside)
    begin, end = a + inset[0], b - inset[1]

    def grows(v: float, value: float) -> float:
        return float(costate_slope(phase.gear, v, value, phase.price, drive)[0])

    if slowest[0]:
        costate = float(points(phase.gear, np.array([begin]), phase.price, drive)[0, 7])
    else:
        costate += grows(begin, costate) * (begin - a)
    path = solve_ivp(
        lambda v, y: [grows(v, y[0])], (begin, end), [costate], method="DOP853", rtol=1e-11, atol=1e-9 * abs(costate)
    )
    off = [
        abs(costate_slope(phase.gear, float(v), float(y), phase.price, drive)[1] - mu)
        for v, y in zip(path.t, path.y[0], strict=True)
    ]
    if slowest[1]:
        return float(points(phase.gear, np.array([b]), phase.price, drive)[0, 7]), max(off)
    last = float(path.y[0, -1])
    return last + grows(float(end), last) * (b - float(end)), max(off)


def largest_h(problem: Accelerate, drive: DriveNumbers, shown: Drive, mu: float) -> tuple[float, str]:
    """Return the largest H − μ of any admissible control along the drive, and the better one in words."""
    every = problem.transmission.shift_cost_j == 0.0
    most, words = -np.inf, ""
    step = np.diff(shown.trajectory.t_s)
    inside = (np.append(1.0, step) > 0.0) & (np.append(step, 1.0) > 0.0)  # at a change both gears are admissible
    within = np.flatnonzero(inside & (shown.trajectory.speed_mps > SLOWEST_MPS))
    for k in within[:: max(len(within) // MOST_LOOKS, 1)].tolist():
        v, gear = float(shown.trajectory.speed_mps[k]), int(shown.trajectory.gear[k]) - 1
        h, other = best_other(
            max(gear, -1) if every or shown.gears else 0, v, float(shown.costate[k]), mu, every, drive
        )
        if h > most:
            most = h
            words = f"At {v:.2f} m/s gear {other + 1} has an H that is {h:.3g} W higher." if h > SMOOTH * 1e5 else ""
    return float(most), words
