"""The cell's recurrences inside hot loops: exact for a current that holds from one row to the next."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from app.science.arrays import FloatArray
from app.science.battery.curve import CurvePieces
from app.science.battery.curve_kernels import open_circuit
from app.science.jit import inline_kernel, kernel


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
    return factors[k] if len(factors) > 1 else factors[0]


@inline_kernel
def next_hysteresis(state: float, current_a: float, moved: float, rate: float) -> float:
    """Return the hysteresis state after ``moved`` of the whole capacity has gone one way."""
    if moved == 0.0:
        return state
    direction = 1.0 if current_a > 0.0 else -1.0
    return direction + (state - direction) * np.exp(-rate * moved)


@kernel
def hysteresis_states(t_s: FloatArray, current_a: FloatArray, capacity_as: FloatArray, rate: float) -> FloatArray:
    """Return the hysteresis state at each row, beginning in the middle; the capacity is (n,), or (1,) and the same."""
    states = np.zeros(len(t_s))
    for k in range(len(t_s) - 1):
        moved = abs(current_a[k]) * (t_s[k + 1] - t_s[k]) / factor_at(capacity_as, k)
        states[k + 1] = next_hysteresis(states[k], current_a[k], moved, rate)
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
