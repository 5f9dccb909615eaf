"""Months of driving and charging in one loop: the current depends on the charge, and the charge on what is left."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from app.science.arrays import FloatArray
from app.science.battery.curve import CurvePieces
from app.science.battery.curve_kernels import open_circuit
from app.science.battery.simulate_kernels import CellNumbers, RowFactors, factor_at, next_hysteresis
from app.science.jit import inline_kernel, kernel

LEAST_CAPACITY = 0.01
"""Share of its first capacity at which a cell stops ageing: it is long dead, and divisions stay finite."""


class Routine(NamedTuple):
    """What is done with the cell over and over."""

    drive_a: FloatArray
    """Current of each step of one drive, which begins anew after its last."""

    charge_a: float
    lowest: float
    highest: float
    """States of charge at which charging begins, and ends."""

    step_s: float


class LossTable(NamedTuple):
    """A degradation map as kernels take it; without rows nothing is lost."""

    current_a: FloatArray
    over_soc: bool
    at: FloatArray
    loss: FloatArray


@inline_kernel
def place(points: FloatArray, value: float) -> tuple[int, int, float]:
    """Return the points around a value, and how far it is from the first to the second."""
    last = len(points) - 1
    if value <= points[0]:
        return 0, 0, 0.0
    if value >= points[last]:
        return last, last, 0.0
    k = int(np.searchsorted(points, value, side="right")) - 1
    return k, k + 1, float((value - points[k]) / (points[k + 1] - points[k]))


@inline_kernel
def loss_per_ah(table: LossTable, current_a: float, at: float) -> float:
    """Return the map's loss, bilinear inside and that of the nearest edge outside."""
    row, next_row, down = place(table.current_a, current_a)
    column, next_column, right = place(table.at, at)
    above = table.loss[row, column] * (1.0 - right) + table.loss[row, next_column] * right
    below = table.loss[next_row, column] * (1.0 - right) + table.loss[next_row, next_column] * right
    return float(above * (1.0 - down) + below * down)


@kernel
def cycle_cell(
    pieces: CurvePieces,
    cell: CellNumbers,
    factors: RowFactors,
    routine: Routine,
    losses: LossTable,
    soc: float,
    rows: int,
) -> tuple[FloatArray, FloatArray, FloatArray, FloatArray]:
    """Return current, voltage, state of charge and capacity (A·s) of one cell at each row, beginning with a drive.

    The capacity is that at the reference temperature.
    """
    currents, voltages, socs, capacities = np.empty(rows), np.empty(rows), np.empty(rows), np.empty(rows)
    decay = np.exp(-routine.step_s / cell.time_constant_s)
    capacity, relaxation, state, charging, second = cell.capacity_as, 0.0, 0.0, False, 0
    for k in range(rows):
        if charging and soc >= routine.highest:
            charging, second = False, 0
        elif not charging and soc <= routine.lowest:
            charging = True
        current = routine.charge_a if charging else routine.drive_a[second]
        rest = open_circuit(pieces, soc)[0] + cell.hysteresis_v * state
        voltage = rest + relaxation + cell.resistance_ohm * factor_at(factors.resistance, k) * current
        currents[k], voltages[k], socs[k], capacities[k] = current, voltage, soc, capacity
        moved = current * routine.step_s / (capacity * factor_at(factors.capacity, k))
        soc += moved
        if cell.hysteresis_rate > 0.0:
            state = next_hysteresis(state, current, abs(moved), cell.hysteresis_rate)
        end = cell.relaxation_resistance_ohm * factor_at(factors.relaxation, k) * current
        relaxation = end + (relaxation - end) * decay
        second = (second + 1) % len(routine.drive_a)
        if len(losses.loss) > 0:
            at = socs[k] if losses.over_soc else voltage
            lost = loss_per_ah(losses, current, at) * abs(current) * routine.step_s
            capacity = max(capacity - lost, LEAST_CAPACITY * cell.capacity_as)
    return currents, voltages, socs, capacities
