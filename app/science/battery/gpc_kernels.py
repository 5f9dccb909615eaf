"""The report's recursive gradient estimator, row by row (MAUTC-2010-02, part 3, eqs 77–87).

With u = [1, α, α x₁₀, β φ(ξ), R] and S the forgotten moments of z = [V₀ − V_m, C₀ x₁, C₀, q, I], the cost (79) is
½ uᵀ S u, and its gradient by the five parameters is what eqs 81 to 85 write out.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from app.science.arrays import BoolArray, FloatArray, IntArray
from app.science.battery.curve import CurvePieces
from app.science.battery.curve_kernels import open_circuit
from app.science.battery.gpc_step_kernels import (
    ALPHA,
    BETA,
    CHARGE,
    COUNT,
    DATA,
    RELAXATION,
    SLOPE,
    X10,
    XI,
    R,
    solve,
    step,
)
from app.science.chaos.legendre_kernels import fill_legendre
from app.science.jit import kernel

X1, X2, SQUARES, GATHERED = range(4)
SOON_S = 600.0
"""For so long from the start on least squares are solved in every row."""


class GpcModel(NamedTuple):
    """What stays the same from row to row.

    ``rates`` (N,) and ``to_basis`` (N, N) are the relaxation at Gauss's nodes and what makes q of it; ``rate_middle``
    and ``rate_half`` are σ₀ and σ₁; ``gains`` (5,) is the diagonal of Γ; ``log_forgetting`` is ln λ; ``step_s`` is the
    usual time between rows; between ``lowest`` and ``highest`` (5,) the parameters are kept.

    With ``solve_every`` above 0 the cost isn't followed down but minimised, anew after that many rows: ``gains`` are
    then variances of ``first_guess`` (5,) over the one of a second's voltage, and ``charge_variance`` that of the share
    α x₁₀ of the charge at the first row; rows are forgotten within
    ``young_share`` of the time since the start until λ forgets faster.
    """

    pieces: CurvePieces
    rates: FloatArray
    to_basis: FloatArray
    rate_middle: float
    rate_half: float
    gains: FloatArray
    log_forgetting: float
    step_s: float
    lowest: FloatArray
    highest: FloatArray
    first_guess: FloatArray
    charge_variance: float
    solve_every: int
    young_share: float


class GpcRows(NamedTuple):
    """Rows of a record; the factors are those of the temperature, one entry each where it never changes."""

    t_s: FloatArray
    current_a: FloatArray
    voltage_v: FloatArray
    resistance_factor: FloatArray
    relaxation_factor: FloatArray
    capacity_factor: FloatArray
    keep: IntArray
    first: int


class GpcState(NamedTuple):
    """What is carried from row to row, and changed in place.

    ``theta`` (5,): α, R, β, ξ, x₁₀. ``moments`` (N + 4, N + 4): S. ``nodes`` (N,): x₂ at Gauss's
    nodes. ``cut`` (N + 4,): forgotten sum of z times the voltage that the expansion leaves out. ``scalars`` (4,): x₁;
    x₂ at the present σ, not expanded; forgotten sum of squared residuals; forgotten time.
    """

    theta: FloatArray
    moments: FloatArray
    nodes: FloatArray
    cut: FloatArray
    scalars: FloatArray


class GpcHistory(NamedTuple):
    """What is written down: at the kept rows, and for all rows."""

    theta: FloatArray
    charge: FloatArray
    q: FloatArray
    moments: FloatArray
    cut: FloatArray
    scalars: FloatArray
    residual_v: FloatArray
    learnt: BoolArray


@kernel
def run_rows(model: GpcModel, rows: GpcRows, state: GpcState, out: GpcHistory, begin: int, end: int) -> int:
    """Go over the rows from ``begin`` to before ``end``.

    Returns the row at which the parameters stopped being finite, or -1.
    """
    # Arrays are taken out of the tuples once: doing it in each row would cost more than the row's arithmetic.
    t_s, current_a, voltage_v, keep = rows.t_s, rows.current_a, rows.voltage_v, rows.keep
    warm_r, warm_x2, warm_q = rows.resistance_factor, rows.relaxation_factor, rows.capacity_factor
    theta, moments, nodes, cut, scalars = state.theta, state.moments, state.nodes, state.cut, state.scalars
    pieces, rates, to_basis, step_s = model.pieces, model.rates, model.to_basis, model.step_s
    residuals, learnt = out.residual_v, out.learnt
    gains, lowest, highest, guess = model.gains, model.lowest, model.highest, model.first_guess
    terms, n, first = len(rates), len(t_s), rows.first
    size = terms + 4
    phi, slopes, q, decays, gathered = (
        np.empty(terms),
        np.empty(terms),
        np.empty(terms),
        np.empty(terms),
        np.empty(terms),
    )
    z, u, su = np.empty(size), np.empty(size), np.empty(size)
    last_dt, forget, faded = -1.0, 1.0, 1.0
    kept = np.searchsorted(keep, begin)
    next_kept = keep[kept] if kept < len(keep) else n
    warm = len(warm_r) > 1
    for k in range(begin, end):
        now = k if warm else 0
        current = current_a[k]
        driven = current * warm_r[now]
        fill_legendre(theta[XI], phi, slopes)
        relaxation = 0.0
        for i in range(terms):
            total = 0.0
            for j in range(terms):
                total += to_basis[i, j] * nodes[j]
            q[i] = total
            relaxation += phi[i] * total
        soc = theta[ALPHA] * (theta[X10] + scalars[X1])
        volts, slope = open_circuit(pieces, soc)
        residual = voltage_v[k] - (volts + theta[BETA] * relaxation + theta[R] * driven)
        residuals[k] = residual
        dt = t_s[k + 1] - t_s[k] if k + 1 < n else step_s
        weight = min(dt, step_s)
        seen = k >= first and np.isfinite(residual)
        if seen or k == next_kept:
            left_out = theta[BETA] * (scalars[X2] - relaxation)
            z[DATA], z[CHARGE], z[SLOPE] = volts - slope * soc - voltage_v[k], slope * scalars[X1], slope
            u[DATA], u[CHARGE], u[SLOPE] = 1.0, theta[ALPHA], theta[ALPHA] * theta[X10]
            for i in range(terms):
                z[RELAXATION + i], u[RELAXATION + i] = q[i], theta[BETA] * phi[i]
            z[size - 1], u[size - 1] = driven, theta[R]
            for i in range(size):
                heavy, total = weight * z[i] if seen else 0.0, 0.0
                for j in range(size):
                    moment = faded * moments[i, j] + (heavy * z[j] if seen else 0.0)
                    moments[i, j] = moment
                    total += moment * u[j]
                su[i] = total
                cut[i] = faded * cut[i] + (heavy * left_out if seen else 0.0)
            scalars[SQUARES] *= faded
            scalars[GATHERED] *= faded
            faded = 1.0
        if seen:
            scalars[SQUARES] += weight * residual * residual
            scalars[GATHERED] += weight
            if model.solve_every == 0:
                step(theta, moments, phi, slopes, su, gains, weight)
            elif k % model.solve_every == 0 or scalars[GATHERED] < SOON_S:
                solve(theta, moments, phi, slopes, su, gains, guess, model.charge_variance)
            if not np.isfinite(theta.sum()):
                return k
            for i in range(COUNT):
                theta[i] = min(max(theta[i], lowest[i]), highest[i])
            learnt[k] = True
        if k == next_kept:
            out.theta[kept] = theta
            out.charge[kept] = scalars[X1]
            out.q[kept] = q
            out.moments[kept] = moments
            out.cut[kept] = cut
            out.scalars[kept] = scalars
            kept += 1
            next_kept = keep[kept] if kept < len(keep) else n
        if dt != last_dt:
            last_dt, forget = dt, np.exp(model.log_forgetting * dt)
            for j in range(terms):
                decays[j] = np.exp(-rates[j] * dt)
                gathered[j] = -np.expm1(-rates[j] * dt) / rates[j]
        if model.young_share > 0.0 and k >= first:
            age = model.young_share * max(t_s[k] - t_s[first], SOON_S)
            forget = np.exp(min(model.log_forgetting, -1.0 / age) * dt)
        faded *= forget
        through = current * warm_x2[now]
        scalars[X1] += current * dt / warm_q[now]
        rate = model.rate_middle + theta[XI] * model.rate_half
        decay = np.exp(-rate * dt)
        scalars[X2] = decay * scalars[X2] + (1.0 - decay) / rate * through
        for j in range(terms):
            nodes[j] = decays[j] * nodes[j] + gathered[j] * through
    for i in range(size):
        for j in range(size):
            moments[i, j] *= faded
        cut[i] *= faded
    scalars[SQUARES] *= faded
    scalars[GATHERED] *= faded
    return -1
