"""The road of a stored trip, from its states."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

import numpy as np

from app.science.arrays import FloatArray
from app.science.optimal.posing.cleaning import Cleaning, PosedRoad, clean_road
from app.science.optimal.posing.errors import PoseError

SMOOTH_M = 50.0
NEARBY_M = 300.0
SLOWEST_MPS = 3.0
NEEDED = ("t_s", "distance_m", "down_m", "speed_mps")


def road_of_states(
    states: Mapping[str, FloatArray],
    speed_limit_mps: FloatArray | float | None = None,
    *,
    from_t_s: float = -np.inf,
    to_t_s: float = np.inf,
    cleaning: Cleaning | None = None,
) -> PosedRoad:
    """Make a road of a stretch of a trip.

    Parameters
    ----------
    states : mapping of str to array, shape (n,)
        The columns of ``states.parquet``: ``t_s``, ``distance_m``, ``down_m``, ``speed_mps``.
    speed_limit_mps : array of shape (n,), float or None
        At each row; None takes the highest speed driven within 300 m.
    from_t_s, to_t_s : float
        The stretch.
    cleaning : Cleaning or None
        Heights are smoothed by 50 m unless it says otherwise.

    Raises
    ------
    PoseError
        When a column is missing, the car doesn't move, or for what `clean_road` refuses.
    """
    missing = [name for name in NEEDED if name not in states]
    if missing:
        raise PoseError(f"The trip has no {', '.join(missing)}; a road needs distance, height and speed.")
    inside = (states["t_s"] >= from_t_s) & (states["t_s"] <= to_t_s)
    t, s, down, v = (np.asarray(states[name], dtype=np.float64)[inside] for name in NEEDED)
    if s.size < 2 or s[-1] - s[0] < 1.0:
        raise PoseError("The car hardly moves in this stretch of the trip; there is no road in it.")
    s = np.maximum.accumulate(s)
    notes = []
    if speed_limit_mps is None:
        limit = _fastest_nearby(s, v)
        notes.append(f"The limit is the highest speed that was driven within {NEARBY_M:g} m.")
    else:
        limit = np.broadcast_to(np.asarray(speed_limit_mps, dtype=np.float64), inside.shape)[inside]
    wanted = cleaning or Cleaning(smooth_m=SMOOTH_M, nearest_m=2.0)
    found = clean_road(s, -down, np.maximum(limit, SLOWEST_MPS), wanted)
    return replace(
        found,
        notes=(*notes, *found.notes),
        from_speed_mps=max(float(v[0]), 0.0),
        to_speed_mps=max(float(v[-1]), 0.0),
        time_s=float(t[-1] - t[0]),
    )


def _fastest_nearby(s: FloatArray, v: FloatArray) -> FloatArray:
    """Return the highest speed within a distance to either side."""
    first = np.searchsorted(s, s - NEARBY_M, side="left")
    last = np.searchsorted(s, s + NEARBY_M, side="right")
    # the highest of any stretch from two that overlap, of a power of two rows each
    tables = [v]
    while 2 ** len(tables) <= v.size:
        half = 2 ** (len(tables) - 1)
        tables.append(np.maximum(tables[-1][:-half], tables[-1][half:]))
    level = np.floor(np.log2(last - first)).astype(np.int64)
    found = np.empty(v.shape)
    for k in np.unique(level):
        rows = level == k
        found[rows] = np.maximum(tables[k][first[rows]], tables[k][last[rows] - 2**k])
    return found
