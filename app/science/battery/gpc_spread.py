"""How sure the gradient estimator can be: the report says nothing of it."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from app.science.arrays import FloatArray
from app.science.battery.circuit import AS_PER_AH
from app.science.battery.config import VALUES, BatteryConfig
from app.science.battery.gpc_kernels import GATHERED, SQUARES, GpcHistory, GpcModel
from app.science.battery.gpc_stale import charge_drift, lags, missed_moments
from app.science.battery.gpc_step_kernels import ALPHA, BETA, RELAXATION, SLOPE, X10, XI, R
from app.science.battery.run import Carry, CellRecord
from app.science.chaos.legendre import legendre, legendre_slopes

INITIAL_SD: Mapping[str, float] = {
    "capacity_ah": 0.2,
    "resistance_ohm": 0.5,
    "relaxation_capacitance_f": 0.5,
    "relaxation_resistance_ohm": 0.5,
    "soc": 0.3,
}
"""How wrong a cell may be thought to be where the configuration doesn't say; shares, for the charge absolute."""

LEAST_SD = 1e-9
"""Of what is said to be known exactly, so that matrices can be inverted."""

CARRIED = 2.0
"""By how much a variance grows from one record to the next, as what was remembered of the rows before is gone."""

NOISE_V = 2e-3
"""Standard deviation of the voltage's noise before any was seen."""

NOISE_PER_AS = 0.005 / AS_PER_AH
"""Standard deviation of the current's noise, amperes per ampere-second of capacity: 10 mA for the report's 2 Ah."""


@dataclass(frozen=True, slots=True)
class Spread:
    """Standard deviations of everything.

    Attributes
    ----------
    sds : ndarray (m, 5)
    covariance : ndarray (7, 7)
        At the last kept row, as carried over.
    residual_sd_v : ndarray (n,)
    noise_v : float
    drift_a : float
        What the current seems to have too much, amperes.
    """

    sds: FloatArray
    covariance: FloatArray
    residual_sd_v: FloatArray
    noise_v: float
    drift_a: float


def spreads(
    record: CellRecord,
    config: BatteryConfig,
    model: GpcModel,
    out: GpcHistory,
    begun: FloatArray,
    carry: Carry | None,
) -> Spread:
    """Return how far the estimates may be from the truth.

    The parameters that minimise the cost (79) have the covariance of weighted least squares: the residual's variance
    times the inverse of the cost's second derivatives, halved as far as old rows are forgotten. The estimator follows
    that minimum with a delay; how far it still has to go, ∇J by the same inverse, is added as if it were a deviation.
    Three things bend the minimum itself, and each is added likewise, from the voltages by which rows miss: what the
    expansion leaves out, what is still remembered of a charge taken to be elsewhere, and a drift of the counted charge.
    So is the delay with which steady changes are told. Directions in which nothing was seen keep the deviation they
    began with.
    """
    terms, kept = len(model.rates), len(out.theta)
    by = _derivatives(out.theta, terms)
    hessian = by @ out.moments @ by.swapaxes(1, 2)
    u = _coordinates(out.theta, terms)
    gradient = (by @ out.moments @ u[:, :, None])[:, :, 0]
    gathered = out.scalars[:, GATHERED]
    with np.errstate(invalid="ignore", divide="ignore"):
        noise = np.where(gathered > 0.0, out.scalars[:, SQUARES] / gathered, NOISE_V**2)
    share = _weight_share(model, out)
    variance = np.maximum(noise, 1e-14) * model.step_s * share
    known = _known(config, carry)
    # Least squares weigh what was known before. Who follows the gradient doesn't: only what this record tells counts.
    weighed = known if model.solve_every else _known(config, None)
    prior = _prior_information(weighed, model, begun)
    scale = 1.0 / np.sqrt(np.diag(prior))
    information = (hessian / variance[:, None, None] + prior) * scale[:, None] * scale
    pull = (gradient / variance[:, None] + (out.theta - begun) @ prior) * scale
    inverse = np.linalg.inv(information)
    ahead = (inverse @ pull[:, :, None])[:, :, 0]
    drift_a = charge_drift(record, out, 2.0 * config.current_bias_a)
    missed = missed_moments(record, model, out, drift_a)
    spread = inverse + _outer(ahead)
    for moments in (out.cut, missed.stale, missed.drift):
        pulled = (by @ moments[:, :, None])[:, :, 0] / variance[:, None] * scale
        spread += _outer((inverse @ pulled[:, :, None])[:, :, 0])
    covariance = spread * scale[:, None] * scale
    to_values = _to_carry(model, out, kept)
    full = to_values @ covariance @ to_values.swapaxes(1, 2)
    full[:, 4, 4] += _counting_variance(config, model, out)
    circuit = values_of(model, out.theta, out.charge)[:, :4]
    changing = lags(record, model, out, np.log(circuit))
    full[:, range(4), range(4)] += changing**2
    full[:, 6, 6] = config.current_bias_a**2
    full *= _outer(_capped(full, known, model, out, begun))
    sds = np.sqrt(np.diagonal(full, axis1=1, axis2=2)[:, :5])
    sds[:, :4] *= circuit
    predicted = np.sqrt(noise)
    return Spread(
        sds,
        full[-1],
        np.interp(record.t_s, record.t_s[record.keep], predicted),
        float(predicted[-1]),
        drift_a,
    )


def values_of(model: GpcModel, theta: FloatArray, charge: FloatArray) -> FloatArray:
    """Return the five values of parameters (m, 5) and x₁ (m,) (MAUTC-2010-02, eqs 86 and 87)."""
    rate = model.rate_middle + model.rate_half * theta[:, XI]
    alpha, beta = theta[:, ALPHA], theta[:, BETA]
    soc = alpha * (theta[:, X10] + charge)
    return np.column_stack([1.0 / (AS_PER_AH * alpha), theta[:, R], 1.0 / beta, beta / rate, soc])


