"""Recursive least squares: the least of the report's cost, instead of a slow way down to it."""

from __future__ import annotations

import numpy as np

from app.science.arrays import FloatArray
from app.science.battery.config import VALUES, BatteryConfig
from app.science.battery.gpc_running import Beginning, Law, circuit_of, run_law, usual_step
from app.science.battery.gpc_spread import CARRIED, INITIAL_SD
from app.science.battery.gpc_step_kernels import ALPHA, BETA, X10, XI, R
from app.science.battery.run import Carry, CellRecord, Run
from app.science.progress import Progress, silent

TERMS = 8
SPREAD = 3.0
"""How many times slower or faster than first thought the relaxation may be."""

FREE = 100.0
"""Capacities by which x₁₀ may move; what holds it is the state of charge, its product with α."""

SOLVE_EVERY = 10
YOUNG_SHARE = 0.25
NOISE_V = 0.005
"""Deviation of the voltage, where none is configured, against which the first guess is held."""


def run_rls(record: CellRecord, config: BatteryConfig, carry: Carry | None = None, progress: Progress = silent) -> Run:
    """Estimate by recursive least squares with forgetting.

    The model is the one of the report in its linear coordinates (MAUTC-2010-02, eqs 77 and 78), the cost its (79), and
    so are the moments that are carried from row to row; but the parameters are those of the cost's minimum. In its
    first hours old rows are forgotten sooner than λ says, as they were linearised at a charge that was wrong.

    Raises
    ------
    EstimatorDiverged
        When the parameters stop being finite.
    """
    first = circuit_of(config, carry)
    rate = 1.0 / (first.relaxation_ohm * first.capacitance_f)
    rates = (rate / SPREAD, rate * SPREAD)
    variance = (config.voltage_noise_v or NOISE_V) ** 2 * usual_step(record)
    known = np.array([config.initial_sd.get(name, INITIAL_SD[name]) for name in VALUES]) ** 2
    if carry is not None:
        known = CARRIED * np.diag(carry.covariance)[:5]
    law = Law(
        TERMS,
        rates,
        _variances(known, first, rates) / variance,
        float(known[4]) / variance,
        SOLVE_EVERY,
        YOUNG_SHARE,
        "Begin nearer to the truth",
    )
    return run_law(record, config, law, carry, progress)


def _variances(known: FloatArray, first: Beginning, rates_1ps: tuple[float, float]) -> FloatArray:
    """Return how uncertain α, R, β, ξ and x₁₀ are to begin with; x₁₀ is held by α x₁₀ alone."""
    half = 0.5 * (rates_1ps[1] - rates_1ps[0])
    rate = 1.0 / (first.relaxation_ohm * first.capacitance_f)
    variances = np.empty(5)
    variances[ALPHA] = known[0] / first.capacity_as**2
    variances[R] = known[1] * first.resistance_ohm**2
    variances[BETA] = known[2] / first.capacitance_f**2
    variances[XI] = (known[2] + known[3]) * (rate / half) ** 2
    variances[X10] = (FREE * first.capacity_as) ** 2
    return variances
