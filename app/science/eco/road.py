"""The road a driver had before him: its slope as it was driven, and limits that leave him what he may choose.

The best drive must be comparable. So its limit is nowhere below the driven speed, which makes the driven drive one of
those it is chosen from; and where the driver was slow for a reason, in a bend, at a junction or behind others, the best
drive is as slow. In between it may be as fast as he was nearby.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.ndimage import maximum_filter1d

from app.science.arrays import FloatArray
from app.science.eco.ride import Ride
from app.science.optimal.problem import Road

SPACING_M = (20.0, 60.0)
MOST_POINTS = 300
LIMIT_STEP_MPS = 0.5


@dataclass(frozen=True, slots=True)
class Freedom:
    """How much the best drive may differ from the driven one.

    Attributes
    ----------
    nearby_m : float
        It may be as fast at a place as the driver was within this distance.
    slow_place_mps, slow_place_share : float
        A place where the driver was slower than nearby on both sides by both of these is slow for a reason.
    slow_part : float
        Share of such a dip, from its bottom, in which the driven speed stays the limit.
    rolls_in_neutral : bool
        It may roll with the clutch open at idle fuel. Not ordinarily: drivers are told to keep a gear in.
    """

    nearby_m: float = 300.0
    slow_place_mps: float = 1.5
    slow_place_share: float = 0.12
    slow_part: float = 0.3
    rolls_in_neutral: bool = False


@dataclass(frozen=True, slots=True)
class KnownLimits:
    """Speed limits of the road, where they are known.

    Attributes
    ----------
    distance_m : array, shape (k,)
        Of the trip, growing.
    speed_mps : array, shape (k,)
        Each holds from its place to the next one; NaN where unknown.
    """

    distance_m: FloatArray
    speed_mps: FloatArray

    def at(self, distance_m: FloatArray) -> FloatArray:
        """Return the limits at some places."""
        index = np.searchsorted(self.distance_m, distance_m, side="right") - 1
        return np.where(index >= 0, self.speed_mps[np.maximum(index, 0)], np.nan)


def travelled_m(ride: Ride) -> FloatArray:
    """Return how far the ride is at the edges of its pieces, by its speed, shape (n + 1,)."""
    return np.concatenate(([0.0], np.cumsum(ride.speed_mps * ride.dt_s)))


def road_of(ride: Ride, freedom: Freedom, limits: KnownLimits | None = None) -> Road:
    """Return a section's road; distances begin at 0.

    Parameters
    ----------
    ride : Ride
        From stop to stop.
    freedom : Freedom
    limits : KnownLimits, optional
        A known limit takes the place of the speed driven nearby, unless the driver was faster.
    """
    edges = travelled_m(ride)
    length = float(edges[-1])
    spacing = float(np.clip(length / MOST_POINTS, *SPACING_M))
    nodes = np.linspace(0.0, length, max(round(length / spacing), 2) + 1)
    height = np.concatenate(([0.0], np.cumsum(ride.sin_slope * np.diff(edges))))
    fastest = _fastest(ride, edges, nodes)
    allowed = _rounded_up(_allowed(fastest, float(nodes[1]), freedom))
    if limits is not None:
        known = limits.at(float(ride.distance_m[0]) + 0.5 * (nodes[1:] + nodes[:-1]))
        free = allowed > fastest
        allowed = np.where(np.isfinite(known) & free, np.maximum(known, fastest), allowed)
    return Road(
        distance_m=tuple(nodes.tolist()),
        elevation_m=tuple(np.interp(nodes, edges, height).tolist()),
        speed_limit_mps=(*allowed.tolist(), float(allowed[-1])),
    )


def _fastest(ride: Ride, edges: FloatArray, nodes: FloatArray) -> FloatArray:
    """Return the highest driven speed between neighbouring nodes, ends included, shape (nodes − 1,)."""
    middle = 0.5 * (edges[1:] + edges[:-1])
    cell = np.clip(np.searchsorted(nodes, middle, side="right") - 1, 0, len(nodes) - 2)
    fastest = np.interp(nodes, middle, ride.speed_mps)
    found = np.maximum(fastest[1:], fastest[:-1])
    np.maximum.at(found, cell, ride.speed_mps)
    return found


def _allowed(fastest: FloatArray, spacing: float, freedom: Freedom) -> FloatArray:
    """Return the limit between neighbouring nodes."""
    reach = 2 * round(freedom.nearby_m / spacing) + 1
    free = maximum_filter1d(fastest, reach, mode="nearest")
    for bottom, low, high in _dips(fastest):
        depth = min(fastest[low], fastest[high]) - fastest[bottom]
        if depth < max(freedom.slow_place_mps, freedom.slow_place_share * fastest[bottom]):
            continue
        rows = np.arange(low, high + 1)
        held = rows[fastest[rows] <= fastest[bottom] + freedom.slow_part * depth]
        free[held] = fastest[held]
    return np.asarray(free)


def _rounded_up(limits: FloatArray) -> FloatArray:
    """Return limits as steps of half a metre per second, so that they change no oftener than they must."""
    return np.asarray(np.ceil(limits / LIMIT_STEP_MPS) * LIMIT_STEP_MPS)


def _dips(values: FloatArray) -> list[tuple[int, int, int]]:
    """Return each local minimum with the highest places on both sides before a lower minimum comes."""
    n = len(values)
    found = []
    for k in range(1, n - 1):
        if not (values[k] <= values[k - 1] and values[k] < values[k + 1]):
            continue
        before = np.flatnonzero(values[:k] < values[k])
        after = np.flatnonzero(values[k + 1 :] < values[k])
        first = int(before[-1]) + 1 if len(before) else 0
        last = k + int(after[0]) if len(after) else n - 1
        low = first + int(values[first : k + 1].argmax())
        high = k + int(values[k : last + 1].argmax())
        found.append((k, low, high))
    return found
