"""Windows of several trips together, and their averages over some seconds."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from app.science.arrays import BoolArray, FloatArray, IntArray
from app.science.roadload.evidence import KEPT, RoadLoadEvidence, Source

MOST_WINDOWS = 8000
"""Six hours: more hardly change the answer, so that of more only every second, third… group of each trip is taken."""
GROUP_S = 12.0
"""Windows are averaged over so long: the smoother blurs forces for a few seconds, which would look like less engine."""
CLUSTER_S = 60.0
"""Errors of windows further apart are independent: slopes come from altitudes with a memory of seconds."""
LONGEST_S = 1e6


@dataclass(frozen=True, slots=True)
class Pool:
    """Windows of all trips, arrays of shape (n,) sorted by trip and time, see `RoadLoadEvidence.kept`.

    ``trip`` is the number of the trip, ``group`` the number of the group among all.
    """

    engine_speed_radps: FloatArray
    input: FloatArray
    speed_mps: FloatArray
    speed_squared_m2ps2: FloatArray
    normal_mps2: FloatArray
    specific_force_mps2: FloatArray
    specific_force_sd_mps2: FloatArray
    source: IntArray
    trip: IntArray
    group: IntArray
    minute: IntArray

    @property
    def coasts(self) -> BoolArray:
        """Which windows roll with an open clutch."""
        return np.asarray(self.source == Source.COASTING)


@dataclass(frozen=True, slots=True)
class Grouped:
    """Rows averaged over each group by their weights, of which the group has the sum.

    Attributes
    ----------
    design, target, weights : array, shape (m, p), (m,), (m,)
    trip, minute : array, shape (m,)
    shares : array, shape (m, 4)
        Of the weight, by `Source`.
    """

    design: FloatArray
    target: FloatArray
    weights: FloatArray
    trip: IntArray
    minute: IntArray
    shares: FloatArray


def pooled(trips: Sequence[RoadLoadEvidence]) -> Pool:
    """Put trips together; where they have too many windows, take whole groups evenly from each."""
    every = -(-sum(len(trip.kept) for trip in trips) // MOST_WINDOWS)
    kept = np.concatenate([trip.kept for trip in trips]).astype(np.float64)
    trip = np.repeat(np.arange(len(trips)), [len(one.kept) for one in trips])
    t_s = kept[:, KEPT.index("t_s")]
    chosen = (t_s // GROUP_S + trip).astype(np.int64) % every == 0
    kept, trip, t_s = kept[chosen], trip[chosen], t_s[chosen]
    columns = {name: kept[:, k] for k, name in enumerate(KEPT) if name not in ("t_s", "source")}
    return Pool(
        **columns,
        source=kept[:, KEPT.index("source")].astype(np.int64),
        trip=trip,
        group=_numbered(trip, t_s, GROUP_S),
        minute=_numbered(trip, t_s, CLUSTER_S),
    )


def grouped(pool: Pool, design: FloatArray, target: FloatArray, weights: FloatArray) -> Grouped:
    """Average rows (n, p) and targets (n,) over groups; windows without weight don't count."""
    on = weights > 0.0
    w, group = weights[on], pool.group[on]
    starts = np.flatnonzero(np.diff(group, prepend=-1))
    sources = pool.source[on, None] == np.array(Source)
    rows = np.column_stack([design[on], target[on], sources]) * w[:, None]
    total = np.add.reduceat(w, starts) if len(starts) else w
    sums = (np.add.reduceat(rows, starts) if len(starts) else rows) / total[:, None]
    p = design.shape[1]
    return Grouped(sums[:, :p], sums[:, p], total, pool.trip[on][starts], pool.minute[on][starts], sums[:, p + 1 :])


def _numbered(trip: IntArray, t_s: FloatArray, length_s: float) -> IntArray:
    _, number = np.unique(trip * LONGEST_S + t_s // length_s, return_inverse=True)
    return np.asarray(number, dtype=np.int64)
