"""Measured distances, heights and limits as the road of a problem, with no more points than it needs."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from app.science.arrays import BoolArray, FloatArray, IntArray
from app.science.optimal.posing.errors import PoseError
from app.science.optimal.posing.profile import climbed_m, smoothed, thinned
from app.science.optimal.problem import Road

STEEPEST, STEEP = 0.5, 0.2
FASTEST_MPS = 150.0
COARSER = 1.25
KMH = 3.6


@dataclass(frozen=True, slots=True)
class Cleaning:
    """How a road is cleaned.

    Attributes
    ----------
    smooth_m : float
        Standard deviation of the Gaussian that heights are averaged with; 0 for heights that need none.
    tolerance_m : float
        Points are left out where straight lines miss no height by more.
    limit_tolerance_mps : float
        Neighbouring limits that differ by less become one, the higher.
    most_points : int
        The tolerance grows until there are no more.
    longest_gap_m : float
        Neighbouring points further apart are a gap, which is refused.
    nearest_m : float
        Points nearer to the one before are left out.
    """

    smooth_m: float = 0.0
    tolerance_m: float = 0.25
    limit_tolerance_mps: float = 0.3
    most_points: int = 2000
    longest_gap_m: float = 2000.0
    nearest_m: float = 0.5


AS_GIVEN = Cleaning()


@dataclass(frozen=True, slots=True)
class PosedRoad:
    """A road that a problem can take, and how it came about.

    Attributes
    ----------
    road : Road
        Distances begin at 0.
    notes : tuple of str
    from_speed_mps, to_speed_mps, time_s : float or None
        As it was driven, where that is known.
    """

    road: Road
    notes: tuple[str, ...]
    from_speed_mps: float | None = None
    to_speed_mps: float | None = None
    time_s: float | None = None

    @property
    def length_m(self) -> float:
        """Length, m."""
        return self.road.distance_m[-1] - self.road.distance_m[0]

    def road_document(self) -> dict[str, list[float]]:
        """Return the ``road`` of a problem."""
        return {
            "distance_m": list(self.road.distance_m),
            "elevation_m": list(self.road.elevation_m),
            "speed_limit_mps": list(self.road.speed_limit_mps),
        }

    def document(self) -> dict[str, Any]:
        """Return the road with all that is known about it."""
        return {
            "road": self.road_document(),
            "length_m": self.length_m,
            "points": len(self.road.distance_m),
            "climb_m": climbed_m(np.array(self.road.elevation_m)),
            "from_speed_mps": self.from_speed_mps,
            "to_speed_mps": self.to_speed_mps,
            "time_s": self.time_s,
            "notes": list(self.notes),
        }


def clean_road(
    distance_m: FloatArray, elevation_m: FloatArray, speed_limit_mps: FloatArray, cleaning: Cleaning = AS_GIVEN
) -> PosedRoad:
    """Make a road of measured points.

    Parameters
    ----------
    distance_m : array, shape (n,)
        Along the road, in order.
    elevation_m : array, shape (n,)
        NaN where unknown.
    speed_limit_mps : array, shape (n,)
        Each holds from its point up to the next.
    cleaning : Cleaning

    Raises
    ------
    PoseError
        When points are missing over a long way, no height is known, a limit isn't above 0, or the road is steeper than
        50 %: with the place.
    """
    s, z, limit = _in_order(distance_m, elevation_m, speed_limit_mps, cleaning)
    notes: list[str] = []
    _no_gaps(s, z, cleaning.longest_gap_m)
    z = _filled(s, z, notes)
    fine_s, fine_z = smoothed(s, z, cleaning.smooth_m)
    if cleaning.smooth_m > 0.0:
        moved = np.interp(s, fine_s, fine_z) - z
        notes.append(
            f"Heights are averaged over distance by a Gaussian of {cleaning.smooth_m:g} m; that moved them by "
            f"{float(np.sqrt(np.mean(moved**2))):.2g} m rms, {float(np.abs(moved).max()):.2g} m at most."
        )
    starts, steps = _steps(s, limit, cleaning.limit_tolerance_mps)
    every = np.unique(np.concatenate((fine_s, starts)))
    heights = np.interp(every, fine_s, fine_z)
    kept, tolerance = _few(every, heights, np.isin(every, starts), cleaning)
    if tolerance is not None:
        notes.append(f"{len(kept)} of {every.size} points are left; no height is off by more than {tolerance:.2g} m.")
    every, heights = every[kept], heights[kept]
    _not_too_steep(every, heights, notes)
    holding = steps[np.searchsorted(starts, every, side="right") - 1]
    road = Road(tuple(every.tolist()), tuple(heights.tolist()), tuple(holding.tolist()))
    return PosedRoad(road, tuple(notes))


def _in_order(
    distance_m: FloatArray, elevation_m: FloatArray, limit_mps: FloatArray, cleaning: Cleaning
) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Return the points from distance 0 on, without those that stand still; of their limits the lowest holds."""
    s, z, limit = (np.asarray(values, dtype=np.float64) for values in (distance_m, elevation_m, limit_mps))
    if not s.shape == z.shape == limit.shape or s.ndim != 1:
        counts = f"{s.size}, {z.size} and {limit.size}"
        raise PoseError(f"Distances, heights and limits must be equally many; there are {counts}.")
    if s.size < 2 or not np.isfinite(s).all():
        raise PoseError("A road needs two points at least, and each needs a distance.")
    back = np.flatnonzero(np.diff(s) < -cleaning.nearest_m)
    if back.size:
        k = int(back[0])
        raise PoseError(f"Point {k + 2} lies at {s[k + 1]:.1f} m, before the {s[k]:.1f} m of the point before it.")
    bad = np.flatnonzero(~((limit > 0.0) & (limit <= FASTEST_MPS)))
    if bad.size:
        k = int(bad[0])
        raise PoseError(f"The speed limit at {s[k] - s[0]:.0f} m is {limit[k]:g} m/s; it must be above 0.")
    kept = [0]
    for k in range(1, s.size):
        if s[k] - s[kept[-1]] >= cleaning.nearest_m:
            kept.append(k)
    if len(kept) < 2:
        raise PoseError(f"The road is {s[-1] - s[0]:.2g} m long; nothing can be driven on it.")
    rows = np.array(kept)
    lowest = np.minimum.reduceat(limit, rows)
    return s[rows] - s[0], z[rows], lowest


