"""A drive's road in elements: their lengths, gears, slopes and limits."""

from __future__ import annotations

from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from app.science.arrays import FloatArray, IntArray
from app.science.optimal.problem import RADPS_PER_RPM, PolynomialEngine, Route
from app.science.optimal.route.plan import Plan
from app.science.optimal.route.polish.basis import BASIS, DEGREE, FROM_REST, PLAIN, TO_REST

SLOWEST_J_PER_KG = 5e-7
"""Kinetic energy that stands for standstill inside a drive: a millimetre in a second."""
HALVES = 8
SAME_SLOPE, SAME_M = 1e-12, 1e-6
SHARE, MOST_PIECES = 0.1, 8
"""Of its energy, by which a drive changes within an element; and into how many one is cut at once."""


@dataclass(frozen=True, slots=True)
class Mesh:
    """Elements along a road.

    Attributes
    ----------
    edges_m : array, shape (n + 1,)
    gear : int array, shape (n,)
        0 in neutral, and with a CVT or a Willans drive.
    ratio_radpm : array, shape (n,)
        By how many rad the engine turns in a metre; 0 in neutral and without gears.
    slope_n : array, shape (n,)
        Rolling resistance and what gravity pulls back.
    least_j, most_j : array, shape (n,)
        Kinetic energies between which the drive stays.
    kind : int array, shape (n,)
        Of the element in ``BASIS``.
    begin_j, end_j : float
        Kinetic energy at both ends of the road.
    """

    edges_m: FloatArray
    gear: IntArray
    ratio_radpm: FloatArray
    slope_n: FloatArray
    least_j: FloatArray
    most_j: FloatArray
    kind: IntArray
    begin_j: float
    end_j: float

    @property
    def length_m(self) -> FloatArray:
        """Of each element."""
        return np.diff(self.edges_m)

    @property
    def points_m(self) -> FloatArray:
        """Return where the drive is looked at, shape (n, points)."""
        return self.edges_m[:-1, None] + self.length_m[:, None] * BASIS.points[self.kind]

    @property
    def nodes_m(self) -> FloatArray:
        """Return the places of the unknown energies, shape (n · DEGREE + 1,)."""
        inner = self.edges_m[:-1, None] + self.length_m[:, None] * BASIS.nodes[:-1]
        return np.append(inner.ravel(), self.edges_m[-1])

    def at_nodes(self, energy_j: FloatArray) -> FloatArray:
        """Return energies by element, shape (n, nodes)."""
        n = len(self.gear)
        return np.asarray(energy_j[np.arange(n)[:, None] * DEGREE + np.arange(DEGREE + 1)])


def mesh_of(problem: Route, edges_m: FloatArray, gear: IntArray) -> Mesh:
    """Return the elements between edges, each within one segment of the road and one gear.

    Parameters
    ----------
    problem : Route
    edges_m : array, shape (n + 1,)
    gear : int array, shape (n,)
    """
    load, road = problem.load, problem.road
    at, high = np.array(road.distance_m), np.array(road.elevation_m)
    sine = np.diff(high) / np.diff(at)
    limit = np.array(road.speed_limit_mps)
    middle = 0.5 * (edges_m[1:] + edges_m[:-1])
    k = np.clip(np.searchsorted(at, middle, side="right") - 1, 0, len(sine) - 1)
    weight = load.mass_kg * load.gravity_mps2
    slope = weight * (load.crr * np.sqrt(1.0 - sine[k] ** 2) + sine[k])
    half = 0.5 * load.accelerated_mass_kg
    begin, end = half * problem.from_speed_mps**2, half * problem.to_speed_mps**2
    least = np.full(len(gear), max(half * problem.min_speed_mps**2, load.accelerated_mass_kg * SLOWEST_J_PER_KG))
    most = half * limit[k] ** 2
    ratios = np.concatenate(([0.0], problem.transmission.ratios)) / load.wheel_radius_m
    ratio = ratios[gear] if len(problem.transmission.ratios) else np.zeros(len(gear))
    if isinstance(problem.engine, PolynomialEngine) and problem.transmission.kind == "gears":
        low, top = (half * (rpm * RADPS_PER_RPM / np.where(ratio > 0.0, ratio, 1.0)) ** 2
                    for rpm in problem.engine.speed_rpm)  # fmt: skip
        least = np.where(ratio > 0.0, np.maximum(least, low), least)
        most = np.where(ratio > 0.0, np.minimum(most, top), most)
    kind = np.full(len(gear), PLAIN)
    if begin == 0.0:
        kind[0] = FROM_REST
    if end == 0.0:
        kind[-1] = TO_REST
    return Mesh(edges_m, gear, ratio, slope, least, most, kind, begin, end)


