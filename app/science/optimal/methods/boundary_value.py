"""The two-point boundary value problem of the maximum principle by collocation (Sebesta 2010, B.20).

Speed is the independent variable, one piece of the problem for each gear, with the speeds of the shifts as unknowns:
at a shift v, λ and time go on, and H is the same in both gears. Time is 0 at the start; at the end H vanishes or the
time is the given one.
"""

from __future__ import annotations

from collections.abc import Callable
from itertools import pairwise
from typing import Any

import numpy as np
from scipy.integrate import solve_bvp

from app.science.arrays import FloatArray
from app.science.optimal.accelerate.kernels import DriveNumbers
from app.science.optimal.methods.field_kernels import best_gear, lead, rows_in
from app.science.optimal.methods.found import Arc, Found, MethodFailed, joined
from app.science.optimal.methods.model import Wheels
from app.science.optimal.methods.shooting import SLOWEST_MPS, costate_for
from app.science.optimal.problem import Accelerate
from app.science.progress import Progress

GUESSES = 9
TOLERANCES = (1e-8, 1e-6, 1e-4)
"""Where the engine's full load has corners, so has the costate, and no mesh reaches the finest."""
MOST_NODES = 1_000
ROUNDS = 8
PANELS = 96
NODES, WEIGHTS = np.polynomial.legendre.leggauss(5)
LEADS = 1e-6
SLOWEST_MPS2 = 1e-6


def boundary_value(problem: Accelerate, drive: DriveNumbers, progress: Progress) -> Found:
    """Return the extremal that rises through a sequence of gears, none of which another gear beats.

    Raises
    ------
    MethodFailed
        When the collocation does not settle, or the sequence of gears does not.
    """
    start = max(problem.from_speed_mps, SLOWEST_MPS)
    speeds = np.linspace(start, problem.to_speed_mps, 40)
    gears = _without_repeats([best_gear(v, costate_for(drive, float(v), 0.0), drive) for v in speeds])
    for turn in range(ROUNDS):
        progress(turn / ROUNDS)
        pieces = Pieces(problem, drive, start, gears)
        solved = pieces.solved(progress)
        places = np.concatenate(([start], solved.p if len(gears) > 1 else [], [problem.to_speed_mps]))
        kept = [gear for gear, (a, b) in zip(gears, pairwise(places), strict=True) if b > a]
        if len(kept) == len(gears):
            kept = pieces.beaten(solved.sol, places)
        if kept == gears:
            return pieces.told(solved.sol, places, len(solved.x))
        gears = kept
    raise MethodFailed("the sequence of gears does not settle; single_shooting needs none.")


def _without_repeats(gears: list[int]) -> list[int]:
    return [gear for k, gear in enumerate(gears) if k == 0 or gear != gears[k - 1]]


