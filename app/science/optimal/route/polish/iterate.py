"""Where the interior point method is, and what it sees there."""

from __future__ import annotations

from dataclasses import dataclass

from app.science.arrays import FloatArray
from app.science.optimal.route.polish.lagrangian import Motion, PerMetre
from app.science.optimal.route.polish.rooms import Rooms


@dataclass(frozen=True, slots=True)
class Point:
    """Where the iteration is.

    Attributes
    ----------
    nodes_j : array, shape (nodes,)
    brake_n : array, shape (n, points)
    slack, multiplier : array, shape (m, n, points)
        The multipliers are those of a metre: J/m for each unit of the limit.
    edge_slack, edge_multiplier : array, shape (2, n + 1)
        Of least and most energy at the edges.
    rolling : array, shape (n, points)
        Multiplier of the equation F = 0 where the car rolls freely.
    time_slack_s, price_w : float
    """

    nodes_j: FloatArray
    brake_n: FloatArray
    slack: FloatArray
    multiplier: FloatArray
    edge_slack: FloatArray
    edge_multiplier: FloatArray
    rolling: FloatArray
    time_slack_s: float
    price_w: float


@dataclass(frozen=True, slots=True)
class Look:
    """Everything the method asks about a drive."""

    motion: Motion
    fuel: PerMetre
    time: PerMetre
    rooms: Rooms
    edge_room: FloatArray
    fuel_j: float
    time_s: float
