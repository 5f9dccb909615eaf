"""A table over engine speed and torque as a polynomial that is nowhere below zero."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from app.science.arrays import FloatArray
from app.science.optimal.costs.weighted import bilinear
from app.science.optimal.fuel_checks import full_load_nm
from app.science.optimal.problem import RADPS_PER_RPM, PolynomialEngine

HIGHEST_POWER = 5
"""Of engine speed or torque; compiled solvers keep that many coefficients."""
LOOKS = 61
CLOSE = 1e-4
"""Of the largest value: a formula that misses nowhere by more needs no more terms."""
ROUNDS, PRESSURE = 30, 30.0


@dataclass(frozen=True, slots=True)
class Formula:
    """Σ c ωⁱ Tᵏ with ω in rad/s and T in Nm, and how far it is from its table: rms and largest."""

    terms: tuple[tuple[int, int], ...]
    coefficients: tuple[float, ...]
    rms: float
    largest: float


def fit_table(rpm: tuple[float, ...], nm: tuple[float, ...], table: FloatArray, engine: PolynomialEngine) -> Formula:
    """Fit a table with the fewest powers that follow it, up to the fifth of each variable.

    Least squares on an even grid over the engine's field, below full load, to the table's bilinear surface. Where the
    formula would be below zero it is pressed to zero by weight, and what is left is lifted.

    Parameters
    ----------
    rpm, nm : tuple of float, shapes (n,) and (m,)
    table : array, shape (n, m)
        None below zero; covers the engine's field.
    engine : PolynomialEngine
    """
    speed = np.linspace(*engine.speed_rpm, LOOKS)[:, None]
    top = full_load_nm(engine, speed)
    torque = engine.torque_nm[0] + np.linspace(0.0, 1.0, LOOKS) * np.maximum(top - engine.torque_nm[0], 0.0)
    omega = np.broadcast_to(speed * RADPS_PER_RPM, torque.shape).ravel()
    torque = torque.ravel()
    wanted = bilinear(rpm, nm, table, omega / RADPS_PER_RPM, torque)
    return fit_points(omega, torque, wanted, np.ones(wanted.shape))


def fit_points(omega: FloatArray, torque: FloatArray, wanted: FloatArray, scale: FloatArray) -> Formula:
    """Fit points with the fewest powers that follow them, up to the fifth of each variable.

    Parameters
    ----------
    omega, torque, wanted : array, shape (n,)
        Engine speeds (rad/s), torques (Nm), and what the formula is to give there, not below zero.
    scale : array, shape (n,)
        What a miss is counted in: ones, or the values themselves where shares matter. `Formula.rms` and
        `Formula.largest` count in it, too.
    """
    close = CLOSE * float(np.abs(wanted / scale).max())
    best = _of_power(0, omega, torque, wanted, scale)
    for power in range(1, HIGHEST_POWER + 1):
        if best.largest <= close:
            break
        best = min(best, _of_power(power, omega, torque, wanted, scale), key=lambda one: one.rms)
    return best


def _of_power(power: int, omega: FloatArray, torque: FloatArray, wanted: FloatArray, scale: FloatArray) -> Formula:
    """Fit all terms up to a power of either variable."""
    terms = tuple((i, k) for i in range(power + 1) for k in range(power + 1))
    (x, to_omega), (y, to_torque) = (_centred(values, power) for values in (omega, torque))
    columns = np.column_stack([x[:, i] * y[:, k] for i, k in terms])
    inner = _pressed(columns / scale[:, None], wanted / scale)
    outer = to_omega.T @ inner.reshape(power + 1, power + 1) @ to_torque
    coefficients = outer.ravel()
    value = np.zeros(omega.shape)
    for (i, k), c in zip(terms, coefficients, strict=True):
        value += c * omega**i * torque**k
    lift = max(-float(value.min()), 0.0) * (1.0 + 1e-6)
    coefficients[0] += lift
    miss = (value + lift - wanted) / scale
    return Formula(terms, tuple(coefficients.tolist()), float(np.sqrt(np.mean(miss**2))), float(np.abs(miss).max()))


def _centred(values: FloatArray, power: int) -> tuple[FloatArray, FloatArray]:
    """Return powers of a variable moved to −1…1, shape (n, power + 1), and what each is in the variable's own."""
    middle, half = 0.5 * (values.max() + values.min()), 0.5 * np.ptp(values) or 1.0
    rows = np.zeros((power + 1, power + 1))
    row = np.ones(1)
    for k in range(power + 1):
        rows[k, : len(row)] = row
        row = np.convolve(row, [-middle / half, 1.0 / half])
    return ((values - middle) / half)[:, None] ** np.arange(power + 1), rows


def _pressed(columns: FloatArray, wanted: FloatArray) -> FloatArray:
    """Return least-squares coefficients; where the fit is below zero, that counts a good deal more than the miss."""
    found = np.linalg.lstsq(columns, wanted, rcond=None)[0]
    below = columns @ found < 0.0
    square, aim = columns.T @ columns, columns.T @ wanted
    for _ in range(ROUNDS):
        if not below.any():
            break
        found = np.linalg.solve(square + PRESSURE**2 * (columns[below].T @ columns[below]), aim)
        now = columns @ found < 0.0
        if (now == below).all():
            break
        below = now
    return np.asarray(found)