def elements_of(problem: Route, plan: Plan, longest_m: float) -> Mesh:
    """Join a plan's stages to elements no longer than said, cutting where gear, slope or limit change."""
    bends = bends_of(problem)
    near = np.clip(np.searchsorted(bends, plan.edges_m - SAME_M), 0, max(len(bends) - 1, 0))
    stages = plan.edges_m
    if len(bends):
        stages = np.where(np.abs(bends[near] - stages) > SAME_M, stages, bends[near])
    edges = np.unique(np.concatenate((stages, bends)))
    gear = plan.gear[np.clip(np.searchsorted(stages, 0.5 * (edges[1:] + edges[:-1])) - 1, 0, len(plan.gear) - 1)]
    new = np.flatnonzero((np.diff(gear) != 0) | np.isin(edges[1:-1], bends)) + 1
    borders = np.concatenate(([0], new, [len(gear)]))
    cut: list[float] = []
    gears: list[int] = []
    for a, b in pairwise(borders.tolist()):
        count = max(int(np.ceil((edges[b] - edges[a]) / longest_m)), 1)
        cut.extend(np.linspace(edges[a], edges[b], count + 1)[:-1])
        gears.extend([int(gear[a])] * count)
    cut.append(float(edges[-1]))
    at, gear = _graded(np.array(cut), np.array(gears, dtype=np.int64), problem)
    return mesh_of(problem, at, gear)


def bends_of(problem: Route) -> FloatArray:
    """Return the points inside the road at which its slope or its limit changes."""
    at, limit = np.array(problem.road.distance_m), np.array(problem.road.speed_limit_mps)
    sine = np.diff(problem.road.elevation_m) / np.diff(at)
    changes = (np.abs(np.diff(sine)) > SAME_SLOPE) | (np.diff(limit[:-1]) != 0.0)
    return np.asarray(at[1:-1][changes])


def refined(problem: Route, mesh: Mesh, nodes_j: FloatArray) -> Mesh:
    """Cut elements within which a drive's energy changes by more than a share of it; not those at standstill."""
    ends = mesh.at_nodes(nodes_j)[:, [0, -1]]
    change = np.abs(ends[:, 1] - ends[:, 0]) / np.maximum(ends.min(axis=1), 0.1 * ends.max(axis=1))
    count = np.clip(np.ceil(change / SHARE), 1, MOST_PIECES).astype(np.int64)
    count[mesh.kind != PLAIN] = 1
    pieces = [np.linspace(a, b, n + 1)[:-1] for a, b, n in zip(mesh.edges_m[:-1], mesh.edges_m[1:], count, strict=True)]
    return mesh_of(problem, np.append(np.concatenate(pieces), mesh.edges_m[-1]), np.repeat(mesh.gear, count))


def _graded(edges: FloatArray, gear: IntArray, problem: Route) -> tuple[FloatArray, IntArray]:
    """Halve the first element after standstill and the last one before it again and again."""
    if problem.from_speed_mps == 0.0:
        more = edges[0] + (edges[1] - edges[0]) * 0.5 ** np.arange(HALVES, 0, -1)
        edges, gear = np.insert(edges, 1, more), np.insert(gear, 0, [gear[0]] * HALVES)
    if problem.to_speed_mps == 0.0:
        more = edges[-1] - (edges[-1] - edges[-2]) * 0.5 ** np.arange(1, HALVES + 1)
        edges, gear = np.insert(edges, len(edges) - 1, more), np.append(gear, [gear[-1]] * HALVES)
    return edges, gear
