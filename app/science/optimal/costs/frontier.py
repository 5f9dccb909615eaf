"""The drives between which nothing is better in both: a Pareto front of fuel against an emission, or against time."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

from app.science.errors import ScienceError


class FrontError(ScienceError):
    """A front can't be asked for in this way; the message says what is missing."""

    code = "no-front"


@dataclass(frozen=True, slots=True)
class FrontPoint:
    """One drive of a front.

    Attributes
    ----------
    x, y : float
        What the axes count.
    weights : mapping
        Of the cost that this drive is the best for; empty where its time was given instead.
    fuel_energy_j, time_s, distance_m : float
    emissions_g : mapping
    gears : tuple of int
    verdict : str
        Of the certificate of the weighted cost.
    relative_gap : float or None
        To the independent method.
    """

    x: float
    y: float
    weights: Mapping[str, float]
    fuel_energy_j: float
    time_s: float
    distance_m: float
    emissions_g: Mapping[str, float]
    gears: tuple[int, ...]
    verdict: str
    relative_gap: float | None

    def document(self) -> dict[str, Any]:
        """Return the point with the names others rely on."""
        plain = {name: getattr(self, name) for name in self.__slots__}
        return plain | {
            "weights": dict(self.weights),
            "emissions_g": dict(self.emissions_g),
            "gears": list(self.gears),
        }


@dataclass(frozen=True, slots=True)
class Front:
    """A Pareto front.

    Attributes
    ----------
    x_axis, y_axis : str
        ``fuel_energy_j``, ``weighted_energy_j``, ``time_s``, ``co2_g`` or the name of an emission with ``_g``.
    points : tuple of FrontPoint
        From the least x to the least y.
    edges : tuple of (int, int)
        Pairs of neighbours between which no weights lead to another drive: the front is straight there, or bends
        inward.
    warnings : tuple of str
    """

    x_axis: str
    y_axis: str
    points: tuple[FrontPoint, ...]
    edges: tuple[tuple[int, int], ...] = ()
    warnings: tuple[str, ...] = field(default=())

    def document(self) -> dict[str, Any]:
        """Return the front with the names others rely on."""
        return {
            "kind": "front",
            "x_axis": self.x_axis,
            "y_axis": self.y_axis,
            "points": [point.document() for point in self.points],
            "edges": [list(edge) for edge in self.edges],
            "warnings": list(self.warnings),
        }
