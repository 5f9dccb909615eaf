"""The motion block through a filter of choice."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from app.science.arrays import AnyArray, FloatArray
from app.science.errors import TooLittleData, TuningError
from app.science.observer import motion
from app.science.observer.events import MotionEvents
from app.science.observer.family.correct import holds_root
from app.science.observer.family.filter import filter_family
from app.science.observer.family.methods import (
    FILTERS,
    HIGH_GAIN,
    Adaptation,
    Checkpoints,
    Events,
    Gates,
    Results,
    SigmaSpread,
    family_start,
    sigma_spread,
    work_space,
)
from app.science.observer.family.smoother import adjoint_start, smooth_family
from app.science.observer.motion_kernels import ALTITUDE, ROAD_ALTITUDE, SIZE, MotionModel
from app.science.observer.tuning import Tuning
from app.science.progress import Progress, between, silent

CHECKPOINT_EVERY = 256
STRETCHES_AT_ONCE = 32
FILTER_SHARE = 0.4
THRUST_SLOPE_VARIANCE = 1e6


@dataclass(frozen=True, slots=True)
class Choice:
    """A filter with its numbers.

    Attributes
    ----------
    method : int
        One of `methods.FILTERS`.
    spread : SigmaSpread
    adaptation : Adaptation
    """

    method: int
    spread: SigmaSpread
    adaptation: Adaptation


class StoppedAt(Exception):  # noqa: N818 - the caller says what it means
    """The filter stopped at this event, whose time it holds."""

    def __init__(self, t_s: float) -> None:
        super().__init__(t_s)
        self.t_s = t_s


def run_family(
    choice: Choice,
    events: MotionEvents,
    model: MotionModel,
    x0: FloatArray,
    variance0: FloatArray,
    gates: tuple[FloatArray, AnyArray, FloatArray],
    nodes: int,
    *,
    smooth: bool,
    progress: Progress = silent,
) -> Results:
    """Filter and, if asked, smooth the motion block over n states.

    Parameters
    ----------
    choice : Choice
    events : MotionEvents
    model : MotionModel
        With n entries in ``q``.
    x0, variance0 : array, shape (n,)
    gates : (array, array, array)
        As `motion.gates` gives them.
    nodes : int
    smooth : bool
    progress : Progress

    Raises
    ------
    StoppedAt
        When a number stops being finite or a covariance positive definite.
    """
    method, count, size = choice.method, len(events.t_s), len(x0)
    scalar = Events(events.t_s, events.kind, events.y.copy(), events.r, events.gear, events.boosted)
    limits, work = Gates(*gates), work_space(size)
    stretches = (count - 1) // CHECKPOINT_EVERY + 1
    kept = Checkpoints(CHECKPOINT_EVERY, np.empty((stretches, size)), np.empty((stretches, size, size)))
    results = Results(
        np.zeros(count, np.float32), np.zeros(count, np.float32), np.zeros(count, np.int8), np.ones(count, np.float32),
        np.empty((nodes, size)), np.empty((nodes, size)),
    )  # fmt: skip
    start = np.diag(np.sqrt(variance0) if holds_root(method) else variance0)
    state = family_start(x0, start, float(events.t_s[0]) if count else 0.0, len(limits.squared))
    at_once = CHECKPOINT_EVERY * STRETCHES_AT_ONCE
    forwards = between(progress, 0.0, FILTER_SHARE if smooth else 1.0)
    for first in range(0, count, at_once):
        forwards(first / count)
        failed = filter_family(
            method, scalar, model, variance0, limits, choice.spread, choice.adaptation, work, kept, results, state,
            first, min(first + at_once, count),
        )  # fmt: skip
        if failed >= 0:
            raise StoppedAt(float(events.t_s[failed]))
    if smooth:
        backwards = between(progress, FILTER_SHARE, 1.0)
        adjoint = adjoint_start(size, nodes)
        for last in range(stretches, 0, -STRETCHES_AT_ONCE):
            backwards(1.0 - last / stretches)
            smooth_family(
                method, scalar, model, variance0, limits, choice.spread, work, kept, results, adjoint,
                max(last - STRETCHES_AT_ONCE, 0), last,
            )  # fmt: skip
    return results


def observe_motion_with(
    name: str,
    events: MotionEvents,
    model: MotionModel,
    tuning: Tuning,
    x0: FloatArray,
    variance0: FloatArray,
    nodes: int,
    *,
    smooth: bool,
    progress: Progress = silent,
) -> motion.MotionResult:
    """Do what `motion.observe_motion` does with a filter of choice, and with the tuning's local models of the thrust.

    Raises
    ------
    EstimatorDiverged
        With the time at which the filter broke.
    TooLittleData
        When the adaptive high-gain filter has no altitude.
    TuningError
        When the tuning's model of the thrust doesn't fit the filter.
    """
    choice = choose(name, tuning, len(model.q))
    if choice.method == HIGH_GAIN:
        _require_normal_form(events, tuning)
    slopes = len(model.q) - SIZE
    x0, variance0 = np.append(x0, np.zeros(slopes)), np.append(variance0, np.full(slopes, THRUST_SLOPE_VARIANCE))
    try:
        results = run_family(
            choice, events, model, x0, variance0, motion.gates(), nodes, smooth=smooth, progress=progress
        )
    except StoppedAt as stopped:
        raise motion.diverged(stopped.t_s) from None
    innovations = motion.innovations_of(events, results.innovation, results.sd, results.outcome)
    return motion.MotionResult(results.node_x[:, :SIZE], results.node_variance[:, :SIZE], innovations)


def choose(name: str, tuning: Tuning, n: int) -> Choice:
    """Return a filter by its name, with the tuning's numbers, for n states."""
    spread = sigma_spread(n, tuning.ukf_alpha, tuning.ukf_beta, tuning.ukf_kappa)
    adaptation = Adaptation(tuning.aekf_upper, tuning.aekf_lower, tuning.aekf_window_s, tuning.aekf_gain_max)
    return Choice(FILTERS[name], spread, adaptation)


def _require_normal_form(events: MotionEvents, tuning: Tuning) -> None:
    if tuning.thrust_order > 1:
        raise TuningError("thrust_order: the normal form of aekf is that of order 1; use another filter.")
    if not np.isin(events.kind, (ALTITUDE, ROAD_ALTITUDE)).any():
        raise TooLittleData(
            "The adaptive high-gain filter (aekf) needs altitude, from GPS or from an elevation table: without one its "
            "normal form doesn't exist. Use another filter."
        )