class Pieces:
    """The problem for one sequence of gears; each piece runs from 0 to 1."""

    def __init__(self, problem: Accelerate, drive: DriveNumbers, start: float, gears: list[int]) -> None:
        self._problem, self._drive, self._start, self._gears = problem, drive, start, gears
        self._scale = costate_for(drive, start, 0.0)

    def solved(self, progress: Progress) -> Any:
        """Return SciPy's solution, from costates for which H vanishes."""
        count = len(self._gears)
        shifts = self._guessed_shifts()
        places = np.concatenate(([self._start], shifts, [self._problem.to_speed_mps]))
        grid = np.linspace(0.0, 1.0, GUESSES)
        guess = np.zeros((2 * count, GUESSES))
        clock = 0.0
        for k, (a, b) in enumerate(pairwise(places)):
            v = a + (b - a) * grid
            costate = np.array([costate_for(self._drive, float(one), 0.0) for one in v])
            slow = 1.0 / np.maximum(rows_in(self._gears[k], v, costate, self._drive)[1], SLOWEST_MPS2)
            guess[k] = costate / self._scale
            guess[count + k] = clock + np.append(0.0, np.cumsum(0.5 * (slow[1:] + slow[:-1]) * np.diff(v)))
            clock = guess[count + k, -1]
        for tolerance in TOLERANCES:
            progress(0.5)
            found = solve_bvp(
                self._rates if count > 1 else lambda s, y: self._rates(s, y, np.zeros(0)),
                self._ends if count > 1 else lambda a, b: self._ends(a, b, np.zeros(0)),
                grid, guess, p=shifts if count > 1 else None, tol=tolerance, max_nodes=MOST_NODES,
            )  # fmt: skip
            if found.success:
                return found
        raise MethodFailed(
            f"the collocation does not settle ({found.message.rstrip('.').lower()}). A drive that slows down first, or "
            "stays at a speed, has no solution over speed, and corners of full load are corners of the costate; "
            "single_shooting runs in time and from corner to corner."
        )

    def _guessed_shifts(self) -> FloatArray:
        """Return where one gear's H overtakes the one's before, on costates for which H vanishes."""
        speeds = np.linspace(self._start, self._problem.to_speed_mps, 400)
        at = np.array([best_gear(v, costate_for(self._drive, float(v), 0.0), self._drive) for v in speeds])
        shifts, low = [], self._start
        for a, b in pairwise(self._gears):
            changes = np.flatnonzero((at[:-1] == a) & (at[1:] == b))
            v = float(speeds[changes[0]]) if len(changes) else 0.5 * (low + self._problem.to_speed_mps)
            shifts.append(v)
            low = v
        return np.array(shifts)

    def _places(self, shifts: FloatArray) -> FloatArray:
        return np.concatenate(([self._start], shifts, [self._problem.to_speed_mps]))

    def _rates(self, share: FloatArray, y: FloatArray, shifts: FloatArray) -> FloatArray:
        count, places = len(self._gears), self._places(shifts)
        out = np.empty_like(y)
        for k, gear in enumerate(self._gears):
            length = places[k + 1] - places[k]
            rows = rows_in(gear, places[k] + length * share, self._scale * y[k], self._drive)
            accel = np.where(np.abs(rows[1]) > SLOWEST_MPS2, rows[1], SLOWEST_MPS2)
            out[k] = length * rows[2] / accel / self._scale
            out[count + k] = length / accel
        return out

    def _ends(self, first: FloatArray, last: FloatArray, shifts: FloatArray) -> FloatArray:
        count, places = len(self._gears), self._places(shifts)
        h = [
            [self._h(gear, v, y) for v, y in ((places[k], first[k]), (places[k + 1], last[k]))]
            for k, gear in enumerate(self._gears)
        ]
        on = first[1:count] - last[: count - 1], first[count + 1 :] - last[count : 2 * count - 1]
        same = [h[k][1] - h[k + 1][0] for k in range(count - 1)]
        wanted = self._problem.time_s
        end = h[-1][1] if wanted is None else last[-1] - wanted
        return np.concatenate((*on, same, [first[count], end]))

    def _h(self, gear: int, v: float, y: float) -> float:
        return float(rows_in(gear, np.array([v]), np.array([self._scale * y]), self._drive)[0, 0]) / self._scale

    def beaten(self, sol: Callable[[FloatArray], FloatArray], places: FloatArray) -> list[int]:
        """Return the sequence with gears put in where another one has the greater H."""
        gears = list(self._gears)
        share = np.linspace(0.0, 1.0, PANELS + 1)
        now: list[int] = []
        for k, (a, b) in enumerate(pairwise(places)):
            for v, y in zip(a + (b - a) * share, self._scale * sol(share)[k], strict=True):
                better = lead(gears[k], v, y, self._drive) > LEADS * (1.0 + abs(y))
                now.append(best_gear(v, y, self._drive) if better else gears[k])
        return _without_repeats(now)

    def told(self, sol: Callable[[FloatArray], FloatArray], places: FloatArray, nodes: int) -> Found:
        """Return the solution as a drive; fuel, time and distance are quadratures along it."""
        arcs: list[Arc] = []
        share = np.linspace(0.0, 1.0, PANELS + 1)
        half = 0.5 / PANELS
        inner = (share[:-1, None] + half + half * NODES[None, :]).ravel()
        t = x = fuel = 0.0
        for k, (gear, (a, b)) in enumerate(zip(self._gears, pairwise(places), strict=True)):
            v = a + (b - a) * inner
            rows = rows_in(gear, v, self._scale * sol(inner)[k], self._drive)
            step = np.tile(WEIGHTS, PANELS) * half * (b - a) / rows[1]
            seconds, metres = ((step * by).reshape(PANELS, -1).sum(axis=1) for by in (np.ones_like(v), v))
            fuel += float((step * rows[3]).sum())
            at, costate = a + (b - a) * share, self._scale * sol(share)[k]
            _, _, _, power, force, omega, torque, brake = rows_in(gear, at, costate, self._drive)
            clock, way = (np.append(0.0, np.cumsum(part)) for part in (seconds, metres))
            arcs.append(Arc(gear, t + clock, x + way, at, Wheels(force, power, omega, torque), brake, costate))
            t, x = t + float(clock[-1]), x + float(way[-1])
        mu = self._h(self._gears[0], self._start, float(sol(np.zeros(1))[0, 0])) * self._scale
        return joined(self._drive, arcs, fuel, mu_w=mu, more={"collocation": {"nodes": nodes}})
