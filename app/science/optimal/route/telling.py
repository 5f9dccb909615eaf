"""A long drive in a driver's words: what to do stretch by stretch, from one change of the limit to the next."""

from __future__ import annotations

import numpy as np

from app.science.arrays import FloatArray
from app.science.optimal.advice import KMH, MOST_LINES, advise
from app.science.optimal.answer import Trajectory
from app.science.optimal.problem import Route

SAME_KMH = 2.0
SELDOM = 0.03
"""Of a stretch's time: what is done less is not told."""


def told(problem: Route, trajectory: Trajectory) -> tuple[str, ...]:
    """Return what to do: move by move where that is short, else by stretches of the road."""
    moves = advise(trajectory)
    return moves if len(moves) < MOST_LINES else by_stretches(problem, trajectory)


def by_stretches(problem: Route, trajectory: Trajectory) -> tuple[str, ...]:
    """Return what to do on each stretch of the road."""
    return tuple(_stretch(trajectory, a, b) for a, b in _stretches(problem))


def _stretches(problem: Route) -> list[tuple[float, float]]:
    """Return the road between changes of its limit, the shortest joined until they are few."""
    at, limit = np.array(problem.road.distance_m), np.array(problem.road.speed_limit_mps)
    edges = np.concatenate((at[:1], at[1:-1][np.diff(limit[:-1]) != 0.0], at[-1:]))
    while len(edges) > MOST_LINES + 1:
        short = int(np.diff(edges).argmin())
        edges = np.delete(edges, short if short > 0 else 1)
    return list(zip(edges[:-1].tolist(), edges[1:].tolist(), strict=True))


def _stretch(t: Trajectory, begin_m: float, end_m: float) -> str:
    """Tell one stretch; ``seconds`` from each row to the next count where their middle lies on it."""
    inside = (t.distance_m >= begin_m) & (t.distance_m <= end_m)
    middle = 0.5 * (t.distance_m[1:] + t.distance_m[:-1])
    seconds = np.append(np.where((middle >= begin_m) & (middle <= end_m), np.diff(t.t_s), 0.0), 0.0)
    low, high = (KMH * float(f(t.speed_mps[inside])) for f in (np.min, np.max))
    last = KMH * float(np.interp(end_m, t.distance_m, t.speed_mps))
    speeds = (
        f"hold {high:.0f} km/h" if high - low <= SAME_KMH else f"{low:.0f} to {high:.0f} km/h, {last:.0f} at its end"
    )
    return f"{begin_m / 1000.0:.1f} to {end_m / 1000.0:.1f} km: {speeds}{_pull(t, seconds)}{_rest(t, seconds)}"


def _pull(t: Trajectory, seconds: FloatArray) -> str:
    """Return the gears that pull, most used first, and the torque in which most of the work is done."""
    total = max(float(seconds.sum()), 1e-9)
    used = {int(g): float(seconds[t.gear == g].sum()) / total for g in np.unique(t.gear[t.gear > 0])}
    gears = sorted((g for g, share in used.items() if share > SELDOM), key=lambda g: -used[g])
    work = np.where(t.gear > 0, seconds * np.nan_to_num(t.torque_nm * t.engine_speed_radps).clip(0.0), 0.0)
    if not gears or work.sum() <= 0.0:
        return ""
    order = np.argsort(np.nan_to_num(t.torque_nm))
    middle = float(t.torque_nm[order][np.searchsorted(np.cumsum(work[order]), 0.5 * work.sum())])
    names = " and ".join((", ".join(map(str, gears[:-1])), str(gears[-1]))) if len(gears) > 1 else str(gears[0])
    return f"; pull in gear {names} with about {middle:.0f} Nm"


def _rest(t: Trajectory, seconds: FloatArray) -> str:
    """Return how long the car rolls in neutral and brakes."""
    total = max(float(seconds.sum()), 1e-9)
    rolls = float(seconds[(t.gear == 0) & (t.brake_n <= 0.0)].sum()) if (t.gear > 0).any() else 0.0
    brakes = float(seconds[t.brake_n > 0.0].sum())
    said = f"; roll in neutral for {rolls:.0f} s" if rolls > SELDOM * total else ""
    return said + (f"; brake for {brakes:.0f} s" if brakes > SELDOM * total else "")
