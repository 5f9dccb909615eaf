"""What is thought of a cell before its record begins."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Final

import numpy as np

from app.science.arrays import FloatArray
from app.science.battery.config import VALUES, BatteryConfig
from app.science.battery.kalman.layout import BIAS, PARAMETERS, RELAXATION_V, SOC, STATES
from app.science.battery.run import Carry

INITIAL_SD: Final[Mapping[str, float]] = {
    "capacity_ah": 0.2,
    "resistance_ohm": 0.5,
    "relaxation_capacitance_f": 0.5,
    "relaxation_resistance_ohm": 0.5,
    "soc": 0.3,
}
"""Standard deviations of what a configuration leaves without: shares of the value, and absolute for the charge."""

RELAXATION_HOURS = 2.0
"""The relaxation voltage a record may begin with is taken to be what a current of this many hours leaves behind."""


LEAST_EIGENVALUE: Final = 1e-9


@dataclass(frozen=True, slots=True)
class Belief:
    """Mean (7,) and covariance (7, 7) of the states of `app.science.battery.kalman.layout`."""

    mean: FloatArray
    covariance: FloatArray

    def copy(self) -> Belief:
        """Return one whose arrays may be changed."""
        return Belief(self.mean.copy(), self.covariance.copy())


def told_alone(before: Belief, after: Belief) -> FloatArray:
    """Return the variances, (4,), that what was learnt in between would leave of each parameter by itself.

    Where that is less than what was known before, the variance stands that was known before.
    """
    earlier, later = (np.diag(belief.covariance)[:PARAMETERS] for belief in (before, after))
    gained = np.maximum(earlier - later, 0.0)
    alone = np.full(PARAMETERS, np.inf)
    np.divide(earlier * later, gained, out=alone, where=gained > 0.0)
    return np.asarray(np.minimum(alone, earlier))


def no_surer(belief: Belief, least: FloatArray) -> Belief:
    """Return a belief whose parameters have at least some variances, (4,), with the same correlations.

    What a model can't explain, it can't explain in the next stretch either, and pulls on the same values the same way:
    more of such data don't make them surer.
    """
    variance = np.diag(belief.covariance)[:PARAMETERS]
    scale = np.ones(STATES)
    scale[:PARAMETERS] = np.sqrt(np.maximum(least / np.maximum(variance, np.finfo(np.float64).tiny), 1.0))
    return Belief(belief.mean, belief.covariance * np.outer(scale, scale))


def possible(covariance: FloatArray) -> FloatArray:
    """Return the covariance nearest to a matrix that rounding, or a step too long, has left without being one.

    Its correlations' eigenvalues are kept from falling below a billionth. A belief carried from record to record
    would else lose more each time, until a variance is below zero.
    """
    scale = np.sqrt(np.maximum(np.diag(covariance), 0.0))
    unit = np.where(scale > 0.0, scale, 1.0)
    correlation = np.asarray(covariance, dtype=np.float64) / np.outer(unit, unit)
    values, vectors = np.linalg.eigh(0.5 * (correlation + correlation.T))
    if values[0] >= 0.0:
        return np.array(covariance, dtype=np.float64)
    made = (vectors * np.maximum(values, LEAST_EIGENVALUE)) @ vectors.T
    return np.asarray(made * np.outer(scale, scale), dtype=np.float64)


def first_belief(config: BatteryConfig, carry: Carry | None, *, bias: bool) -> Belief:
    """Return what was carried over, or else what the configuration says.

    Parameters
    ----------
    config : BatteryConfig
    carry : Carry or None
    bias : bool
        Whether the current sensor's error is to be estimated; else it is taken to be zero.

    Returns
    -------
    Belief
    """
    if carry is None:
        belief = _configured(config)
    else:
        belief = Belief(np.array(carry.mean, dtype=np.float64), possible(carry.covariance))
    if not bias:
        belief.mean[BIAS] = 0.0
        belief.covariance[BIAS, :] = belief.covariance[:, BIAS] = 0.0
    return belief


def _configured(config: BatteryConfig) -> Belief:
    circuit = config.cell.circuit
    mean, sd = np.zeros(STATES), np.zeros(STATES)
    mean[:PARAMETERS] = np.log(
        [
            circuit.capacity_as,
            circuit.resistance_ohm,
            circuit.relaxation_capacitance_f,
            circuit.relaxation_resistance_ohm,
        ]
    )
    mean[SOC] = config.cell.soc
    sd[: SOC + 1] = [config.initial_sd.get(name, INITIAL_SD[name]) for name in VALUES]
    sd[RELAXATION_V] = circuit.relaxation_resistance_ohm * circuit.capacity_ah / RELAXATION_HOURS
    sd[BIAS] = config.current_bias_a
    return Belief(mean, np.diag(sd**2))
