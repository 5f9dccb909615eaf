"""Does the filter deserve belief: each sensor's innovations against their own predicted spread."""

from __future__ import annotations

import numpy as np
from scipy.stats import chi2

from app.science.arrays import AnyArray, FloatArray
from app.science.observer.result import Innovations, Refusal, SensorConsistency
from app.science.observer.whiteness import whiteness

PASSED, BELIEVED_IN_THE_END = 1, 2
BAND = 0.95
ONE_EPISODE_WITHIN_S = 1.0
MOST_EPISODES = 60


def consistency(innovations: Innovations) -> tuple[SensorConsistency, ...]:
    """Return one entry per sensor that gave measurements."""
    order = np.argsort(innovations.sensor, kind="stable")
    edges = np.searchsorted(innovations.sensor[order], np.arange(len(innovations.sensors) + 1))
    return tuple(
        _of_one(name, *(column[order[first:last]] for column in _columns(innovations)))
        for name, first, last in zip(innovations.sensors, edges[:-1], edges[1:], strict=True)
        if last > first
    )


def _columns(innovations: Innovations) -> tuple[FloatArray, AnyArray, AnyArray, AnyArray]:
    return innovations.t_s, innovations.innovation, innovations.sd, innovations.accepted


def _of_one(name: str, t_s: FloatArray, innovation: AnyArray, sd: AnyArray, accepted: AnyArray) -> SensorConsistency:
    passed = accepted == PASSED
    count, used = len(t_s), int(np.count_nonzero(passed))
    episodes = refusals(t_s, accepted)
    numbers: dict[str, float] = {}
    if used:
        normalised = (innovation[passed] / sd[passed]).astype(np.float64)
        white = whiteness(normalised)
        low, high = nis_band(white.independent_squares)
        numbers = {
            "nis_low": low,
            "nis_high": high,
            "effective_count": white.independent_squares,
            "within_one_sigma": float(np.mean(np.abs(normalised) <= 1.0)),
            "lag1": white.lag1,
            "portmanteau": white.portmanteau,
            "bias": float(np.mean(normalised)),
            "bias_sd": float(np.std(normalised) / np.sqrt(white.independent)),
        }
    return SensorConsistency(
        sensor=name,
        count=count,
        rejected=count - used,
        nis_mean=float(np.mean(normalised**2)) if used else float("nan"),
        within_two_sigma=float(np.mean(np.abs(normalised) <= 2.0)) if used else float("nan"),
        recovered=int(np.count_nonzero(accepted == BELIEVED_IN_THE_END)),
        episodes=_longest(episodes),
        episode_count=len(episodes),
        longest_refusal_s=max((one.to_s - one.from_s for one in episodes), default=0.0),
        **numbers,
    )


def nis_band(independent: float) -> tuple[float, float]:
    """Return where 95 % of mean normalised innovations squared lie, of so many independent ones of a right filter."""
    tail = 0.5 * (1.0 - BAND)
    low, high = chi2.ppf([tail, 1.0 - tail], independent) / independent
    return float(low), float(high)


def refusals(t_s: FloatArray, accepted: AnyArray) -> tuple[Refusal, ...]:
    """Return the episodes in which a sensor's measurements were refused, in order of time.

    Neighbours in the sensor's own order are of one episode, and so are refusals less than a second apart.

    Parameters
    ----------
    t_s, accepted : array, shape (n,)
        As of `Innovations`, of one sensor.
    """
    refused = np.flatnonzero(accepted != PASSED)
    if not len(refused):
        return ()
    apart = (np.diff(refused) > 1) & (np.diff(t_s[refused]) > ONE_EPISODE_WITHIN_S)
    parts = np.split(refused, np.flatnonzero(apart) + 1)
    return tuple(
        Refusal(
            float(t_s[part[0]]), float(t_s[part[-1]]), len(part), bool(np.any(accepted[part] == BELIEVED_IN_THE_END))
        )
        for part in parts
    )


def _longest(episodes: tuple[Refusal, ...]) -> tuple[Refusal, ...]:
    kept = sorted(episodes, key=lambda one: (one.to_s - one.from_s, one.count), reverse=True)[:MOST_EPISODES]
    return tuple(sorted(kept, key=lambda one: one.from_s))
