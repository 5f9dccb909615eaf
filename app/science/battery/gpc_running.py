"""What the gradient law and least squares share: from a record through the compiled rows to a run."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from app.science.arrays import FloatArray
from app.science.battery.circuit import AS_PER_AH
from app.science.battery.config import BatteryConfig
from app.science.battery.gpc_kernels import X2, GpcHistory, GpcModel, GpcRows, GpcState, run_rows
from app.science.battery.gpc_spread import spreads, values_of
from app.science.battery.gpc_step_kernels import ALPHA, BETA, X10, XI, R
from app.science.battery.gpc_words import bound_warnings, drift_warnings
from app.science.battery.run import Carry, CellRecord, Run
from app.science.chaos.galerkin import modes
from app.science.chaos.legendre import legendre
from app.science.errors import EstimatorDiverged
from app.science.progress import Progress

CHUNK = 500_000

FACTORS = {ALPHA: 4.0, R: 10.0, BETA: 10.0}
"""How many times larger or smaller than first thought a parameter may become."""


@dataclass(frozen=True, slots=True)
class Law:
    """How the parameters move.

    Attributes
    ----------
    terms : int
        N, of the expansion.
    rates_1ps : tuple of float
        Between which σ is looked for.
    gains : ndarray (5,)
        Diagonal of Γ; or, where the cost is minimised, the first guesses' variances over that of a second's voltage.
    charge_variance : float
        Likewise of the state of charge at the first row; where the cost is followed down, of no meaning.
    solve_every : int
        0: the cost is followed down; else it is minimised after so many rows.
    young_share : float
        Within which share of the time since the start rows are forgotten, until λ forgets faster; 0: λ alone.
    remedy : str
        What helps where σ stands at a bound.
    """

    terms: int
    rates_1ps: tuple[float, float]
    gains: FloatArray
    charge_variance: float
    solve_every: int
    young_share: float
    remedy: str


def run_law(record: CellRecord, config: BatteryConfig, law: Law, carry: Carry | None, progress: Progress) -> Run:
    """Run over a record by a law.

    Raises
    ------
    EstimatorDiverged
        When the parameters stop being finite.
    """
    model = _model(record, config, law)
    state = _begin(model, circuit_of(config, carry))
    rows = _rows(record, config)
    terms, kept = len(model.rates), len(record.keep)
    out = GpcHistory(
        np.empty((kept, 5)),
        np.empty(kept),
        np.empty((kept, terms)),
        np.zeros((kept, terms + 4, terms + 4)),
        np.zeros((kept, terms + 4)),
        np.empty((kept, 4)),
        np.empty(len(record.t_s)),
        np.zeros(len(record.t_s), dtype=np.bool_),
    )
    theta = state.theta.copy()
    for begin in range(0, len(record.t_s), CHUNK):
        end = min(begin + CHUNK, len(record.t_s))
        lost = run_rows(model, rows, state, out, begin, end)
        if lost >= 0:
            raise _diverged(float(record.t_s[lost]))
        progress(end / len(record.t_s))
    spread = spreads(record, config, model, out, theta, carry)
    values = values_of(model, out.theta, out.charge)
    relaxation_v = out.theta[:, BETA] * np.sum(legendre(out.theta[:, XI], terms).T * out.q, axis=1)
    return Run(
        values,
        spread.sds,
        np.zeros(kept),
        np.full(kept, config.current_bias_a),
        relaxation_v,
        out.residual_v,
        spread.residual_sd_v,
        out.learnt,
        spread.noise_v,
        Carry(_carried(values[-1], relaxation_v[-1]), spread.covariance, float(record.t_s[-1])),
        bound_warnings(model, out, law.remedy) + drift_warnings(model, out, spread.drift_a),
    )


@dataclass(frozen=True, slots=True)
class Beginning:
    """What an estimator begins with, in SI units; the capacity in ampere-seconds."""

    capacity_as: float
    resistance_ohm: float
    capacitance_f: float
    relaxation_ohm: float
    soc: float
    relaxation_v: float


def circuit_of(config: BatteryConfig, carry: Carry | None) -> Beginning:
    """Return what was carried over, or else what is configured."""
    if carry is not None:
        capacity_as, resistance, capacitance, beside = (float(one) for one in np.exp(carry.mean[:4]))
        return Beginning(capacity_as, resistance, capacitance, beside, float(carry.mean[4]), float(carry.mean[5]))
    circuit = config.cell.circuit
    return Beginning(
        circuit.capacity_as,
        circuit.resistance_ohm,
        circuit.relaxation_capacitance_f,
        circuit.relaxation_resistance_ohm,
        config.cell.soc,
        0.0,
    )


def usual_step(record: CellRecord) -> float:
    """Return the usual time between rows, seconds."""
    return float(np.median(np.diff(record.t_s))) if len(record.t_s) > 1 else 1.0


def _model(record: CellRecord, config: BatteryConfig, law: Law) -> GpcModel:
    low, high = law.rates_1ps
    apart = modes(law.terms)
    middle, half = 0.5 * (high + low), 0.5 * (high - low)
    return GpcModel(
        config.cell.curve.pieces,
        middle + half * apart.xi,
        apart.to_basis,
        middle,
        half,
        law.gains,
        float(np.log(config.gpc.forgetting)),
        usual_step(record),
        *_bounds(config),
        np.zeros(5),
        law.charge_variance,
        law.solve_every,
        law.young_share,
    )


def _bounds(config: BatteryConfig) -> tuple[FloatArray, FloatArray]:
    """Return between what the parameters are kept.

    While the charge is still thought to be elsewhere, its error pulls at all parameters; without bounds the
    relaxation's capacitance can pass through infinity and never come back.
    """
    circuit, lowest = config.cell.circuit, np.full(5, -np.inf)
    highest = np.full(5, np.inf)
    lowest[XI], highest[XI] = -1.0, 1.0
    first = {ALPHA: 1.0 / circuit.capacity_as, R: circuit.resistance_ohm, BETA: 1.0 / circuit.relaxation_capacitance_f}
    for at, value in first.items():
        lowest[at], highest[at] = value / FACTORS[at], value * FACTORS[at]
    return lowest, highest


def _begin(model: GpcModel, first: Beginning) -> GpcState:
    terms, x2 = len(model.rates), first.capacitance_f * first.relaxation_v
    theta, scalars = model.first_guess.copy(), np.zeros(4)
    scalars[X2] = x2
    theta[ALPHA], theta[R], theta[BETA] = 1.0 / first.capacity_as, first.resistance_ohm, 1.0 / first.capacitance_f
    rate = 1.0 / (first.relaxation_ohm * first.capacitance_f)
    theta[XI] = np.clip((rate - model.rate_middle) / model.rate_half, -1.0, 1.0)
    theta[X10] = first.capacity_as * first.soc
    model.first_guess[:] = theta
    return GpcState(theta, np.zeros((terms + 4, terms + 4)), np.full(terms, x2), np.zeros(terms + 4), scalars)


def _rows(record: CellRecord, config: BatteryConfig) -> GpcRows:
    first = int(np.searchsorted(record.t_s, record.t_s[0] + config.start_after_s))
    factors = np.broadcast_arrays(record.resistance_factor, record.relaxation_factor, record.capacity_factor)
    resistance, relaxation, capacity = (np.ascontiguousarray(one, dtype=np.float64) for one in factors)
    return GpcRows(record.t_s, record.current_a, record.voltage_v, resistance, relaxation, capacity, record.keep, first)


def _carried(values: FloatArray, relaxation_v: float) -> FloatArray:
    capacity_as = AS_PER_AH * values[0]
    return np.array([*np.log([capacity_as, *values[1:4]]), values[4], relaxation_v, 0.0])


def _diverged(t_s: float) -> EstimatorDiverged:
    return EstimatorDiverged(
        f"The numbers of the gPC estimator stopped being finite at {t_s:.0f} s. Look for impossible currents or "
        "voltages there, make the estimator's gains smaller, or use the estimator ekf_bias.",
        t_s,
    )
