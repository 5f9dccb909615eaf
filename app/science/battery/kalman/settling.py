"""One stretch filtered until nothing about it changes: linearised anew where it was far off, noise as it shows."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from app.science.arrays import FloatArray
from app.science.battery.kalman.belief import Belief
from app.science.battery.kalman.layout import BIAS, LN_CAPACITY, PARAMETERS, RELAXATION_V, SOC
from app.science.battery.kalman.residuals import Level, level_of
from app.science.battery.kalman.stretch import GATE, ITSELF, Ground, by_points, follow

TRIES = 8
FAR_LOG, FAR_SOC = 0.02, 0.01
"""From where on a correction is too large for one linearisation: of a parameter's logarithm, of the charge."""
NEAR = 0.1
"""Shares of a standard deviation by which the trajectory to linearise about may still move."""
NEAR_LEVEL = 0.05
"""Share by which the noise may still change."""
REACH = 3.0
"""The trajectory to linearise about stays within so many standard deviations of what was believed before."""
GUESSES = np.linspace(-2.0, 2.0, 9)
"""Where to look for the charge to begin with, in standard deviations of what is believed about it."""
GUESS_WIDTH = 0.5
UNSURE_SOC = 0.03
"""From which standard deviation of the charge on it is looked for in several places."""
LOOK_ROWS = 3600
OTHERS = 4
"""So many of these places are tried to the end where the likeliest one leaves a contradiction."""
CONTRADICTED = 3.0
"""From this colour of the residuals on, the data contradict what was found."""


@dataclass(frozen=True, slots=True)
class Settled:
    """A stretch that is done: what is believed after it, and how noisy its voltage was."""

    belief: Belief
    level: Level


def settle(ground: Ground, first: int, last: int, belief: Belief, level: Level, walks: FloatArray) -> Settled:
    """Filter a stretch, again about what was found where one linearisation is too coarse.

    Parameters
    ----------
    ground : Ground
    first, last : int
        First row and the row after the last.
    belief : Belief
        Before the first row.
    level : Level
        Noise of the voltage to begin with.
    walks : ndarray (7,)
        By how much variances grow on their own, per second.

    Returns
    -------
    Settled
    """
    starts = _looked_for(ground, first, last, belief, level, walks)
    settled = _settle_from(ground, first, last, belief, level, walks, starts[0])
    if len(starts) == 1 or settled.level.colour <= CONTRADICTED:
        return settled
    # What is left over contradicts the model. That may be the model's fault, or it was looked in the wrong place.
    best, likeliest = starts[0], _likelihood(ground, first, last)
    for start in (ITSELF, *starts[1:OTHERS]):
        _settle_from(ground, first, last, belief, level, walks, start)
        likelihood = _likelihood(ground, first, last)
        if likelihood > likeliest:
            best, likeliest = start, likelihood
    return _settle_from(ground, first, last, belief, level, walks, best)


def _settle_from(
    ground: Ground,
    first: int,
    last: int,
    belief: Belief,
    level: Level,
    walks: FloatArray,
    nominal: FloatArray,
) -> Settled:
    after = follow(ground, first, last, belief, level, walks, nominal)
    about = nominal if len(nominal) else belief.mean
    for _ in range(TRIES):
        new = _level(ground, first, last, level)
        once = by_points(ground, belief) or (len(nominal) == 0 and _sure(belief, after))
        found = about if once else _start(ground, first, last, belief, after)
        moved = np.abs(found - about)
        small = len(nominal) == 0 and np.all(moved[:PARAMETERS] < FAR_LOG) and moved[SOC] < FAR_SOC
        near = np.all(moved <= NEAR * np.sqrt(np.maximum(np.diag(after.covariance), 0.0)) + 1e-12)
        if (small or near) and _same(new, level):
            break
        level = new
        if not small:
            nominal = about = found
        after = follow(ground, first, last, belief, level, walks, nominal)
    return Settled(after, level)


def _likelihood(ground: Ground, first: int, last: int) -> float:
    """Return the logarithm of how likely the residuals are that a filter left behind, but for a constant."""
    residual, variance = ground.trace.residual_v[first:last], ground.trace.variance_v2[first:last]
    seen = np.isfinite(residual)
    far = np.abs(residual[seen]) / np.sqrt(variance[seen])
    # As they are weighed by the filter: squares up to the gate, beyond it straight on.
    costs = np.where(far < GATE, far**2, GATE * (2.0 * far - GATE))
    return float(-0.5 * np.sum(costs + np.log(variance[seen])))


def _sure(before: Belief, after: Belief) -> bool:
    """Tell whether all was known so well before that one linearisation does, and nothing has moved far."""
    sd, moved = np.sqrt(np.maximum(np.diag(before.covariance), 0.0)), np.abs(after.mean - before.mean)
    known = np.all(sd[:PARAMETERS] < 0.25 * FAR_LOG) and sd[SOC] < 0.25 * FAR_SOC
    return bool(known and np.all(moved[:PARAMETERS] < FAR_LOG))


def _same(one: Level, other: Level) -> bool:
    return bool(
        abs(np.log(one.variance_v2 / other.variance_v2)) < NEAR_LEVEL and abs(np.log(one.colour / other.colour)) < 0.2
    )


def _level(ground: Ground, first: int, last: int, assumed: Level) -> Level:
    if last <= ground.learn_from:
        return assumed
    residual, variance = ground.trace.residual_v[first:last], ground.trace.variance_v2[first:last]
    if ground.gaps:
        seen = np.isfinite(residual)
        residual, variance = residual[seen], variance[seen]
    return level_of(residual, variance, assumed, ground.least_v2)


def _start(ground: Ground, first: int, last: int, before: Belief, after: Belief) -> FloatArray:
    """Return where the stretch began as seen from its end; the relaxation voltage, soon forgotten, as believed."""
    start = after.mean.copy()
    end = min(last, len(ground.rows.t_s) - 1)
    steps = np.diff(ground.rows.t_s[first : end + 1])
    factor = ground.rows.capacity_factor
    shares = steps / (factor[first:end] if len(factor) > 1 else factor[0])
    moved = np.sum((ground.rows.current_a[first:end] - start[BIAS]) * shares) / np.exp(start[LN_CAPACITY])
    start[SOC] -= moved
    start[RELAXATION_V] = before.mean[RELAXATION_V]
    reach = REACH * np.sqrt(np.diag(before.covariance))
    return np.clip(start, before.mean - reach, before.mean + reach)


def _looked_for(
    ground: Ground, first: int, last: int, belief: Belief, level: Level, walks: FloatArray
) -> list[FloatArray]:
    """Return places for the stretch to begin at, the likeliest first; where the charge is known well, that there."""
    sd = float(np.sqrt(belief.covariance[SOC, SOC]))
    if first < ground.learn_from or sd < UNSURE_SOC:
        return [ITSELF]
    end = min(last, first + LOOK_ROWS)
    towards = belief.covariance[:, SOC] / sd
    narrowed = belief.covariance - (1.0 - GUESS_WIDTH**2) * np.outer(towards, towards)
    found: list[tuple[float, FloatArray]] = []
    for guess in GUESSES:
        after = follow(ground, first, end, Belief(belief.mean + guess * towards, narrowed), level, walks)
        likelihood = _likelihood(ground, first, end) - 0.5 * guess**2
        found.append((likelihood, _start(ground, first, end, belief, after)))
    return [start for _, start in sorted(found, key=lambda one: -one[0])]
