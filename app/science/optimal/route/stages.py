"""A road cut into stages: where slope or limit changes, long ones again, and finer where speeds change."""

from __future__ import annotations

from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from app.science.arrays import FloatArray
from app.science.optimal.problem import RoadLoad, Route

LADDER = 1.6
LEAST_M = 1.0
PER_LIMIT = 0.06
"""Longest stage over the square of its limit, s²/m: the slower, the sooner an engine that must pull changes speed."""
SAME_LIMIT_MPS = 1e-9


@dataclass(frozen=True, slots=True)
class Stages:
    """A road by stages.

    Attributes
    ----------
    edges_m : array, shape (n + 1,)
    grade_n : array, shape (n,)
        What slope and rolling resistance take, N: M g (sin θ + C_rr cos θ).
    cap_mps : array, shape (n + 1,)
        Highest speed that is allowed at an edge.
    """

    edges_m: FloatArray
    grade_n: FloatArray
    cap_mps: FloatArray

    @property
    def length_m(self) -> FloatArray:
        """Return the length of each stage."""
        return np.diff(self.edges_m)


def limits_at(problem: Route, edges_m: FloatArray) -> FloatArray:
    """Return the highest speed that is allowed anywhere between two edges, as the least limit there, shape (n,)."""
    at, limit = np.array(problem.road.distance_m), np.array(problem.road.speed_limit_mps)
    first = np.searchsorted(at, edges_m[:-1], side="right") - 1
    last = np.searchsorted(at, edges_m[1:], side="left") - 1
    return np.array([limit[a : b + 1].min() for a, b in zip(first, last, strict=True)])


def staged(problem: Route, edges_m: FloatArray) -> Stages:
    """Return the stages between edges; slopes between road points are averaged where a stage has some inside."""
    road, load = problem.road, problem.load
    elevation = np.interp(edges_m, road.distance_m, road.elevation_m)
    sine = np.diff(elevation) / np.diff(edges_m)
    limit = limits_at(problem, edges_m)
    cap = np.minimum(np.append(limit, np.inf), np.append(np.inf, limit))
    return Stages(edges_m, grade_n(load, sine), cap)


def grade_n(load: RoadLoad, sine: FloatArray) -> FloatArray:
    """Return what slope and rolling resistance take, N."""
    weight = load.mass_kg * load.gravity_mps2
    return np.asarray(weight * sine + load.crr * weight * np.sqrt(1.0 - sine**2))


def finest_edges(problem: Route, longest_m: float, near_m: float) -> FloatArray:
    """Return the edges of the finest stages.

    Parameters
    ----------
    problem : Route
    longest_m : float
        No stage is longer; shorter ones where the limit is low.
    near_m : float
        Within so far of a start, an end or a change of the limit, stages are half as long; where the car starts
        or stops they shrink to a metre.
    """
    at = np.array(problem.road.distance_m)
    limit = np.array(problem.road.speed_limit_mps)
    changes = at[1:-1][np.abs(np.diff(limit[:-1])) > SAME_LIMIT_MPS]
    edges = [at]
    slow = np.maximum(PER_LIMIT * limit[:-1] ** 2, LEAST_M)
    pieces = np.ceil(np.diff(at) / np.minimum(longest_m, slow)).astype(np.int64)
    edges += [np.linspace(a, b, many + 1)[1:-1] for (a, b), many in zip(pairwise(at), pieces, strict=True)]
    half = np.round(0.5 * longest_m, 6)
    beside = half * np.arange(-int(near_m / half), int(near_m / half) + 1)
    edges += [place + beside for place in (at[0], at[-1], *_apart(changes, longest_m))]
    edges += [at[0] + _ladder(problem.from_speed_mps, half), at[-1] - _ladder(problem.to_speed_mps, half)]
    found = np.unique(np.concatenate(edges))
    found = found[(found >= at[0]) & (found <= at[-1])]
    return _thinned(found, at, 0.4 * min(half, LEAST_M + problem.from_speed_mps))


def _ladder(speed_mps: float, half_m: float) -> FloatArray:
    """Return growing distances from a place where the car is slow; none where it is fast."""
    step, places = LEAST_M + speed_mps, [0.0]
    while step < half_m:
        places.append(places[-1] + step)
        step *= LADDER
    return np.array(places)


def _apart(places: FloatArray, least_m: float) -> list[float]:
    """Return places that are at least so far apart."""
    kept: list[float] = []
    for place in places.tolist():
        if not kept or place - kept[-1] >= least_m:
            kept.append(place)
    return kept


def _thinned(edges_m: FloatArray, keep_m: FloatArray, least_m: float) -> FloatArray:
    """Drop edges closer than ``least_m`` to one before them or to the next one that must be kept."""
    must = np.isin(edges_m, keep_m)
    fixed = edges_m[must]
    ahead = fixed[np.searchsorted(fixed, edges_m)] - edges_m
    found: list[float] = []
    for place, kept, room in zip(edges_m.tolist(), must.tolist(), ahead.tolist(), strict=True):
        if kept or (place - found[-1] >= least_m and room >= least_m):
            found.append(place)
    return np.array(found)


def coarser(edges_m: FloatArray, problem: Route, shortest_m: float) -> FloatArray:
    """Return some of the edges, each at least ``shortest_m`` from the next one unless the limit changes there."""
    at, limit = np.array(problem.road.distance_m), np.array(problem.road.speed_limit_mps)
    changes = at[1:-1][np.abs(np.diff(limit[:-1])) > SAME_LIMIT_MPS]
    wanted = np.isin(edges_m, np.array(_apart(changes, 0.5 * shortest_m)))
    wanted[[0, -1]] = True
    fixed = edges_m[wanted]
    ahead = fixed[np.searchsorted(fixed, edges_m)] - edges_m
    kept: list[float] = []
    for place, must, room in zip(edges_m.tolist(), wanted.tolist(), ahead.tolist(), strict=True):
        if must or (place - kept[-1] >= shortest_m and room >= 0.5 * shortest_m):
            kept.append(place)
    return np.array(kept)
