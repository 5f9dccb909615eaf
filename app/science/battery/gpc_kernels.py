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
from app.science.chaos.legendre_kernels import fill_legendre
from app.science.jit import inline_kernel, kernel

ALPHA, R, BETA, XI, X10 = range(5)
COUNT = 5
X1, X2, SQUARES, GATHERED = range(4)
DATA, CHARGE, SLOPE, RELAXATION = 0, 1, 2, 3
"""Where z keeps V₀ − V_m, C₀ x₁, C₀ and the first of q; the current is its last entry."""

CALM = 1.0
"""Sum of the diagonal of Γ·H·dt up to which the plain step is taken: it is stable below two."""


class GpcModel(NamedTuple):
    """What stays the same from row to row.

    ``rates`` (N,) and ``to_basis`` (N, N) are the relaxation at Gauss's nodes and what makes q of it; ``rate_middle``
    and ``rate_half`` are σ₀ and σ₁; ``gains`` (5,) is the diagonal of Γ; ``log_forgetting`` is ln λ; ``step_s`` is the
    usual time between rows; between ``lowest`` and ``highest`` (5,) the parameters are kept.
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

    ``theta`` (5,): α, R, β, ξ, x₁₀. ``moments`` (N + 4, N + 4): the upper half of S. ``nodes`` (N,): x₂ at Gauss's
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

    Returns the row at which the parameters left what is possible (not finite, a capacity or capacitance that isn't
    positive), or -1.
    """
    terms = len(model.rates)
    size = terms + 4
    theta, nodes, moments, cut, scalars = state.theta, state.nodes, state.moments, state.cut, state.scalars
    phi, slopes, q, z = np.empty(terms), np.empty(terms), np.empty(terms), np.empty(size)
    gradient, hessian = np.empty(COUNT), np.empty((COUNT, COUNT))
    decays, gathered = np.empty(terms), np.empty(terms)
    last_dt, forget = -1.0, 1.0
    kept = np.searchsorted(rows.keep, begin)
    n = len(rows.t_s)
    for k in range(begin, end):
        current = rows.current_a[k]
        driven = current * rows.resistance_factor[k % len(rows.resistance_factor)]
        fill_legendre(theta[XI], phi, slopes)
        relaxation = 0.0
        for i in range(terms):
            q[i] = 0.0
            for j in range(terms):
                q[i] += model.to_basis[i, j] * nodes[j]
            relaxation += phi[i] * q[i]
        soc = theta[ALPHA] * (theta[X10] + scalars[X1])
        volts, slope = open_circuit(model.pieces, soc)
        residual = rows.voltage_v[k] - (volts + theta[BETA] * relaxation + theta[R] * driven)
        out.residual_v[k] = residual
        dt = rows.t_s[k + 1] - rows.t_s[k] if k + 1 < n else model.step_s
        weight = min(dt, model.step_s)
        if k >= rows.first and np.isfinite(residual):
            left_out = theta[BETA] * (scalars[X2] - relaxation)
            z[DATA] = volts - slope * soc - rows.voltage_v[k]
            z[CHARGE] = slope * scalars[X1]
            z[SLOPE] = slope
            z[RELAXATION : size - 1] = q
            z[size - 1] = driven
            for i in range(size):
                for j in range(i, size):
                    moments[i, j] += weight * z[i] * z[j]
                cut[i] += weight * z[i] * left_out
            scalars[SQUARES] += weight * residual * residual
            scalars[GATHERED] += weight
            _step(model, theta, moments, phi, slopes, weight, gradient, hessian)
            out.learnt[k] = True
            if not (np.all(np.isfinite(theta)) and theta[ALPHA] > 0.0 and theta[BETA] > 0.0):
                return k
        if kept < len(rows.keep) and rows.keep[kept] == k:
            out.theta[kept] = theta
            out.charge[kept] = scalars[X1]
            out.q[kept] = q
            out.moments[kept] = moments
            out.cut[kept] = cut
            out.scalars[kept] = scalars
            kept += 1
        if dt != last_dt:
            last_dt, forget = dt, np.exp(model.log_forgetting * dt)
            for j in range(terms):
                decays[j] = np.exp(-model.rates[j] * dt)
                gathered[j] = -np.expm1(-model.rates[j] * dt) / model.rates[j]
        scalars[X1] += current * dt / rows.capacity_factor[k % len(rows.capacity_factor)]
        through = current * rows.relaxation_factor[k % len(rows.relaxation_factor)]
        for j in range(terms):
            nodes[j] = decays[j] * nodes[j] + gathered[j] * through
        rate = model.rate_middle + theta[XI] * model.rate_half
        decay = np.exp(-rate * dt)
        scalars[X2] = decay * scalars[X2] + (1.0 - decay) / rate * through
        for i in range(size):
            for j in range(i, size):
                moments[i, j] *= forget
            cut[i] *= forget
        scalars[SQUARES] *= forget
        scalars[GATHERED] *= forget
    return -1


