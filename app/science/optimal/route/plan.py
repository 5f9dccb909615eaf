"""A drive by stages, as dynamic programming finds it and a polish starts from it."""

from __future__ import annotations

from dataclasses import dataclass

from app.science.arrays import FloatArray, IntArray


@dataclass(frozen=True, slots=True)
class Plan:
    """Speeds at the edges of stages, a steady acceleration within each, and a gear for each.

    Attributes
    ----------
    edges_m : array, shape (n + 1,)
        Along the road, growing; every point where slope or limit changes is one.
    speed_mps : array, shape (n + 1,)
    gear : int array, shape (n,)
        From 1; 0 in neutral, and with a CVT or a Willans drive.
    price_w : float
        Of a second, at which the drive was found; 0 where time is free.
    """

    edges_m: FloatArray
    speed_mps: FloatArray
    gear: IntArray
    price_w: float
