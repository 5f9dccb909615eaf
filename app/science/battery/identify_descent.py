"""The search behind identification: damped Gauss-Newton steps, and how much coloured residuals are worth."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from app.science.arrays import FloatArray
from app.science.battery.curve import CurvePieces
from app.science.battery.open_circuit_model import hats
from app.science.battery.run import Carry, CellRecord

FIRST_NOISE_V = 5e-3
"""Standard deviation of the residuals to set out with."""

LEAST_NOISE_V = 1e-4
"""Standard deviation that no sensor is better than."""

HUBER = 3.0
"""Multiples of the residuals' standard deviation from which on a row counts less."""

ROUNDS = 4
"""How often noise and colour are found again from the residuals."""

NEARLY = 1e-9
"""Share of its own variance by which each unknown is less sure than a covariance says, so that it can be inverted."""

CURVE_KNOTS = np.linspace(0.0, 1.0, 9)
"""States of charge between which an error of the curve changes along a straight line."""

STEPS = 60
SETTLED = 1e-7
"""Share by which a step improves the sum of squares when the search has ended."""


@dataclass(frozen=True, slots=True)
class Problem:
    """A record of one cell and what is thought of its seven unknowns, in the order of `Carry`."""

    record: CellRecord
    pieces: CurvePieces
    mean: FloatArray
    covariance: FloatArray
    information: FloatArray
    curve_sd_v: float = 0.0

    @classmethod
    def of(cls, record: CellRecord, pieces: CurvePieces, carry: Carry, curve_sd_v: float = 0.0) -> Problem:
        """Return the problem of a record, with what was known before it, and how far the curve may be off."""
        return cls(record, pieces, carry.mean, carry.covariance, _inverse(carry.covariance), curve_sd_v)


@dataclass(frozen=True, slots=True)
class Solution:
    """Unknowns (7,) with covariance (7, 7), at the first row and carried to the last one."""

    unknowns: FloatArray
    covariance: FloatArray
    last_mean: FloatArray
    last_covariance: FloatArray
    residual_v: FloatArray
    rows_together: float
    converged: bool


@dataclass(frozen=True, slots=True)
class _Weighting:
    noise_v: float
    rows_together: float


@dataclass(frozen=True, slots=True)
class _Point:
    unknowns: FloatArray
    residual_v: FloatArray
    slopes: FloatArray
    soc: FloatArray
    last: FloatArray


def solve(problem: Problem, starts: Sequence[FloatArray]) -> Solution:
    """Return the best explanation that is found from any of the starts."""
    weighting = _Weighting(FIRST_NOISE_V, 1.0)
    ended = [_descend(problem, start, weighting) for start in starts]
    point, converged = min(ended, key=lambda one: _cost(problem, one[0], weighting))
    for _ in range(ROUNDS):
        weighting = _weighting(point.residual_v)
        point, converged = _descend(problem, point.unknowns, weighting)
    covariance = _inverse(_normal(problem, point, weighting)[0] - _unknown_curve(problem, point, weighting))
    last_mean, to_last = point.unknowns.copy(), np.eye(len(point.unknowns))
    last_mean[4:6], to_last[4:6] = point.last[:, 0], point.last[:, 1:]
    return Solution(
        unknowns=point.unknowns,
        covariance=covariance,
        last_mean=last_mean,
        last_covariance=to_last @ covariance @ to_last.T,
        residual_v=point.residual_v,
        rows_together=weighting.rows_together,
        converged=converged,
    )


