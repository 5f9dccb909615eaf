"""Drag and rolling resistance together with the engine, by robust least squares with a prior."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from app.science.arrays import FloatArray, IntArray
from app.science.roadload.engines import DRAG, ROAD, ROLLING, Engine, FuelEngine, Normal, Rows, TorqueEngine
from app.science.roadload.evidence import RoadLoadEvidence
from app.science.roadload.pool import Grouped, Pool, grouped, pooled
from app.science.roadload.priors import Priors
from app.science.vehicle.model import Vehicle

ROUNDS = 7
SMOOTHED = (2, 5)
"""Rounds before which the engine's smoothness is chosen anew."""
HUBER_SDS, COAST_SDS = 2.0, 3.0
MAD_TO_SD, LEAST_SCALE = 1.4826, 0.1
NOTHING = 1e-30
"""In place of a variance of nought, where no window is left."""
TRIPS_THAT_DISAGREE = 5
"""So many trips can tell that they scatter more than they should."""
MODEL_SD = (0.01, 0.03)
"""Of drag and rolling resistance, in parts: what virtual cars were off beyond the scatter of their own minutes."""
TOLD = (0, DRAG, ROLLING)


@dataclass(frozen=True, slots=True)
class Solution:
    """The engine's first coefficient, drag and rolling resistance, these two over the file's.

    Attributes
    ----------
    value, covariance : array, shape (3,), (3, 3)
    shares : array, shape (2, 5)
        Of the information on drag and rolling resistance: the prior's, then by `Source`.
    coasting : float
        Share of the coasting windows in which nobody braked; 0 without any.
    """

    value: FloatArray
    covariance: FloatArray
    shares: FloatArray
    coasting: float


def solve(trips: Sequence[RoadLoadEvidence], vehicle: Vehicle, priors: Priors) -> Solution:
    """Solve for engine and road together; the data's share is weakened to what its scatter shows.

    Parameters
    ----------
    trips : sequence of RoadLoadEvidence
        At least one, all by the same model of the engine.
    vehicle : Vehicle
        As the trips were observed with.
    priors : Priors
    """
    pool = pooled(trips)
    engine: Engine = (FuelEngine if trips[0].model == "fuel" else TorqueEngine)(pool, vehicle)
    mean = np.concatenate([engine.mean, np.ones(ROAD)])
    precision = np.concatenate([engine.precision, priors.road_precision])
    smooth, value = engine.smoothing(None), None
    for number in range(ROUNDS):
        rows = engine.rows(value)
        weights = _weights(rows, pool, value)
        groups = grouped(pool, rows.design, rows.target, weights)
        normal = _normal(groups)
        smooth = engine.smoothing(normal) if number in SMOOTHED else smooth
        value = np.linalg.solve(normal.gram + smooth + np.diag(precision), normal.right + precision * mean)
    return _told(trips, groups, normal, smooth, precision, mean, _rolled(pool, weights))


def _weights(rows: Rows, pool: Pool, value: FloatArray | None) -> FloatArray:
    """Return weights: Huber's for driving, and coasting only where nobody brakes."""
    coasts = pool.coasts
    if value is None:
        return np.where(rows.counts & ~coasts, 1.0 / rows.variance, 0.0)
    apart = np.abs(rows.target - rows.design @ value) / np.sqrt(rows.variance)
    driven = rows.counts & ~coasts
    scale = max(MAD_TO_SD * float(np.median(apart[driven])), LEAST_SCALE) if driven.any() else 1.0
    huber = np.minimum(1.0, HUBER_SDS * scale / np.maximum(apart, LEAST_SCALE))
    rolled = max(scale, 1.0)
    coasting = (apart < COAST_SDS * rolled) / rolled**2
    weights = np.where(coasts, coasting, huber / scale**2) / rows.variance
    return np.where(rows.counts, weights, 0.0)


def _normal(groups: Grouped) -> Normal:
    weighted = groups.design * groups.weights[:, None]
    squares = float(groups.weights @ groups.target**2)
    return Normal(weighted.T @ groups.design, weighted.T @ groups.target, squares, len(groups.target))


