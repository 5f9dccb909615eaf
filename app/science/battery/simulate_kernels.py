"""The cell's recurrences inside hot loops: exact for a current that holds from one row to the next."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from app.science.arrays import FloatArray
from app.science.battery.curve import CurvePieces
from app.science.battery.curve_kernels import open_circuit
from app.science.battery.kalman.steady_kernels import steadied
from app.science.jit import inline_kernel, kernel

NOISE_ONLY = 3.0
"""Standard deviations of a mean current up to which it may be none."""


class CellNumbers(NamedTuple):
    """A cell as kernels take it, at its reference temperature."""

    capacity_as: float
    resistance_ohm: float
    relaxation_resistance_ohm: float
    time_constant_s: float
    hysteresis_v: float
    hysteresis_rate: float


class RowFactors(NamedTuple):
    """What a cell's values are multiplied with at each row, (n,), or (1,) where that never changes."""

    resistance: FloatArray
    relaxation: FloatArray
    capacity: FloatArray


@inline_kernel
def factor_at(factors: FloatArray, k: int) -> float:
    """Return a row's factor."""
    return float(factors[k] if len(factors) > 1 else factors[0])


@inline_kernel
def next_hysteresis(state: float, current_a: float, moved: float, rate: float) -> float:
    """Return the hysteresis state after ``moved`` of the whole capacity has gone one way."""
    if moved == 0.0:
        return state
    direction = 1.0 if current_a > 0.0 else -1.0
    return float(direction + (state - direction) * np.exp(-rate * moved))


@kernel
def hysteresis_states(
    t_s: FloatArray, current_a: FloatArray, capacity_as: FloatArray, rate: float, noise_a: float
) -> FloatArray:
    """Return the hysteresis state at each row, beginning in the middle; the capacity is (n,), or (1,) and the same.

    While a battery rests, the noise of its measured current would turn the state to and fro until it forgot where it
    was. So a current goes by the mean of the rows in which it is steady, and by nothing where that may be noise.
    """
    states = np.zeros(len(t_s))
    steady, rows = 0.0, 0.0
    for k in range(len(t_s) - 1):
        _quiet, steady, rows = steadied(current_a[k], steady, rows, noise_a * noise_a)
        current = steady if steady * steady * rows > NOISE_ONLY * NOISE_ONLY * noise_a * noise_a else 0.0
        moved = abs(current) * (t_s[k + 1] - t_s[k]) / factor_at(capacity_as, k)
        states[k + 1] = next_hysteresis(states[k], current, moved, rate)
    return states


@kernel
def simulate_cell(
    pieces: CurvePieces, cell: CellNumbers, factors: RowFactors, soc: float, t_s: FloatArray, current_a: FloatArray
) -> tuple[FloatArray, FloatArray, FloatArray, FloatArray]:
    """Return voltage, state of charge, relaxation voltage and hysteresis state of one cell at each row."""
    n = len(t_s)
    voltages, socs, relaxations, states = np.empty(n), np.empty(n), np.empty(n), np.empty(n)
    relaxation, state, width, decay = 0.0, 0.0, -1.0, 0.0
    for k in range(n):
        current = current_a[k]
        rest = open_circuit(pieces, soc)[0] + cell.hysteresis_v * state
        voltages[k] = rest + relaxation + cell.resistance_ohm * factor_at(factors.resistance, k) * current
        socs[k], relaxations[k], states[k] = soc, relaxation, state
        if k == n - 1:
            break
        if t_s[k + 1] - t_s[k] != width:
            width = t_s[k + 1] - t_s[k]
            decay = np.exp(-width / cell.time_constant_s)
        moved = current * width / (cell.capacity_as * factor_at(factors.capacity, k))
        soc += moved
        end = cell.relaxation_resistance_ohm * factor_at(factors.relaxation, k) * current
        relaxation = end + (relaxation - end) * decay
        if cell.hysteresis_rate > 0.0:
            state = next_hysteresis(state, current, abs(moved), cell.hysteresis_rate)
    return voltages, socs, relaxations, states
