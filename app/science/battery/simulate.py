"""The model run forwards: what voltage a pack would show for a current (MAUTC-2010-02, eqs 55 and 56)."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from app.science.arrays import FloatArray
from app.science.battery.circuit import Cell, Warmth
from app.science.battery.pack import warmth_factors
from app.science.battery.simulate_kernels import CellNumbers, RowFactors, simulate_cell


@dataclass(frozen=True, slots=True)
class Simulated:
    """What a pack does, row by row; a row's voltage is at its own time, before its current has moved anything.

    Attributes
    ----------
    voltage_v : ndarray (n,)
        Of the pack.
    soc : ndarray (n,)
    relaxation_v : ndarray (n,)
        Over the relaxation pair of one cell.
    hysteresis : ndarray (n,)
        State from −1, after discharging, to 1, after charging; zero for cells without.
    """

    voltage_v: FloatArray
    soc: FloatArray
    relaxation_v: FloatArray
    hysteresis: FloatArray


def simulate(cell: Cell, t_s: FloatArray, current_a: FloatArray, temperature_c: FloatArray | None = None) -> Simulated:
    """Run a pack over a current, from rest and from the cell's own state of charge.

    Each current holds from its row to the next one's, and the recurrences are exact for that, however far apart the
    rows are.

    Parameters
    ----------
    cell : Cell
    t_s : ndarray (n,)
        Strictly ascending, seconds.
    current_a : ndarray (n,)
        Of the pack; charging is positive.
    temperature_c : ndarray (n,) or None
        °C; None: the temperature at which the circuit's values hold.

    Returns
    -------
    Simulated
    """
    voltage, soc, relaxation, hysteresis = simulate_cell(
        cell.curve.pieces,
        cell_numbers(cell),
        row_factors(cell.warmth, temperature_c),
        cell.soc,
        np.ascontiguousarray(t_s, dtype=np.float64),
        np.asarray(current_a, dtype=np.float64) / cell.parallel,
    )
    return Simulated(cell.series * voltage, soc, relaxation, hysteresis)


def row_factors(warmth: Warmth | None, temperature_c: FloatArray | None) -> RowFactors:
    """Return what temperature does to a cell, as kernels take it."""
    factors = warmth_factors(warmth, temperature_c)
    return RowFactors(factors.resistance, factors.relaxation, factors.capacity)


def cell_numbers(cell: Cell) -> CellNumbers:
    """Return a cell as kernels take it."""
    circuit, hysteresis = cell.circuit, cell.hysteresis
    return CellNumbers(
        capacity_as=circuit.capacity_as,
        resistance_ohm=circuit.resistance_ohm,
        relaxation_resistance_ohm=circuit.relaxation_resistance_ohm,
        time_constant_s=circuit.time_constant_s,
        hysteresis_v=0.0 if hysteresis is None else hysteresis.voltage_v,
        hysteresis_rate=0.0 if hysteresis is None else hysteresis.rate,
    )