def _rolled(pool: Pool, weights: FloatArray) -> float:
    coasts = pool.coasts
    return float(np.mean(weights[coasts] > 0.0)) if coasts.any() else 0.0


def _told(
    trips: Sequence[RoadLoadEvidence],
    groups: Grouped,
    normal: Normal,
    smooth: FloatArray,
    precision: FloatArray,
    mean: FloatArray,
    coasting: float,
) -> Solution:
    prior = np.diag(precision)
    doubt = _doubt(groups, normal, smooth, prior, precision * mean)
    inverse: FloatArray = np.asarray(np.linalg.inv((normal.gram + smooth) / doubt + prior), dtype=np.float64)
    value = inverse @ (normal.right / doubt + precision * mean)
    covariance = inverse[np.ix_(TOLD, TOLD)] * _disagreement(trips, groups, value, inverse[[DRAG, ROLLING]] / doubt)
    offset = sum((trip.offset_sd * trip.seconds) ** 2 for trip in trips) / sum(trip.seconds for trip in trips) ** 2
    covariance[ROLLING, ROLLING] += offset + MODEL_SD[ROLLING] ** 2
    covariance[DRAG, DRAG] += MODEL_SD[DRAG] ** 2
    total = (normal.gram + smooth) / doubt + prior
    shares = [_shares(groups, total, precision, doubt, len(total) + at) for at in (DRAG, ROLLING)]
    return Solution(value[list(TOLD)], covariance, np.array(shares), coasting)


def _doubt(groups: Grouped, normal: Normal, smooth: FloatArray, prior: FloatArray, pull: FloatArray) -> float:
    """Return by how much rows scatter more than their weights promise, one by one or in whole minutes; at least 1."""
    inverse = np.linalg.inv(normal.gram + smooth + prior)
    residual = groups.target - groups.design @ (inverse @ (normal.right + pull))
    free = max(normal.count - float(np.sum(inverse * normal.gram)), 1.0)
    alone = float(groups.weights @ residual**2) / free
    rows: FloatArray = np.asarray(inverse[[DRAG, ROLLING]], dtype=np.float64)
    promised = np.sum((rows @ normal.gram) * rows, axis=1) + NOTHING
    return max(float(np.mean(_by(groups.minute, groups, residual, rows) / promised)), alone, 1.0)


def _by(number: IntArray, groups: Grouped, residual: FloatArray, rows: FloatArray) -> FloatArray:
    """Return the sums of squares of what all rows of one number pull drag and rolling resistance by, shape (2,)."""
    pulls = (groups.design @ rows.T) * (groups.weights * residual)[:, None]
    return np.array([np.sum(np.bincount(number, pull) ** 2) for pull in pulls.T])


def _disagreement(trips: Sequence[RoadLoadEvidence], groups: Grouped, value: FloatArray, rows: FloatArray) -> float:
    """Return by how much the trips' pulls on drag and rolling resistance exceed what their minutes promise; at least 1.

    Wind, rain and tyres change from trip to trip, not from minute to minute.
    """
    if len(trips) < TRIPS_THAT_DISAGREE:
        return 1.0
    residual = groups.target - groups.design @ value
    promised = _by(groups.minute, groups, residual, rows) + NOTHING
    return max(float(np.mean(_by(groups.trip, groups, residual, rows) / promised)), 1.0)


def _shares(groups: Grouped, total: FloatArray, precision: FloatArray, doubt: float, at: int) -> FloatArray:
    """Return whose information a coefficient rests on, the prior first, after the others have taken their part.

    Parameters
    ----------
    groups : Grouped
    total : array, shape (p, p)
        Of data, smoothness and prior.
    precision : array, shape (p,)
        Of the prior.
    doubt : float
    at : int
        Which coefficient.
    """
    rest = np.arange(len(total)) != at
    along = np.zeros(len(total))
    along[at] = 1.0
    along[rest] = -np.linalg.solve(total[np.ix_(rest, rest)], total[rest, at])
    data = (groups.weights * (groups.design @ along) ** 2) @ groups.shares / doubt
    prior = float(along**2 @ precision)
    return np.asarray(np.concatenate([[prior], data]) / (prior + data.sum()))
