"""A cell's joint Kalman filters as one would write them down first: dense NumPy matrices, and filterpy's unscented one.

They exist to be compared with, in speed and in their numbers.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from filterpy.kalman import MerweScaledSigmaPoints, UnscentedKalmanFilter

from app.science.arrays import FloatArray
from app.science.battery.curve import CurvePieces, slope_at, voltage_at
from app.science.battery.kalman.extended_kernels import NOISE_ONLY
from app.science.battery.kalman.layout import (
    ALPHA,
    BETA,
    BIAS,
    KAPPA,
    LN_CAPACITANCE,
    LN_CAPACITY,
    LN_RELAXATION,
    LN_RESISTANCE,
    RELAXATION_V,
    SOC,
    STATES,
    Noise,
    Rows,
)
from app.science.battery.kalman.steady_kernels import LONGEST, SAME


@dataclass(frozen=True, slots=True)
class DenseRun:
    """Means (n, 7) and covariances (n, 7, 7) after each row's voltage."""

    mean: FloatArray
    covariance: FloatArray


def steady_currents(rows: Rows, variance: float) -> tuple[FloatArray, FloatArray]:
    """Return each row's current without its own noise where it goes on as before, and whether it doesn't."""
    amps, quiet = rows.current_a, rows.current_a.copy()
    alone = np.ones(len(amps), dtype=bool)
    mean, count = amps[0], 1.0
    for k in range(1, len(amps)):
        alone[k] = abs(amps[k] - mean) > SAME * np.sqrt(variance * (1.0 + 1.0 / count))
        if alone[k]:
            mean, count = amps[k], 1.0
        else:
            quiet[k], count = mean, min(count + 1.0, LONGEST)
            mean += (amps[k] - mean) / count
    return quiet, alone


def seen(state: FloatArray, pieces: CurvePieces, amps: float, factor: float = 1.0) -> float:
    """Return the voltage of a state (7,) or (8,); an eighth entry is the noise of the current."""
    current = amps - state[BIAS] - state[STATES:].sum()
    at_rest = float(voltage_at(pieces, state[SOC : SOC + 1])[0])
    return float(at_rest + state[RELAXATION_V] + factor * np.exp(state[LN_RESISTANCE]) * current)


def stepped(state: FloatArray, amps: float, step_s: float, factors: tuple[float, float] = (1.0, 1.0)) -> FloatArray:
    """Return a state (7,) or (8,) a step later; ``factors`` are those of R_r and of Q."""
    current = amps - state[BIAS] - state[STATES:].sum()
    left = np.exp(-step_s * np.exp(-state[LN_CAPACITANCE] - state[LN_RELAXATION]))
    later = state.copy()
    later[SOC] += current * step_s / (np.exp(state[LN_CAPACITY]) * factors[1])
    later[RELAXATION_V] *= left
    later[RELAXATION_V] += factors[0] * np.exp(state[LN_RELAXATION]) * (1.0 - left) * current
    return later


def extended_dense(rows: Rows, pieces: CurvePieces, noise: Noise, mean: FloatArray, covariance: FloatArray) -> DenseRun:
    """Run the extended filter with eight states and full matrices; the eighth is the current's noise of a row."""
    n, whole = len(rows.t_s), STATES + 1
    means, covariances = np.empty((n, STATES)), np.empty((n, STATES, STATES))
    x, p = np.append(mean, 0.0), np.zeros((whole, whole))
    p[:STATES, :STATES] = covariance
    quiet, alone = steady_currents(rows, noise.current_variance)
    for k in range(n):
        x[STATES], p[STATES, :], p[:, STATES] = 0.0, 0.0, 0.0
        p[STATES, STATES] = noise.current_variance
        if np.isfinite(rows.voltage_v[k]):
            factor = float(rows.resistance_factor[k % len(rows.resistance_factor)])
            h = by_state(x, pieces, quiet[k], factor)
            if abs(quiet[k] - x[BIAS]) <= NOISE_ONLY * np.sqrt(noise.current_variance + p[BIAS, BIAS]):
                h[LN_RESISTANCE] = 0.0
            residual = rows.voltage_v[k] - seen(x, pieces, rows.current_a[k], factor)
            variance = max(h @ p @ h + noise.voltage_variance, (residual / noise.gate) ** 2)
            gain = p @ h / variance
            explained = h[:STATES] @ p[:STATES, :STATES] @ h[:STATES]
            ohm = h[STATES]
            x, p = x + gain * residual, p - variance * np.outer(gain, gain)
            if alone[k] and h[LN_RESISTANCE] != 0.0:
                x[:STATES] += ohm**2 * noise.current_variance / (variance - explained) * p[:STATES, LN_RESISTANCE]
        means[k], covariances[k] = x[:STATES], p[:STATES, :STATES]
        if k + 1 < n:
            step_s = float(rows.t_s[k + 1] - rows.t_s[k])
            factors = step_factors(rows, k)
            # The model is linearised about no noise; what is known of the noise goes through the derivatives.
            f, wandered = step_by_state(x, rows.current_a[k], step_s, factors), x[STATES]
            x[STATES] = 0.0
            x = stepped(x, rows.current_a[k], step_s, factors) + f[:, STATES] * wandered
            p = f @ p @ f.T
            p[:STATES, :STATES] += np.diag(noise.walks) * step_s
    return DenseRun(means, covariances)