def _no_gaps(s: FloatArray, z: FloatArray, longest_m: float) -> None:
    step = np.diff(s)
    k = int(step.argmax())
    if step[k] > longest_m:
        height = f", and the height differs by {z[k + 1] - z[k]:.0f} m" if np.isfinite(z[k : k + 2]).all() else ""
        raise PoseError(
            f"From {s[k]:.0f} m to {s[k + 1]:.0f} m the road has no points for {step[k]:.0f} m{height}; "
            f"{longest_m:.0f} m are allowed. Fill the gap in, split the road there, or allow longer ones."
        )


def _filled(s: FloatArray, z: FloatArray, notes: list[str]) -> FloatArray:
    """Return heights with straight lines where they are missing."""
    known = np.isfinite(z)
    if known.all():
        return z
    if not known.any():
        raise PoseError("No height is known anywhere; give an elevation model, or say that the road is level.")
    filled = np.interp(s, s[known], z[known])
    edges = np.diff(np.concatenate(([False], ~known, [False])).astype(np.int8))
    begins, ends = np.flatnonzero(edges == 1), np.flatnonzero(edges == -1)
    lengths = s[np.minimum(ends, s.size - 1)] - s[np.maximum(begins - 1, 0)]
    k = int(lengths.argmax())
    notes.append(
        f"Heights are missing at {int((~known).sum())} of {s.size} points and are taken from straight lines; the "
        f"longest such stretch, {lengths[k]:.0f} m, begins at {s[max(begins[k] - 1, 0)]:.0f} m."
    )
    return filled


def _steps(s: FloatArray, limit: FloatArray, tolerance: float) -> tuple[FloatArray, FloatArray]:
    """Join neighbouring limits that hardly differ; of those the highest holds, so none is made stricter."""
    starts, values = [s[0]], [limit[0]]
    low = limit[0]
    for k in range(1, s.size - 1):
        low, high = min(low, limit[k]), max(values[-1], limit[k])
        if high - low <= tolerance:
            values[-1] = high
        else:
            starts.append(s[k])
            values.append(limit[k])
            low = limit[k]
    return np.array(starts), np.array(values)


def _few(s: FloatArray, z: FloatArray, marked: BoolArray, cleaning: Cleaning) -> tuple[IntArray, float | None]:
    """Leave points out; the tolerance is None where none had to go."""
    tolerance = cleaning.tolerance_m
    kept = thinned(s, z, tolerance, marked)
    while kept.size > max(cleaning.most_points, int(marked.sum()) + 2) and tolerance < 100.0:
        tolerance *= COARSER
        kept = thinned(s, z, tolerance, marked)
    return kept, tolerance if kept.size < s.size else None


def _not_too_steep(s: FloatArray, z: FloatArray, notes: list[str]) -> None:
    slope = np.diff(z) / np.diff(s)
    k = int(np.abs(slope).argmax())
    way = "rises" if slope[k] > 0.0 else "falls"
    words = f"From {s[k]:.0f} m to {s[k + 1]:.0f} m the road {way} by {100.0 * abs(slope[k]):.0f} m per 100 m"
    if abs(slope[k]) > STEEPEST:
        raise PoseError(f"{words}; allowed is 50. The heights may be wrong there; smooth them over a longer distance.")
    if abs(slope[k]) > STEEP:
        notes.append(f"{words}; roads seldom do. The heights may need more smoothing.")
