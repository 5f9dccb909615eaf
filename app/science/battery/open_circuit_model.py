"""The regression behind open-circuit curves: a rising curve, a resistance, and relaxations of fixed time constants."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace

import numpy as np

from app.science.arrays import FloatArray
from app.science.battery.circuit import Circuit
from app.science.battery.open_circuit_places import Placed
from app.science.battery.strokes import strokes

KNOTS: FloatArray = np.unique(
    np.round([0.005, 0.015, *np.linspace(0.0, 0.1, 11), *np.linspace(0.1, 0.9, 33), *np.linspace(0.9, 1.0, 11)], 4)
).astype(np.float64)
"""States of charge between which the curve is a straight line: narrower where curves bend."""

COARSE = np.array([0.0, 0.05, 0.15, 0.3, 0.6, 0.9, 1.0])
"""States of charge between which resistances change along a straight line."""

TIME_CONSTANTS_S = (0.0, 20.0, 120.0, 700.0, 4000.0)
"""Of the relaxations; the first is the series resistance, which follows at once.

Where the current never turns and never rests, a slow relaxation can't be told from the curve; those slower than the
longest rest are then left out."""

LONGEST_S = 60.0
"""Most that one row counts, as the time up to its next row."""

STIFFNESS = 1e-9
"""How much the curve's change of slope counts against the misfit."""

RESTRAINT = 1e-5
"""How much the change of a resistance with the state of charge counts against the misfit."""

ABSOLUTE = 0.03
"""How much a resistance itself counts, as a share of what its change does: what a curve and a resistance explain
equally well is taken to be the curve."""

OVER = 1e-4
"""By which rows may lie beyond an end: what a discharge takes out below its end is no longer on the curve."""

HUBER = 3.0
"""Multiples of the usual misfit from which on a row counts less."""

LEAST_SCALE_V = 1e-3
"""The usual misfit, at least."""

ROUNDS = 4

LEAST_SWEEP = 0.03
"""State of charge through which one charge or discharge must move to be more than a pulse."""

MOST_ROWS = 100_000
"""Of a record that are fitted to; of longer ones every few rows, after all have gone through the lags."""

BLOCK = 20_000
"""Rows of the regression made at once."""


@dataclass(frozen=True, slots=True)
class Regression:
    """What the data say.

    Attributes
    ----------
    volts : ndarray (len(KNOTS),)
        The curve at the knots.
    resistance_ohm : ndarray (len(TIME_CONSTANTS_S), len(COARSE))
        Of the series resistance and of each relaxation.
    seconds : ndarray (len(KNOTS),)
        Time that the data spent around each knot.
    misfit_v : float
        Root mean square of what stays unexplained.
    """

    volts: FloatArray
    resistance_ohm: FloatArray
    seconds: FloatArray
    misfit_v: float


def regress(placed: Sequence[Placed], *, curve_only: bool = False) -> Regression:
    """Fit curve and resistances to records of one cell, with nothing negative: the curve rises, nothing gives energy.

    The voltage is V = U(z) + Σ_j r_j(z) x_j with x_j the current through a first-order lag of time constant τ_j. Rows
    that fit badly count less (Huber 1964): the knee below a few percent is steeper than any resistance explains. With
    ``curve_only`` all resistances are zero.
    """
    fitted, scale_v = np.empty(0), np.inf
    usable = 0 if curve_only else _usable(placed)
    ready = [_ready(one) for one in placed]
    for _ in range(ROUNDS):
        sums = _sums(ready, fitted, scale_v)
        fitted = _solved(sums, usable)
        left = np.concatenate(list(_misfits(ready, fitted)))
        scale_v = max(1.4826 * float(np.median(left)), LEAST_SCALE_V)
    resistances = fitted[len(KNOTS) :].reshape(len(TIME_CONSTANTS_S), len(COARSE))
    return Regression(fitted[: len(KNOTS)], resistances, sums.seconds, float(np.sqrt(np.mean(left**2))))


@dataclass(frozen=True, slots=True)
class _Sums:
    matrix: FloatArray
    right: FloatArray
    seconds: FloatArray
    largest_a: float


def _sums(ready: Sequence[_Ready], fitted: FloatArray, scale_v: float) -> _Sums:
    size = len(KNOTS) + len(TIME_CONSTANTS_S) * len(COARSE)
    matrix, right, seconds = np.zeros((size, size)), np.zeros(size), np.zeros(len(KNOTS))
    total, largest_a = 0.0, 0.0
    for rows, volts, since_s in _blocks(ready):
        weights = since_s
        if len(fitted):
            weights = since_s / np.maximum(np.abs(volts - rows @ fitted) / (HUBER * scale_v), 1.0)
        weighted = rows * weights[:, None]
        matrix += weighted.T @ rows
        right += weighted.T @ volts
        total += float(weights.sum())
        seconds += since_s @ rows[:, : len(KNOTS)]
        largest_a = max(largest_a, float(np.abs(rows[:, len(KNOTS) :]).max()))
    return _Sums(matrix / total, right / total, seconds, largest_a)


def _usable(placed: Sequence[Placed]) -> int:
    """Return how many of the time constants the data can tell from the curve."""
    directions, rest_s = set(), 0.0
    for one in placed:
        inside = (one.soc >= 0.0) & (one.soc <= 1.0)
        for stroke in strokes(one.record):
            rows = slice(stroke.begin, stroke.end)
            if not inside[rows].any():
                continue
            if stroke.direction == 0:
                rest_s = max(rest_s, float(np.ptp(one.record.t_s[rows])))
            elif np.ptp(one.soc[rows]) >= LEAST_SWEEP:
                directions.add(stroke.direction)
    return len(TIME_CONSTANTS_S) if len(directions) == 2 else sum(tau_s <= rest_s for tau_s in TIME_CONSTANTS_S)