def rows_together(residual_v: FloatArray) -> float:
    """Return over how many rows residuals hang together: the sum of their autocorrelations, 1 for white noise.

    It is summed up to the first one that chance could make (Sokal 1997, integrated autocorrelation time).
    """
    left = residual_v[np.isfinite(residual_v)]
    left = left - left.mean()
    n = len(left)
    if n < 3 or not left.any():
        return 1.0
    power = np.abs(np.fft.rfft(left, 2 * n)) ** 2
    correlation = np.fft.irfft(power)[: n // 2]
    correlation = correlation / correlation[0]
    chance = np.flatnonzero(correlation < 2.0 / np.sqrt(n))
    end = chance[0] if len(chance) else len(correlation)
    return float(1.0 + 2.0 * correlation[1:end].sum())


def _weighting(residual_v: FloatArray) -> _Weighting:
    left = residual_v[np.isfinite(residual_v)]
    usual = 1.4826 * float(np.median(np.abs(left)))
    clipped = np.clip(residual_v, -HUBER * usual, HUBER * usual)
    return _Weighting(max(usual, LEAST_NOISE_V), rows_together(clipped))


def _descend(problem: Problem, start: FloatArray, weighting: _Weighting) -> tuple[_Point, bool]:
    point = _at(problem, start)
    cost, damping = _cost(problem, point, weighting), 1e-3
    for _ in range(STEPS):
        normal, downhill = _normal(problem, point, weighting)
        scale = np.diag(np.diag(normal))
        while damping < 1e8:
            step = np.linalg.solve(normal + damping * scale, downhill)
            tried = _at(problem, point.unknowns + np.clip(step, -1.0, 1.0))
            better = _cost(problem, tried, weighting)
            if better <= cost:
                break
            damping *= 8.0
        else:
            return point, True
        gained = (cost - better) / max(cost, 1e-12)
        point, cost, damping = tried, better, max(damping / 8.0, 1e-9)
        if gained < SETTLED:
            return point, True
    return point, False


def _at(problem: Problem, unknowns: FloatArray) -> _Point:
    # Compiled code is loaded only by who identifies: servers that show what was found don't.
    from app.science.battery.identify_kernels import sensitive_voltage
    from app.science.battery.simulate_kernels import RowFactors

    record = problem.record
    factors = RowFactors(record.resistance_factor, record.relaxation_factor, record.capacity_factor)
    voltage, slopes, soc, last = sensitive_voltage(problem.pieces, factors, unknowns, record.t_s, record.current_a)
    return _Point(unknowns, record.voltage_v - voltage, slopes, soc, last)


def _cost(problem: Problem, point: _Point, weighting: _Weighting) -> float:
    size = np.abs(point.residual_v[np.isfinite(point.residual_v)]) / weighting.noise_v
    huber = np.where(size <= HUBER, size**2, HUBER * (2.0 * size - HUBER))
    away = point.unknowns - problem.mean
    cost = float(huber.sum()) / weighting.rows_together + float(away @ problem.information @ away)
    return cost if np.isfinite(cost) else np.inf


def _normal(problem: Problem, point: _Point, weighting: _Weighting) -> tuple[FloatArray, FloatArray]:
    """Return the curvature (7, 7) and the way down (7,)."""
    rows = np.flatnonzero(np.isfinite(point.residual_v))
    residual, slopes = point.residual_v[rows], point.slopes[rows]
    weights = _weights(residual, weighting)
    known = problem.information
    normal = (slopes * weights[:, None]).T @ slopes + known
    return normal, slopes.T @ (weights * residual) + known @ (problem.mean - point.unknowns)


def _weights(residual_v: FloatArray, weighting: _Weighting) -> FloatArray:
    weights = 1.0 / np.maximum(np.abs(residual_v) / (HUBER * weighting.noise_v), 1.0)
    return np.asarray(weights / (weighting.noise_v**2 * weighting.rows_together))


def _unknown_curve(problem: Problem, point: _Point, weighting: _Weighting) -> FloatArray:
    """Return the curvature (7, 7) that is lost where the curve may be off by hats of a standard deviation each."""
    if problem.curve_sd_v <= 0.0:
        return np.zeros_like(problem.information)
    rows = np.flatnonzero(np.isfinite(point.residual_v))
    weighted = hats(CURVE_KNOTS, point.soc[rows]) * _weights(point.residual_v[rows], weighting)[:, None]
    both = weighted.T @ point.slopes[rows]
    alone = weighted.T @ hats(CURVE_KNOTS, point.soc[rows]) + np.eye(len(CURVE_KNOTS)) / problem.curve_sd_v**2
    return np.asarray(both.T @ np.linalg.solve(alone, both))


def _inverse(matrix: FloatArray) -> FloatArray:
    """Invert a covariance or a curvature, however nearly its entries depend on each other."""
    scale = np.sqrt(np.diag(matrix))
    inner = matrix / np.outer(scale, scale)
    inverse = np.linalg.inv(0.5 * (inner + inner.T) + NEARLY * np.eye(len(scale)))
    return np.asarray(inverse / np.outer(scale, scale), dtype=np.float64)