@inline_kernel
def _step(
    model: GpcModel,
    theta: FloatArray,
    moments: FloatArray,
    phi: FloatArray,
    slopes: FloatArray,
    dt: float,
    gradient: FloatArray,
    hessian: FloatArray,
) -> None:
    """Move the parameters down the gradient for ``dt`` (MAUTC-2010-02, eqs 80 to 85), in place.

    Where the moments are so large that the plain step would swing or run away, the same law is stepped implicitly.
    """
    terms, size = len(phi), len(moments)
    alpha, beta, x10 = theta[ALPHA], theta[BETA], theta[X10]
    su = np.empty(size)
    for i in range(size):
        su[i] = _entry(moments, i, DATA) + alpha * (_entry(moments, i, CHARGE) + x10 * _entry(moments, i, SLOPE))
        su[i] += theta[R] * _entry(moments, i, size - 1)
        for j in range(terms):
            su[i] += beta * phi[j] * _entry(moments, i, RELAXATION + j)
    gradient[ALPHA] = su[CHARGE] + x10 * su[SLOPE]
    gradient[R] = su[size - 1]
    gradient[X10] = alpha * su[SLOPE]
    gradient[BETA], gradient[XI] = 0.0, 0.0
    curved_beta, curved_xi = 0.0, 0.0
    for i in range(terms):
        gradient[BETA] += phi[i] * su[RELAXATION + i]
        gradient[XI] += beta * slopes[i] * su[RELAXATION + i]
        for j in range(terms):
            moment = _entry(moments, RELAXATION + i, RELAXATION + j)
            curved_beta += phi[i] * phi[j] * moment
            curved_xi += beta * beta * slopes[i] * slopes[j] * moment
    both = moments[CHARGE, CHARGE] + x10 * (2.0 * moments[CHARGE, SLOPE] + x10 * moments[SLOPE, SLOPE])
    steep = model.gains[ALPHA] * both + model.gains[R] * moments[size - 1, size - 1]
    steep += model.gains[X10] * alpha * alpha * moments[SLOPE, SLOPE]
    steep += model.gains[BETA] * curved_beta + model.gains[XI] * curved_xi
    if steep * dt <= CALM:
        for i in range(COUNT):
            theta[i] -= dt * model.gains[i] * gradient[i]
    else:
        _fill_hessian(theta, moments, phi, slopes, hessian)
        _implicit(model.gains, hessian, gradient, dt, theta)
    for i in range(COUNT):
        theta[i] = min(max(theta[i], model.lowest[i]), model.highest[i])


@inline_kernel
def _entry(moments: FloatArray, i: int, j: int) -> float:
    """Return an entry of the moments, of which only the upper half is kept."""
    return float(moments[min(i, j), max(i, j)])


@inline_kernel
def _fill_hessian(
    theta: FloatArray, moments: FloatArray, phi: FloatArray, slopes: FloatArray, hessian: FloatArray
) -> None:
    """Fill ``hessian`` (5, 5) with D S Dᵀ, where D holds the derivatives of u by the parameters."""
    terms, size = len(phi), len(moments)
    by = np.zeros((COUNT, size))
    by[ALPHA, CHARGE], by[ALPHA, SLOPE] = 1.0, theta[X10]
    by[R, size - 1] = 1.0
    by[X10, SLOPE] = theta[ALPHA]
    for i in range(terms):
        by[BETA, RELAXATION + i] = phi[i]
        by[XI, RELAXATION + i] = theta[BETA] * slopes[i]
    for a in range(COUNT):
        for b in range(a, COUNT):
            total = 0.0
            for i in range(size):
                for j in range(size):
                    total += by[a, i] * by[b, j] * _entry(moments, i, j)
            hessian[a, b], hessian[b, a] = total, total


@inline_kernel
def _implicit(gains: FloatArray, hessian: FloatArray, gradient: FloatArray, dt: float, theta: FloatArray) -> None:
    """Take one linearly implicit step of θ' = −Γ ∇J, stable for any Γ: (1 + dt √Γ H √Γ) y = −dt √Γ ∇J, Δθ = √Γ y."""
    lower = np.zeros((COUNT, COUNT))
    y = np.empty(COUNT)
    for i in range(COUNT):
        root = np.sqrt(gains[i])
        for j in range(i + 1):
            total = dt * root * hessian[i, j] * np.sqrt(gains[j]) + (1.0 if i == j else 0.0)
            for m in range(j):
                total -= lower[i, m] * lower[j, m]
            lower[i, j] = np.sqrt(total) if i == j else total / lower[j, j]
        y[i] = -dt * root * gradient[i]
        for m in range(i):
            y[i] -= lower[i, m] * y[m]
        y[i] /= lower[i, i]
    for i in range(COUNT - 1, -1, -1):
        for m in range(i + 1, COUNT):
            y[i] -= lower[m, i] * y[m]
        y[i] /= lower[i, i]
        theta[i] += np.sqrt(gains[i]) * y[i]