def by_state(state: FloatArray, pieces: CurvePieces, amps: float, factor: float = 1.0) -> FloatArray:
    """Return the derivatives of `seen`, (8,)."""
    ohm, h = factor * np.exp(state[LN_RESISTANCE]), np.zeros(STATES + 1)
    h[LN_RESISTANCE] = ohm * (amps - state[BIAS])
    h[SOC] = slope_at(pieces, state[SOC : SOC + 1])[0]
    h[RELAXATION_V], h[BIAS], h[STATES] = 1.0, -ohm, -ohm
    return h


def step_by_state(
    state: FloatArray, amps: float, step_s: float, factors: tuple[float, float] = (1.0, 1.0)
) -> FloatArray:
    """Return the derivatives of `stepped`, (8, 8)."""
    current = amps - state[BIAS]
    shares = step_s * np.exp(-state[LN_CAPACITANCE] - state[LN_RELAXATION])
    left, per_amp = np.exp(-shares), step_s / (np.exp(state[LN_CAPACITY]) * factors[1])
    ohm = factors[0] * np.exp(state[LN_RELAXATION])
    f = np.eye(STATES + 1)
    f[SOC, LN_CAPACITY] = -current * per_amp
    f[SOC, BIAS] = f[SOC, STATES] = -per_amp
    f[RELAXATION_V, LN_CAPACITANCE] = left * shares * (state[RELAXATION_V] - ohm * current)
    f[RELAXATION_V, LN_RELAXATION] = f[RELAXATION_V, LN_CAPACITANCE] + ohm * (1.0 - left) * current
    f[RELAXATION_V, RELAXATION_V] = left
    f[RELAXATION_V, BIAS] = f[RELAXATION_V, STATES] = -ohm * (1.0 - left)
    return f


def step_factors(rows: Rows, k: int) -> tuple[float, float]:
    """Return what R_r and Q are multiplied with in a row."""
    by_relaxation, by_capacity = rows.relaxation_factor, rows.capacity_factor
    return float(by_relaxation[k % len(by_relaxation)]), float(by_capacity[k % len(by_capacity)])


def unscented_filterpy(
    rows: Rows, pieces: CurvePieces, noise: Noise, mean: FloatArray, covariance: FloatArray
) -> DenseRun:
    """Run filterpy's unscented filter with the same points; every row needs a voltage and none may be gated."""
    n = len(rows.t_s)
    points = MerweScaledSigmaPoints(STATES, ALPHA, BETA, KAPPA)
    ukf = UnscentedKalmanFilter(STATES, 1, 1.0, hx=None, fx=None, points=points)
    ukf.x, ukf.P = mean.copy(), covariance.copy()
    ukf.sigmas_f = points.sigma_points(ukf.x, ukf.P)
    means, covariances = np.empty((n, STATES)), np.empty((n, STATES, STATES))
    quiet, alone = steady_currents(rows, noise.current_variance)
    for k in range(n):
        amps = rows.current_a[k]
        factor = float(rows.resistance_factor[k % len(rows.resistance_factor)])
        ohm = factor * np.exp(ukf.x[LN_RESISTANCE])
        variance = noise.voltage_variance + ohm**2 * noise.current_variance
        noisy = ohm * (amps - quiet[k])
        ukf.update(
            np.array([rows.voltage_v[k] - noisy]),
            R=variance,
            hx=lambda state, amps=quiet[k], factor=factor: np.array([seen(state, pieces, amps, factor)]),
        )
        if alone[k]:
            ukf.x += ohm**2 * noise.current_variance / variance * ukf.P[:, LN_RESISTANCE]
        means[k], covariances[k] = ukf.x, ukf.P
        if k + 1 < n:
            step_s = float(rows.t_s[k + 1] - rows.t_s[k])
            factors = step_factors(rows, k)
            per_noise = step_by_state(ukf.x, amps, step_s, factors)[:STATES, STATES]
            ukf.Q = noise.current_variance * np.outer(per_noise, per_noise) + np.diag(noise.walks) * step_s
            ukf.predict(
                dt=step_s,
                fx=lambda state, dt, amps=amps, factors=factors: stepped(state, amps, dt, factors),
            )
    return DenseRun(means, covariances)
