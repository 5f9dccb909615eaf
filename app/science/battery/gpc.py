"""The report's gPC estimator of a cell's parameters and charge (MAUTC-2010-02, part 3)."""

from __future__ import annotations

import numpy as np

from app.science.arrays import FloatArray
from app.science.battery.circuit import AS_PER_AH
from app.science.battery.config import BatteryConfig, Gains
from app.science.battery.gpc_kernels import (
    ALPHA,
    BETA,
    X2,
    X10,
    XI,
    GpcHistory,
    GpcModel,
    GpcRows,
    GpcState,
    R,
    run_rows,
)
from app.science.battery.gpc_spread import spreads
from app.science.battery.gpc_words import bound_warnings, drift_warnings
from app.science.battery.run import Carry, CellRecord, Run
from app.science.chaos.galerkin import modes
from app.science.chaos.legendre import legendre
from app.science.errors import EstimatorDiverged
from app.science.progress import Progress, silent

CHUNK = 500_000
REPORT_AH = 2.2
"""What the capacity is first thought to be in Table 7."""

FACTORS = {ALPHA: 4.0, R: 10.0, BETA: 10.0}
"""How many times larger or smaller than first thought a parameter may become."""


def run_gpc(record: CellRecord, config: BatteryConfig, carry: Carry | None = None, progress: Progress = silent) -> Run:
    """Estimate by the report's recursive law.

    Moments are gathered from the start on, not before: what is seen while the charge is still thought to be elsewhere
    would be linearised at the wrong place of the curve and pull at the parameters for days.

    Raises
    ------
    EstimatorDiverged
        When the parameters stop being finite.
    """
    model = _model(record, config)
    state = _begin(model, config, carry)
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
    values = _values(model, out)
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
        bound_warnings(config, model, out) + drift_warnings(model, out, spread.drift_a),
    )


def _model(record: CellRecord, config: BatteryConfig) -> GpcModel:
    low, high = config.gpc.sigma_range_1ps
    apart = modes(config.gpc.terms)
    middle, half = 0.5 * (high + low), 0.5 * (high - low)
    gains = suited(config.gpc.gains, config.cell.circuit.capacity_ah)
    diagonal = np.empty(5)
    diagonal[ALPHA], diagonal[R], diagonal[BETA] = gains.alpha, gains.r, gains.beta
    diagonal[XI], diagonal[X10] = gains.xi, gains.x10
    return GpcModel(
        config.cell.curve.pieces,
        middle + half * apart.xi,
        apart.to_basis,
        middle,
        half,
        diagonal,
        float(np.log(config.gpc.forgetting)),
        float(np.median(np.diff(record.t_s))) if len(record.t_s) > 1 else 1.0,
        *_bounds(config),
    )


def suited(gains: Gains, capacity_ah: float) -> Gains:
    """Return gains for a cell of another size where they are the ones of Table 8, found for 2 Ah by trial and error.

    Up to twice or half of the report's first guess they hold as printed. Beyond, current and charge are taken to be as
    many times larger as the capacity is; so scaled, the parameters move by the same shares of themselves.
    """
    size = capacity_ah / REPORT_AH
    if gains != Gains() or 0.5 <= size <= 2.0:
        return gains
    return Gains(gains.alpha / size**2, gains.r / size**2, gains.beta / size**2, gains.xi, gains.x10 * size**2)


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


def _begin(model: GpcModel, config: BatteryConfig, carry: Carry | None) -> GpcState:
    circuit, soc, relaxation_v = config.cell.circuit, config.cell.soc, 0.0
    capacity_as, resistance, capacitance, beside = (
        circuit.capacity_as,
        circuit.resistance_ohm,
        circuit.relaxation_capacitance_f,
        circuit.relaxation_resistance_ohm,
    )
    if carry is not None:
        capacity_as, resistance, capacitance, beside = (float(one) for one in np.exp(carry.mean[:4]))
        soc, relaxation_v = float(carry.mean[4]), float(carry.mean[5])
    theta = np.empty(5)
    theta[ALPHA], theta[R], theta[BETA], theta[X10] = (
        1.0 / capacity_as,
        resistance,
        1.0 / capacitance,
        capacity_as * soc,
    )
    theta[XI] = np.clip((1.0 / (beside * capacitance) - model.rate_middle) / model.rate_half, -1.0, 1.0)
    terms, x2 = len(model.rates), capacitance * relaxation_v
    scalars = np.zeros(4)
    scalars[X2] = x2
    return GpcState(theta, np.zeros((terms + 4, terms + 4)), np.full(terms, x2), np.zeros(terms + 4), scalars)


def _rows(record: CellRecord, config: BatteryConfig) -> GpcRows:
    first = int(np.searchsorted(record.t_s, record.t_s[0] + config.start_after_s))
    factors = np.broadcast_arrays(record.resistance_factor, record.relaxation_factor, record.capacity_factor)
    resistance, relaxation, capacity = (np.ascontiguousarray(one, dtype=np.float64) for one in factors)
    return GpcRows(record.t_s, record.current_a, record.voltage_v, resistance, relaxation, capacity, record.keep, first)


def _values(model: GpcModel, out: GpcHistory) -> FloatArray:
    """Return the five values of the kept rows (MAUTC-2010-02, eqs 86 and 87)."""
    theta = out.theta
    rate = model.rate_middle + model.rate_half * theta[:, XI]
    return np.column_stack(
        [
            1.0 / (AS_PER_AH * theta[:, ALPHA]),
            theta[:, R],
            1.0 / theta[:, BETA],
            theta[:, BETA] / rate,
            theta[:, ALPHA] * (theta[:, X10] + out.charge),
        ]
    )


def _carried(values: FloatArray, relaxation_v: float) -> FloatArray:
    capacity_as = AS_PER_AH * values[0]
    return np.array([*np.log([capacity_as, *values[1:4]]), values[4], relaxation_v, 0.0])


def _diverged(t_s: float) -> EstimatorDiverged:
    return EstimatorDiverged(
        f"The numbers of the gPC estimator stopped being finite at {t_s:.0f} s. Look for impossible currents or "
        "voltages there, make the estimator's gains smaller, or use the estimator ekf_bias.",
        t_s,
    )