def _solved(sums: _Sums, usable: int) -> FloatArray:
    """Solve for non-negative unknowns: the curve's rises from knot to knot, and resistances (Lawson, Hanson 1974)."""
    from scipy.linalg import cholesky, solve_triangular
    from scipy.optimize import nnls

    knots = len(KNOTS)
    size = knots + usable * len(COARSE)
    change = np.eye(size)
    change[:knots, :knots] = np.tril(np.ones((knots, knots)))
    unknown = change.T @ (sums.matrix + _restraint(sums.largest_a))[:size, :size] @ change
    unknown += 1e-12 * np.eye(size) * np.trace(unknown) / size
    upper = cholesky(unknown)
    solved = nnls(upper, solve_triangular(upper, change.T @ sums.right[:size], trans="T"), maxiter=50 * size)[0]
    fitted = np.zeros(len(sums.right))
    fitted[:size] = change @ solved
    return fitted


def _misfits(ready: Sequence[_Ready], fitted: FloatArray) -> Iterator[FloatArray]:
    for rows, volts, _ in _blocks(ready):
        yield np.abs(volts - rows @ fitted)


def without(placed: Placed, circuit: Circuit) -> Placed:
    """Return a record less what a circuit's resistances do to its voltage."""
    record = placed.record
    duration_s = np.diff(record.t_s, append=record.t_s[-1] + 1.0)
    relaxed = circuit.relaxation_resistance_ohm * _lag(record.current_a, duration_s, circuit.time_constant_s)
    left = record.voltage_v - circuit.resistance_ohm * record.current_a - relaxed
    return replace(placed, record=replace(record, voltage_v=left))


def hats(knots: FloatArray, soc: FloatArray) -> FloatArray:
    """Return the shares (n, len(knots)) with which values at knots make a value at each state of charge."""
    inside = np.clip(soc, knots[0], knots[-1])
    right = np.clip(np.searchsorted(knots, inside, side="right"), 1, len(knots) - 1)
    share = (inside - knots[right - 1]) / (knots[right] - knots[right - 1])
    made = np.zeros((len(soc), len(knots)))
    rows = np.arange(len(soc))
    made[rows, right - 1] = 1.0 - share
    made[rows, right] = share
    return made


@dataclass(frozen=True, slots=True)
class _Ready:
    """Rows of a record with a voltage inside the curve: what flows through each lag, and how long they count."""

    lagged: FloatArray
    soc: FloatArray
    voltage_v: FloatArray
    since_s: FloatArray


def _ready(placed: Placed) -> _Ready:
    record = placed.record
    duration_s = np.diff(record.t_s, append=record.t_s[-1] + 1.0)
    rows = np.flatnonzero(np.isfinite(record.voltage_v) & (placed.soc >= -OVER) & (placed.soc <= 1.0 + OVER))
    rows = rows[:: 1 + len(rows) // MOST_ROWS]
    lagged = np.column_stack([_lag(record.current_a, duration_s, tau_s)[rows] for tau_s in TIME_CONSTANTS_S])
    since_s = np.clip(np.diff(record.t_s[rows], prepend=record.t_s[0]), 0.1, LONGEST_S)
    return _Ready(lagged, placed.soc[rows], record.voltage_v[rows], since_s)


def _blocks(ready: Sequence[_Ready]) -> Iterator[tuple[FloatArray, FloatArray, FloatArray]]:
    for one in ready:
        for begin in range(0, len(one.soc), BLOCK):
            rows = slice(begin, begin + BLOCK)
            coarse = hats(COARSE, one.soc[rows])
            resisted = (one.lagged[rows][:, :, None] * coarse[:, None, :]).reshape(len(coarse), -1)
            made = np.concatenate((hats(KNOTS, one.soc[rows]), resisted), axis=1)
            yield made, one.voltage_v[rows], one.since_s[rows]


def _lag(current: FloatArray, duration_s: FloatArray, tau_s: float) -> FloatArray:
    if tau_s == 0.0:
        return current
    kept = np.exp(-duration_s / tau_s)
    lagged, level = np.empty_like(current), 0.0
    for row, (share, flowing) in enumerate(zip(kept.tolist(), current.tolist(), strict=True)):
        lagged[row] = level
        level = share * level + (1.0 - share) * flowing
    return lagged


def _restraint(largest_a: float) -> FloatArray:
    knots, coarse = len(KNOTS), len(COARSE)
    size = knots + len(TIME_CONSTANTS_S) * coarse
    bend = np.zeros((knots - 2, size))
    for row in range(knots - 2):
        left, right = KNOTS[row + 1] - KNOTS[row], KNOTS[row + 2] - KNOTS[row + 1]
        bend[row, row : row + 3] = 1.0 / left, -1.0 / left - 1.0 / right, 1.0 / right
    restraint = STIFFNESS * (bend.T @ bend) / knots
    for pair in range(len(TIME_CONSTANTS_S)):
        here = slice(knots + pair * coarse, knots + (pair + 1) * coarse)
        steps = np.diff(np.eye(coarse), axis=0)
        restraint[here, here] += RESTRAINT * largest_a**2 * (steps.T @ steps + ABSOLUTE * np.eye(coarse))
    return restraint
