"""Roads of a map: one of them from end to end, and the speed limits along a track."""

from __future__ import annotations

import heapq
from collections import Counter, defaultdict
from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from app.science.arrays import FloatArray, IntArray
from app.science.optimal.posing.errors import PoseError
from app.science.roads.elevation import RoadElevation
from app.science.roads.pieces import metres_per_degree

UNKNOWN = 0.0
"""Stands for a limit that isn't known where limits are looked up like heights."""


@dataclass(frozen=True, slots=True, eq=False)
class Highway:
    """A way that cars drive on.

    Attributes
    ----------
    names : tuple of str
        Its number and its name.
    limit_mps : float or None
    node : int array, shape (n,)
        Ways with a node in common meet there.
    lat_deg, lon_deg : array, shape (n,)
    """

    names: tuple[str, ...]
    limit_mps: float | None
    node: IntArray
    lat_deg: FloatArray
    lon_deg: FloatArray


@dataclass(frozen=True, slots=True, eq=False)
class Course:
    """A road from end to end, arrays of shape (n,); a limit holds from its point on, NaN where none is known."""

    lat_deg: FloatArray
    lon_deg: FloatArray
    limit_mps: FloatArray

    @property
    def ends(self) -> str:
        """Between which places it runs."""
        first, last = (f"{self.lat_deg[k]:.4f}°, {self.lon_deg[k]:.4f}°" for k in (0, -1))
        return f"The road runs from {first} to {last}."

    def backwards(self) -> Course:
        """Return the road the other way."""
        limit = np.append(self.limit_mps[-2::-1], self.limit_mps[0])
        return Course(self.lat_deg[::-1], self.lon_deg[::-1], limit)


@dataclass(frozen=True, slots=True, eq=False)
class Highways:
    """All ways of a map that cars drive on."""

    ways: tuple[Highway, ...]

    def course(self, name: str) -> Course:
        """Return the road of a number or a name from end to end.

        Its parts may have gaps and branches: of all pairs of places that are joined by it, the two that are furthest
        apart along their shortest way.

        Raises
        ------
        PoseError
            When no way has that name.
        """
        own = [way for way in self.ways if name in way.names and way.node.size > 1]
        if not own:
            counts = Counter(way.names[0] for way in self.ways if way.names)
            others = ", ".join(word for word, _ in counts.most_common(8))
            raise PoseError(f"No road is called {name!r} in this map; it has {others}, among others.")
        links, place, limit = _graph(own)
        route = max((_longest(links, start) for start in _parts(links)), key=lambda found: found[0])[1]
        limits = [limit[pair] for pair in pairwise(route)]
        lat, lon = (np.array([place[node][k] for node in route]) for k in (0, 1))
        return Course(lat, lon, np.array([np.nan if x is None else x for x in (*limits, limits[-1])]))

    def limits_along(self, lat_deg: FloatArray, lon_deg: FloatArray) -> FloatArray:
        """Return the limit of the nearest road at positions, m/s; NaN where it has none or no road is within 25 m.

        Where roads cross, the limit is that of the place before.
        """
        whole = [way for way in self.ways if way.node.size > 1]
        table = RoadElevation(
            np.concatenate([way.lat_deg for way in whole]),
            np.concatenate([way.lon_deg for way in whole]),
            np.concatenate([np.full(way.node.size, way.limit_mps or UNKNOWN) for way in whole]),
            np.repeat(np.arange(len(whole)), [way.node.size for way in whole]),
        )
        found = table.lookup(lat_deg, lon_deg)
        unclear = np.isnan(found.alt_m) & np.isfinite(found.distance_m)
        last = np.maximum.accumulate(np.where(unclear, -1, np.arange(found.alt_m.size)))
        limit = np.where(last >= 0, found.alt_m[np.maximum(last, 0)], np.nan)
        return np.where(limit > UNKNOWN, limit, np.nan)


def _graph(
    ways: list[Highway],
) -> tuple[dict[int, dict[int, float]], dict[int, tuple[float, float]], dict[tuple[int, int], float | None]]:
    """Return lengths between neighbouring nodes, where nodes lie, and limits between them."""
    links: dict[int, dict[int, float]] = defaultdict(dict)
    place: dict[int, tuple[float, float]] = {}
    limit: dict[tuple[int, int], float | None] = {}
    for way in ways:
        nodes = way.node.tolist()
        north, east = metres_per_degree(0.5 * (way.lat_deg[1:] + way.lat_deg[:-1]))
        step = np.hypot(np.diff(way.lat_deg) * north, np.diff(way.lon_deg) * east).tolist()
        place |= dict(zip(nodes, zip(way.lat_deg.tolist(), way.lon_deg.tolist(), strict=True), strict=True))
        for (a, b), metres in zip(pairwise(nodes), step, strict=True):
            links[a][b] = links[b][a] = metres
            limit[a, b] = limit[b, a] = way.limit_mps
    return dict(links), place, limit


def _parts(links: dict[int, dict[int, float]]) -> list[int]:
    """Return one node of each part that hangs together."""
    left, starts = set(links), []
    while left:
        start = min(left)
        starts.append(start)
        left -= _reached(links, start)[0].keys()
    return starts


def _longest(links: dict[int, dict[int, float]], start: int) -> tuple[float, list[int]]:
    """Return the length and the nodes of the longest of all shortest ways, from the furthest node of any."""
    first, _ = _reached(links, start)
    one = max(first, key=lambda node: (first[node], node))
    far, before = _reached(links, one)
    node = max(far, key=lambda other: (far[other], other))
    length, route = far[node], [node]
    while node != one:
        node = before[node]
        route.append(node)
    return length, route[::-1]


def _reached(links: dict[int, dict[int, float]], start: int) -> tuple[dict[int, float], dict[int, int]]:
    """Return how far every node is (Dijkstra's algorithm), and from which one it is reached."""
    far, before, queue = {start: 0.0}, {start: start}, [(0.0, start)]
    done: set[int] = set()
    while queue:
        length, node = heapq.heappop(queue)
        if node in done:
            continue
        done.add(node)
        for other, metres in links[node].items():
            if length + metres < far.get(other, float("inf")):
                far[other], before[other] = length + metres, node
                heapq.heappush(queue, (length + metres, other))
    return far, before
