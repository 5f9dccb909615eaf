"""A ball brought to rest on top of a wheel in the least time, exactly (Sebesta 2010, App. G).

In normal form x₁' = x₂, x₂' = γ u: the control is at one of its limits, and changes once, where the state meets the
half parabola on which the other limit leads to rest. λ₂(T) is 1/(γ u), not 1/u as (G.18) has it.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from math import sqrt
from typing import Any, Literal

import numpy as np
from scipy.optimize import brentq

from app.science.arrays import FloatArray
from app.science.optimal.answer import Certificate, Independent
from app.science.optimal.controllability import bracket_rank
from app.science.optimal.problem import BallAndWheel, Infeasible

First = Literal["u_min", "u_max", "none"]
ON_LOCUS = 1e-12
POINTS = 101
ISOCHRONES = (0.25, 0.5, 0.75, 1.0)


@dataclass(frozen=True, slots=True)
class BallAnswer:
    """The fastest way to rest.

    Attributes
    ----------
    time_s, switch_time_s : float
        The control changes at the second; on the switching locus it never does, and both are the same.
    first : {"u_min", "u_max", "none"}
        The limit applied first; "none" at rest on top.
    columns : mapping
        ``t_s x1 x2 u`` and the costates ``lambda_1 lambda_2``, each array of shape (n,); the time of the change comes
        twice.
    synthesis : mapping
        What is best from anywhere, to be drawn: the switching locus, and lines of states as far from rest in time.
    certificate : Certificate
        H has no unit here: its running cost is 1.
    advice : tuple of str
    """

    time_s: float
    switch_time_s: float
    first: First
    columns: Mapping[str, FloatArray]
    synthesis: Mapping[str, Any]
    certificate: Certificate
    advice: tuple[str, ...]

    def document(self) -> dict[str, Any]:
        """Return the answer with the names others rely on."""
        columns = {name: values.tolist() for name, values in self.columns.items()}
        return {
            "kind": "ball_and_wheel",
            "time_s": self.time_s,
            "switch_time_s": self.switch_time_s,
            "first": self.first,
            "trajectory": {name: columns[name] for name in ("t_s", "x1", "x2", "u")},
            "costates": {name: columns[name] for name in ("lambda_1", "lambda_2")},
            "synthesis": dict(self.synthesis),
            "advice": list(self.advice),
            "warnings": [],
            "certificate": self.certificate.document(),
        }


@dataclass(frozen=True, slots=True)
class Switching:
    """What is done when: the first control, until when, and how long it takes in all, s."""

    first: First
    switch_time_s: float
    time_s: float


def solve_ball_and_wheel(problem: BallAndWheel) -> BallAnswer:
    """Solve the problem.

    Raises
    ------
    Infeasible
        When the control can't push both ways.
    """
    if not problem.u_min < 0.0:
        raise Infeasible(f"{problem.u_min:g} is not below 0, so nothing can slow the ball down one way.", "u_min")
    if not problem.u_max > 0.0:
        raise Infeasible(f"{problem.u_max:g} is not above 0, so nothing can push the ball one way.", "u_max")
    found = switching(problem)
    columns = _columns(problem, found)
    return BallAnswer(
        found.time_s, found.switch_time_s, found.first, columns, _synthesis(problem, found.time_s),
        _certificate(problem, found, columns), _advice(problem, found),
    )  # fmt: skip


def switching(problem: BallAndWheel) -> Switching:
    """Return the first control and when it changes (Sebesta 2010, G.19-G.21)."""
    if problem.x1 == 0.0 and problem.x2 == 0.0:
        return Switching("none", 0.0, 0.0)
    side = locus_side(problem)
    if side < 0.0:
        mirrored = switching(BallAndWheel(-problem.x1, -problem.x2, -problem.u_max, -problem.u_min, problem.gamma))
        return Switching("u_max" if mirrored.first == "u_min" else "u_min", mirrored.switch_time_s, mirrored.time_s)
    up, down = problem.gamma * problem.u_max, -problem.gamma * problem.u_min
    if side == 0.0:
        time_s = problem.x2 / down if problem.x2 > 0.0 else -problem.x2 / up
        return Switching("u_min" if problem.x2 > 0.0 else "u_max", time_s, time_s)
    if problem.x2 < 0.0:
        # the same root as below, without taking the difference of two nearly equal speeds
        turn = -sqrt(problem.x2**2 + 2.0 * side * up * down / (up + down))
        before = -2.0 * side * up / (up + down) / (problem.x2 + turn)
    else:
        turn = -sqrt(2.0 * (problem.x1 + problem.x2**2 / (2.0 * down)) * up * down / (up + down))
        before = (problem.x2 - turn) / down
    return Switching("u_min", before, before - turn / up)


def locus_side(problem: BallAndWheel) -> float:
    """Return how far x₁ lies beyond the switching locus; 0 on it to rounding."""
    half = problem.u_max if problem.x2 <= 0.0 else problem.u_min
    at = problem.x2**2 / (2.0 * problem.gamma * half)
    side = problem.x1 - at
    return 0.0 if abs(side) <= ON_LOCUS * (abs(problem.x1) + abs(at)) else side


def _controls(problem: BallAndWheel, first: First) -> tuple[float, float]:
    return (problem.u_min, problem.u_max) if first == "u_min" else (problem.u_max, problem.u_min)


def _columns(problem: BallAndWheel, found: Switching) -> dict[str, FloatArray]:
    before, after = (
        np.linspace(0.0, found.switch_time_s, POINTS),
        np.linspace(found.switch_time_s, found.time_s, POINTS),
    )
    if found.first == "none":
        before, after = np.zeros(1), np.zeros(0)
    elif found.switch_time_s == found.time_s:
        after = np.zeros(0)
    u1, u2 = (0.0, 0.0) if found.first == "none" else _controls(problem, found.first)
    t, u = np.concatenate((before, after)), np.concatenate((np.full(before.size, u1), np.full(after.size, u2)))
    later = np.maximum(t - found.switch_time_s, 0.0)
    early = np.minimum(t, found.switch_time_s)
    speed_then = problem.x2 + problem.gamma * u1 * early
    x1 = problem.x1 + problem.x2 * early + 0.5 * problem.gamma * u1 * early**2
    x1 += speed_then * later + 0.5 * problem.gamma * u2 * later**2
    x2 = speed_then + problem.gamma * u2 * later
    slope, at_end = _costates(problem, found)
    return {
        "t_s": t, "x1": x1, "x2": x2, "u": u,
        "lambda_1": np.full(t.size, -slope), "lambda_2": at_end + slope * (t - found.time_s),
    }  # fmt: skip


def _costates(problem: BallAndWheel, found: Switching) -> tuple[float, float]:
    """Return the slope of λ₂ over time and its value at the end; its zero is where the control changes."""
    if found.first == "none":
        return 0.0, 0.0
    u1, u2 = _controls(problem, found.first)
    if found.switch_time_s == found.time_s:
        return 0.0, 1.0 / (problem.gamma * u1)
    at_end = 1.0 / (problem.gamma * u2)
    return at_end / (found.time_s - found.switch_time_s), at_end


def reachable_time_s(problem: BallAndWheel) -> float:
    """Return the least time in which rest can be reached at all, by what controls of both orders can do in a time, s.

    In a time T the mean control follows from x₂; of all controls with that mean, full push early carries x₁ farthest
    and full push late least far. Rest is reached as soon as x₁ lies between the two: no switching locus is used.
    """

    def short_of(time_s: float) -> float:
        mean = -problem.x2 / (problem.gamma * time_s)
        share = (mean - problem.u_min) / (problem.u_max - problem.u_min)
        if not 0.0 <= share <= 1.0:
            return -min(share, 1.0 - share)
        need = -(problem.x1 + problem.x2 * time_s) / (0.5 * problem.gamma * time_s**2)
        spread = problem.u_max - problem.u_min
        most = problem.u_min + spread * (1.0 - (1.0 - share) ** 2)
        least = problem.u_min + spread * share**2
        return max(need - most, least - need) / spread

    if problem.x1 == 0.0 and problem.x2 == 0.0:
        return 0.0
    long = sqrt(abs(problem.x1) / problem.gamma) + abs(problem.x2) / problem.gamma
    while short_of(long) > 0.0:
        long *= 2.0
    short = long
    while short_of(short) <= 0.0:
        short *= 0.5
    return float(brentq(short_of, short, long, xtol=1e-300, rtol=1e-15))


def _certificate(problem: BallAndWheel, found: Switching, columns: Mapping[str, FloatArray]) -> Certificate:
    x2, lambda_1, lambda_2, u = (columns[name] for name in ("x2", "lambda_1", "lambda_2", "u"))
    kept = lambda_1 * x2 + lambda_2 * problem.gamma * u - 1.0 if found.first != "none" else np.zeros(1)
    best = np.maximum(lambda_2 * problem.gamma * problem.u_min, lambda_2 * problem.gamma * problem.u_max)
    other = reachable_time_s(problem)
    gap = (found.time_s - other) / found.time_s if found.time_s > 0.0 else 0.0
    missed = float(np.hypot(columns["x1"][-1], x2[-1]))
    rank = bracket_rank(
        lambda x: np.array([x[1], 0.0 * x[0]]),
        lambda x: np.array([0.0 * x[0], problem.gamma]),
        (problem.x1, problem.x2),
    )
    return Certificate(
        hamiltonian_drift_w=float(np.ptp(kept)),
        transversality=float(abs(kept[-1])),
        max_h_minus_mu_w=float((best - lambda_2 * problem.gamma * u).max()),
        independent=Independent("least time after which the reachable states hold the origin", gap),
        verdict="optimal" if abs(gap) < 1e-7 else "best found",
        notes=("H has no unit here: it counts seconds.",),
        more={"controllable": rank == 2, "end_missed_by": missed},
    )


def _synthesis(problem: BallAndWheel, time_s: float) -> dict[str, Any]:
    """Return the locus and lines of equal time, as far as the start needs them; from rest for one second."""
    longest = time_s or 1.0
    s = np.linspace(0.0, longest, POINTS)
    halves = [_back(problem, u, u, s, 0.0 * s) for u in (problem.u_min, problem.u_max)]
    x1, x2 = (np.concatenate((halves[0][k][::-1], halves[1][k][1:])) for k in (0, 1))
    lines = []
    for share in ISOCHRONES:
        t = share * longest
        last = np.linspace(0.0, t, POINTS)
        one = _back(problem, problem.u_max, problem.u_min, last, t - last)
        two = _back(problem, problem.u_min, problem.u_max, last, t - last)
        lines.append({"time_s": t, **{f"x{k + 1}": np.concatenate((one[k], two[k])).tolist() for k in (0, 1)}})
    return {"locus": {"x1": x1.tolist(), "x2": x2.tolist()}, "isochrones": lines}


def _back(
    problem: BallAndWheel, u_last: float, u_first: float, last_s: FloatArray, first_s: FloatArray
) -> tuple[FloatArray, FloatArray]:
    """Return from where ``u_first`` and then ``u_last``, each for a time, lead to rest (Sebesta 2010, G.21)."""
    x1, x2 = 0.5 * problem.gamma * u_last * last_s**2, -problem.gamma * u_last * last_s
    return x1 - x2 * first_s + 0.5 * problem.gamma * u_first * first_s**2, x2 - problem.gamma * u_first * first_s


def _advice(problem: BallAndWheel, found: Switching) -> tuple[str, ...]:
    if found.first == "none":
        return ("The ball rests on top already.",)
    u1, u2 = _controls(problem, found.first)
    if found.switch_time_s == found.time_s:
        return (f"Apply {u1:g} for {found.time_s:.4g} s; the ball then rests on top.",)
    rest = found.time_s - found.switch_time_s
    return (f"Apply {u1:g} for {found.switch_time_s:.4g} s, then {u2:g} for {rest:.4g} s.",)
