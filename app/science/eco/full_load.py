"""The most torque that a car has shown: in its map, and on the trip itself."""

from __future__ import annotations

import numpy as np

from app.science.arrays import FloatArray
from app.science.eco.ride import Ride
from app.science.engine.efficiency_map import EfficiencyMap
from app.science.optimal.problem import RADPS_PER_RPM

BIN_RPM = 250.0
LONG_ENOUGH_S = 1.0
HIGH = 0.95
"""Share of the torques at an engine speed that are lower; what is above may be noise."""


def full_load_seen(cells: EfficiencyMap, ride: Ride, torque_nm: FloatArray) -> tuple[tuple[float, float], ...]:
    """Return the full load as (rpm, Nm), by rising engine speed.

    Parameters
    ----------
    cells : EfficiencyMap
        With its full load, or a lower bound of it.
    ride : Ride
    torque_nm : array, shape (n,)
        Of the engine at the pieces of the ride; NaN where it doesn't pull.
    """
    known = np.isfinite(torque_nm) & (ride.gear > 0) & (torque_nm > 0.0)
    rpm, nm, seconds = ride.engine_radps[known] / RADPS_PER_RPM, torque_nm[known], ride.dt_s[known]
    column = np.floor(rpm / BIN_RPM).astype(np.int64)
    shown = [
        (float(rpm[here].mean()), float(np.quantile(nm[here], HIGH)))
        for k in np.unique(column)
        if seconds[here := column == k].sum() >= LONG_ENOUGH_S
    ]
    at, most = np.array(shown).reshape(-1, 2).T
    return upper_hull(np.append(cells.full_load_rpm, at), np.append(cells.full_load_nm, most))


def upper_hull(rpm: FloatArray, nm: FloatArray) -> tuple[tuple[float, float], ...]:
    """Return the least line above some full-load points that bends one way, as points by rising engine speed.

    What an engine was seen to give is a lower bound of its full load. A torque that it gave both at a lower and at a
    higher speed it gives in between, too.
    """
    hull: list[tuple[float, float]] = []
    for point in sorted(zip(rpm.tolist(), nm.tolist(), strict=True)):
        while len(hull) > 1 and _turns_left(hull[-2], hull[-1], point):
            hull.pop()
        hull.append(point)
    return tuple(hull)


def _turns_left(one: tuple[float, float], two: tuple[float, float], three: tuple[float, float]) -> bool:
    across = (two[0] - one[0]) * (three[1] - one[1]) - (two[1] - one[1]) * (three[0] - one[0])
    return across >= 0.0
