"""The convex hull of points from below."""

from __future__ import annotations

import numpy as np

from app.science.arrays import FloatArray, IntArray


def lower_hull(p: FloatArray, f: FloatArray) -> IntArray:
    """Return which of the points (p, f) are corners of their lower hull; p grows."""
    kept: list[int] = []
    for k in range(len(p)):
        while len(kept) > 1 and (f[kept[-1]] - f[kept[-2]]) * (p[k] - p[kept[-2]]) >= (f[k] - f[kept[-2]]) * (
            p[kept[-1]] - p[kept[-2]]
        ):
            kept.pop()
        kept.append(k)
    return np.array(kept)