def _known(config: BatteryConfig, carry: Carry | None) -> FloatArray:
    """Return the covariance of what it began with: logarithms of the four parameters, and the state of charge."""
    if carry is not None:
        return CARRIED * carry.covariance[:5, :5] + np.diag(np.full(5, LEAST_SD**2))
    named = np.array([config.initial_sd.get(name, INITIAL_SD[name]) for name in VALUES])
    return np.diag(np.maximum(named, LEAST_SD) ** 2)


def _capped(full: FloatArray, known: FloatArray, model: GpcModel, out: GpcHistory, begun: FloatArray) -> FloatArray:
    """Return what deviations are to be multiplied with, (m, 7), so that none is larger than it can be.

    An estimate is at most as far from the truth as it has moved from where it began, and that was from the truth.
    """
    start = values_of(model, np.broadcast_to(begun, out.theta.shape), out.charge)
    now = values_of(model, out.theta, out.charge)
    moved = now - start
    moved[:, :4] = np.log(np.abs(now[:, :4] / start[:, :4]))
    variances = np.broadcast_to(np.diag(known), moved.shape).copy()
    variances[:, 4] += known[0, 0] * (out.charge * begun[ALPHA]) ** 2
    told = np.diagonal(full, axis1=1, axis2=2)[:, :5]
    factors = np.ones((len(full), 7))
    factors[:, :5] = np.sqrt(np.minimum(1.0, (variances + moved**2) / np.maximum(told, 1e-300)))
    return factors


def _outer(deviation: FloatArray) -> FloatArray:
    return deviation[:, :, None] * deviation[:, None, :]


def _coordinates(theta: FloatArray, terms: int) -> FloatArray:
    """Return u = [1, α, α x₁₀, β φ(ξ), R], (m, N + 4)."""
    phi = legendre(theta[:, XI], terms).T
    alpha = theta[:, ALPHA]
    return np.column_stack([np.ones_like(alpha), alpha, alpha * theta[:, X10], theta[:, BETA, None] * phi, theta[:, R]])


def _derivatives(theta: FloatArray, terms: int) -> FloatArray:
    """Return the derivatives of u by the parameters, (m, 5, N + 4)."""
    by = np.zeros((len(theta), 5, terms + 4))
    by[:, ALPHA, 1], by[:, ALPHA, SLOPE] = 1.0, theta[:, X10]
    by[:, R, -1] = 1.0
    by[:, BETA, RELAXATION:-1] = legendre(theta[:, XI], terms).T
    by[:, XI, RELAXATION:-1] = theta[:, BETA, None] * legendre_slopes(theta[:, XI], terms).T
    by[:, X10, SLOPE] = theta[:, ALPHA]
    return by


def _weight_share(model: GpcModel, out: GpcHistory) -> FloatArray:
    """Return Σw² / Σw of the forgotten rows' weights, from 1 at the start to ½."""
    horizon = -1.0 / model.log_forgetting if model.log_forgetting < 0.0 else np.inf
    return 1.0 - 0.5 * np.minimum(out.scalars[:, GATHERED] / horizon, 1.0)


def _counting_variance(config: BatteryConfig, model: GpcModel, out: GpcHistory) -> FloatArray:
    """Return the variance of the charge by the noise that is counted with the current.

    The counted charge walks at random; its start is corrected by the mean of what is remembered, so that the walk of
    half that time is what remains.
    """
    alpha = out.theta[:, ALPHA]
    noise_a = config.current_noise_a if config.current_noise_a is not None else NOISE_PER_AS / alpha
    return np.asarray(0.5 * (alpha * noise_a) ** 2 * model.step_s * out.scalars[:, GATHERED])


def _prior_information(known: FloatArray, model: GpcModel, begun: FloatArray) -> FloatArray:
    """Return what was known to begin with, as the inverse of a covariance of the five parameters."""
    alpha, beta, x10 = begun[ALPHA], begun[BETA], begun[X10]
    rate = model.rate_middle + model.rate_half * begun[XI]
    back = np.zeros((5, 5))
    back[ALPHA, 0], back[R, 1], back[BETA, 2] = -alpha, begun[R], -beta
    back[XI, 2], back[XI, 3] = -rate / model.rate_half, -rate / model.rate_half
    back[X10, 0], back[X10, 4] = x10, 1.0 / alpha
    return np.asarray(np.linalg.inv(back @ known @ back.T), dtype=np.float64)


def _to_carry(model: GpcModel, out: GpcHistory, kept: int) -> FloatArray:
    """Return the derivatives of what is carried over by the five parameters, (m, 7, 5)."""
    theta, terms = out.theta, len(model.rates)
    alpha, beta = theta[:, ALPHA], theta[:, BETA]
    rate = model.rate_middle + model.rate_half * theta[:, XI]
    to = np.zeros((kept, 7, 5))
    to[:, 0, ALPHA], to[:, 1, R], to[:, 2, BETA] = -1.0 / alpha, 1.0 / theta[:, R], -1.0 / beta
    to[:, 3, BETA], to[:, 3, XI] = 1.0 / beta, -model.rate_half / rate
    to[:, 4, ALPHA], to[:, 4, X10] = out.charge + theta[:, X10], alpha
    to[:, 5, BETA] = np.sum(legendre(theta[:, XI], terms).T * out.q, axis=1)
    to[:, 5, XI] = beta * np.sum(legendre_slopes(theta[:, XI], terms).T * out.q, axis=1)
    return to
