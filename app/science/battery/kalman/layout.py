"""Where each state of the joint Kalman filters stands, and what their kernels take; free of everything compiled."""

from __future__ import annotations

from typing import NamedTuple

from app.science.arrays import FloatArray

LN_CAPACITY, LN_RESISTANCE, LN_CAPACITANCE, LN_RELAXATION, SOC, RELAXATION_V, BIAS = range(7)
"""States in the order of `app.science.battery.run.Carry.mean`: parameters as logarithms, so that they stay positive."""

STATES = 7
PARAMETERS = 4
"""The first so many states are parameters."""


class Rows(NamedTuple):
    """A stretch of one cell's record; every array is (n,), the factors (n,) or (1,)."""

    t_s: FloatArray
    current_a: FloatArray
    voltage_v: FloatArray
    resistance_factor: FloatArray
    relaxation_factor: FloatArray
    capacity_factor: FloatArray


class Noise(NamedTuple):
    """What the filter may take to be random."""

    voltage_variance: float
    """Of each row's voltage, V²."""

    current_variance: float
    """Of each row's current, A²."""

    walks: FloatArray
    """(7,): by how much the variance of each state grows on its own, per second."""

    gate: float
    """Residuals beyond so many of their standard deviations count less, the farther out the less."""

    lowest: FloatArray
    highest: FloatArray
    """(4,): between which the logarithms of the parameters stay."""


class Trace(NamedTuple):
    """Where a filter writes what it did, row by row: rows (n,), kept rows (m,) or (m, 7)."""

    residual_v: FloatArray
    variance_v2: FloatArray
    """Of the residual as predicted; the larger one it was taken for is found by comparing with the gate."""

    means: FloatArray
    variances: FloatArray


ALPHA, BETA, KAPPA = 0.5, 2.0, 0.0
"""Of Merwe's scaled points: how far out they stand, and what the centre weighs for a normal distribution."""
