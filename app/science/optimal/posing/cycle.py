"""A driving cycle as roads: its speed over distance is the limit, and stops divide it."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from app.science.arrays import FloatArray
from app.science.optimal.posing.cleaning import Cleaning, PosedRoad, clean_road
from app.science.optimal.posing.errors import PoseError

STANDING_MPS = 0.1
SHORTEST_M = 10.0
KMH = 3.6


def roads_of_cycle(
    t_s: FloatArray, speed_mps: FloatArray, *, slowest_mps: float = 3.0, cleaning: Cleaning | None = None
) -> tuple[PosedRoad, ...]:
    """Cut a cycle at its stops; each part is a level road that its own drive keeps to.

    Between two rows the limit is the higher of their speeds. A part begins and ends where the cycle is as fast as
    ``slowest_mps``, for no gear can be engaged near standstill; where it is slower in between, the limit is that speed.

    Parameters
    ----------
    t_s, speed_mps : array, shape (n,)
        Speed changes steadily between the rows.
    slowest_mps : float
    cleaning : Cleaning or None
        Of the limits; heights there are none.

    Raises
    ------
    PoseError
        When the cycle is nowhere as fast.
    """
    moving = np.concatenate(([False], speed_mps > STANDING_MPS, [False]))
    edges = np.diff(moving.astype(np.int8))
    parts = zip(np.flatnonzero(edges == 1), np.flatnonzero(edges == -1), strict=True)
    roads = []
    for begin, end in parts:
        fast = begin + np.flatnonzero(speed_mps[begin:end] >= slowest_mps)
        if fast.size < 2:
            continue
        rows = slice(fast[0], fast[-1] + 1)
        part = _part(t_s[rows], speed_mps[rows], slowest_mps, cleaning or Cleaning())
        if part is not None:
            roads.append(part)
    if not roads:
        raise PoseError(
            f"The cycle never keeps above {KMH * slowest_mps:.0f} km/h for {SHORTEST_M:g} m; there is no road in it."
        )
    return tuple(roads)


def _part(t_s: FloatArray, speed: FloatArray, slowest: float, cleaning: Cleaning) -> PosedRoad | None:
    step = 0.5 * (speed[1:] + speed[:-1]) * np.diff(t_s)
    distance = np.concatenate(([0.0], np.cumsum(step)))
    if distance[-1] < SHORTEST_M:
        return None
    limit = np.maximum(np.append(np.maximum(speed[1:], speed[:-1]), speed[-1]), slowest)
    notes = ["The road is level, and its limit is the speed of the cycle at each place."]
    if speed.min() < slowest:
        notes.append(
            f"The cycle slows down to {KMH * speed.min():.1f} km/h without a stop; the limit there is "
            f"{KMH * slowest:.1f} km/h."
        )
    found = clean_road(distance, np.zeros(distance.shape), limit, cleaning)
    return replace(
        found,
        notes=tuple(notes),
        from_speed_mps=float(speed[0]),
        to_speed_mps=float(speed[-1]),
        time_s=float(t_s[-1] - t_s[0]),
    )
