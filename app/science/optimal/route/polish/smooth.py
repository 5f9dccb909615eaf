"""Roads without gears to choose: a polish from a rough drive, whose own bound says whether that was enough."""

from __future__ import annotations

from itertools import pairwise

import numpy as np

from app.science.optimal.problem import Route
from app.science.optimal.route.plan import Plan
from app.science.optimal.route.polish.certifying import CLOSED
from app.science.optimal.route.polish.polishing import Polished, polish
from app.science.progress import Progress

ROUGH_MPS2 = 0.8
BELOW_LIMIT = 0.9
PRICE_W = 3e3
PIECE_M = 25.0


def smoothly(problem: Route, progress: Progress) -> Polished | None:
    """Solve a route of a CVT or a Willans drive; None where the drive isn't known to be the best that way."""
    if problem.transmission.kind == "gears" and problem.transmission.ratios:
        return None
    drive = polish(problem, rough(problem), progress)
    if drive is None or drive.fuel_j - drive.lower_bound_j > CLOSED * drive.fuel_j:
        return None
    return drive


def rough(problem: Route) -> Plan:
    """Return speeds somewhat below the limits that change steadily, without asking what the car can do."""
    road = problem.road
    at = np.array(road.distance_m)
    limit = np.array(road.speed_limit_mps[:-1])
    top = BELOW_LIMIT * np.minimum(np.append(limit[0], limit), np.append(limit, limit[-1]))
    if problem.max_time_s is not None:
        mean = 1.1 * (at[-1] - at[0]) / problem.max_time_s
        top = np.minimum(top, max(mean, 1.1 * problem.min_speed_mps))
    top = np.maximum(top, 0.5 * (problem.min_speed_mps + top))
    top[0], top[-1] = problem.from_speed_mps, problem.to_speed_mps
    edges = np.unique(
        np.concatenate([np.linspace(a, b, int((b - a) // PIECE_M) + 2) for a, b in pairwise(at.tolist())])
    )
    square = np.interp(edges, at, top**2)
    gain = 2.0 * ROUGH_MPS2 * np.diff(edges)
    for k in range(1, len(edges) - 1):
        square[k] = min(square[k], square[k - 1] + gain[k - 1])
    for k in range(len(edges) - 2, 0, -1):
        square[k] = min(square[k], square[k + 1] + gain[k])
    return Plan(
        edges, np.sqrt(square), np.zeros(len(edges) - 1, dtype=np.int64), PRICE_W if problem.max_time_s else 0.0
    )
