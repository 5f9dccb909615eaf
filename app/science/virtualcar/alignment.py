"""The virtual road seen from above, as it is being laid: straights, bends, speed limits, places to stop."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from app.science.virtualcar.specification import RouteName

_HOME_RADIUS_M = 9000.0

Range = tuple[float, float]


@dataclass(frozen=True, slots=True)
class RoadKind:
    """What a kind of road is made of; ranges are drawn from evenly, radii evenly in their logarithm."""

    limits_kmph: tuple[float, ...]
    limit_every_s: Range
    straight_m: Range
    radius_m: Range
    turn_rad: Range
    length_m: Range
    stop_every_m: Range | None
    wait_s: Range = (4.0, 30.0)


TOWN = RoadKind(
    limits_kmph=(30, 50, 50, 60),
    limit_every_s=(25, 80),
    straight_m=(60, 260),
    radius_m=(14, 120),
    turn_rad=(0.3, 1.6),
    length_m=(1500, 4000),
    stop_every_m=(250, 800),
)
COUNTRY = RoadKind(
    limits_kmph=(60, 70, 80, 90, 100),
    limit_every_s=(25, 80),
    straight_m=(40, 400),
    radius_m=(70, 600),
    turn_rad=(0.15, 1.3),
    length_m=(4000, 9000),
    stop_every_m=(2500, 6000),
)
MOTORWAY = RoadKind(
    limits_kmph=(100, 110, 120, 130),
    limit_every_s=(45, 150),
    straight_m=(300, 1500),
    radius_m=(800, 3000),
    turn_rad=(0.1, 0.6),
    length_m=(6000, 12000),
    stop_every_m=None,
)
SPRINT = RoadKind(
    limits_kmph=(45, 60, 120, 130),
    limit_every_s=(12, 30),
    straight_m=(300, 900),
    radius_m=(600, 2500),
    turn_rad=(0.1, 0.6),
    length_m=(6000, 12000),
    stop_every_m=(5000, 12000),
    wait_s=(3.0, 10.0),
)
ROUTES: dict[RouteName, tuple[RoadKind, ...]] = {
    "mixed": (TOWN, COUNTRY, MOTORWAY, COUNTRY),
    "motorway": (MOTORWAY,),
    "town": (TOWN,),
    "full-load": (SPRINT,),
    "tunnel": (COUNTRY, MOTORWAY),
}


class Alignment:
    """A road that grows section by section and keeps turning back towards its start.

    Attributes
    ----------
    length_m, driving_s : float
        How long it is, and how long it takes at its limits.
    knots : list of (metres, 1/m)
        Curvature, linear between the knots.
    limits : list of (metres, m/s)
        Where each limit begins.
    stops : list of (metres, s)
        Where to stop and for how long.
    ways : list of metres
        Where each section begins.
    """

    def __init__(self, rng: np.random.Generator) -> None:
        self._rng = rng
        self._north = self._east = self._heading = 0.0
        self.length_m = 0.0
        self.driving_s = 0.0
        self.knots: list[tuple[float, float]] = [(0.0, 0.0)]
        self.limits: list[tuple[float, float]] = []
        self.stops: list[tuple[float, float]] = []
        self.ways: list[float] = []

    def add_section(self, kind: RoadKind) -> None:
        """Append a section of one kind of road."""
        begin = self.length_m
        end = begin + self._draw(kind.length_m)
        self.ways.append(begin)
        while self.length_m < end:
            self._advance(self._draw(kind.straight_m), 0.0, 0.0)
            self._bend(kind)
        at = begin
        while at < self.length_m:
            limit = float(self._rng.choice(kind.limits_kmph)) / 3.6
            stretch = min(self._draw(kind.limit_every_s) * limit, self.length_m - at)
            self.limits.append((at, limit))
            self.driving_s += stretch / limit
            at += stretch
        if kind.stop_every_m is not None:
            at = begin + self._draw(kind.stop_every_m)
            while at < self.length_m - 50.0:
                self.stops.append((at, self._draw(kind.wait_s)))
                at += self._draw(kind.stop_every_m)

    def _draw(self, bounds: Range) -> float:
        return float(self._rng.uniform(*bounds))

    def _bend(self, kind: RoadKind) -> None:
        radius = float(np.exp(self._rng.uniform(*np.log(kind.radius_m))))
        turn = self._draw(kind.turn_rad)
        curvature = self._side() / radius
        transition = min(0.5 * radius * turn, max(12.0, radius**0.6))
        self._advance(transition, 0.5 * curvature, curvature)
        self._advance(max(radius * turn - transition, 1.0), curvature, curvature)
        self._advance(transition, 0.5 * curvature, 0.0)

    def _side(self) -> float:
        """Right is +1; the farther from home, the likelier the side that leads back."""
        back = np.sin(np.arctan2(-self._east, -self._north) - self._heading)
        if self._rng.uniform() < min(0.85, np.hypot(self._north, self._east) / _HOME_RADIUS_M):
            return 1.0 if back > 0 else -1.0
        return 1.0 if self._rng.uniform() < 0.5 else -1.0

    def _advance(self, length: float, mean_curvature: float, end_curvature: float) -> None:
        middle = self._heading + 0.5 * mean_curvature * length
        self._north += length * float(np.cos(middle))
        self._east += length * float(np.sin(middle))
        self._heading += mean_curvature * length
        self.length_m += length
        self.knots.append((self.length_m, end_curvature))


def lay_out(route: RouteName, duration_s: float, rng: np.random.Generator) -> Alignment:
    """Lay a road that lasts for the given driving time even at its limits."""
    alignment = Alignment(rng)
    kinds = ROUTES[route]
    section = int(rng.integers(len(kinds))) if route == "mixed" else 0
    while alignment.driving_s < duration_s + 120.0:
        alignment.add_section(kinds[section % len(kinds)])
        section += 1
    return alignment
