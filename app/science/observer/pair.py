"""One pair block as a whole: its events, filter and smoother, at the nodes."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from app.science.arrays import FloatArray
from app.science.errors import EstimatorDiverged
from app.science.observer.engine_events import Part, merged
from app.science.observer.family.chain import filter_chain
from app.science.observer.pair_kernels import PAIR_LEVEL, PAIR_RATE, filter_pair
from app.science.observer.result import Innovations

START_RATE_VARIANCE = 1e12


@dataclass(frozen=True, slots=True)
class PairResult:
    """A level and its rate at the nodes; NaN where no sensor tells.

    Attributes
    ----------
    state, variance : array, shape (nodes, 2)
    innovations : Innovations or None
        None without any measurement.
    told_from_s, told_to_s : float
        Times of the first and the last measurement; NaN without any.
    """

    state: FloatArray
    variance: FloatArray
    innovations: Innovations | None
    told_from_s: float
    told_to_s: float


def observe_pair(
    parts: list[Part], node_t_s: FloatArray, q: Sequence[float], names: tuple[str, str], *, smooth: bool
) -> PairResult:
    """Filter and, if asked, smooth a quantity and its rate.

    Parameters
    ----------
    parts : list of Part
        Measurements, as `fuel_events` and `engine_speed_events` give them.
    node_t_s : array, shape (nodes,)
    q : sequence of float
        Spectral densities of the process noise: of the level, the rate, and of what a local polynomial model of the
        rate adds.
    names : (str, str)
        Sensor names of the level's and the rate's measurements.

    Raises
    ------
    EstimatorDiverged
        When a number stops being finite.
    """
    nodes = len(node_t_s)
    unknown = np.full((nodes, 2), np.nan)
    if not any(len(part[0]) for part in parts):
        return PairResult(unknown, unknown, None, np.nan, np.nan)
    t, kind, y, r = merged(parts, node_t_s)
    # nothing is known of a level before a recording that begins with its first measurement
    start_level_variance = 1.0 + float(y[0]) ** 2 if kind[0] == PAIR_LEVEL else 1.0
    innovation, innovation_sd = np.zeros(len(t)), np.zeros(len(t))
    state, variance = np.empty((nodes, len(q))), np.empty((nodes, len(q)))
    if len(q) == len(names):
        failed = filter_pair(
            t, kind, y, r, q[0], q[1], start_level_variance, START_RATE_VARIANCE, smooth,
            innovation, innovation_sd, state, variance,
        )  # fmt: skip
    else:
        start_variance = np.array([start_level_variance] + [START_RATE_VARIANCE] * (len(q) - 1))
        failed = filter_chain(
            t, kind, y, r, np.array(q), start_variance, smooth, innovation, innovation_sd, state, variance
        )
    if failed >= 0:
        raise EstimatorDiverged(
            f"The filter of {names[1]} stopped being finite at {t[failed]:.2f} s; look at the measurements just "
            "before it and the tuning.",
            float(t[failed]),
        )
    told = (kind == PAIR_LEVEL) | (kind == PAIR_RATE)
    which = (kind[told] == PAIR_RATE).astype(np.int8)
    innovations = Innovations(
        t[told], which, innovation[told], innovation_sd[told], np.ones(len(which), np.int8), names
    )
    return PairResult(state[:, :2], variance[:, :2], innovations, float(t[told][0]), float(t[told][-1]))
