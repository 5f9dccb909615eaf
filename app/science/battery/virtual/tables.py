"""A cell whose resistances and capacitance depend on temperature, current and charge, given as tables."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from app.science.arrays import FloatArray
from app.science.battery.circuit import AS_PER_AH
from app.science.battery.curve import OpenCircuit, voltage_at
from app.science.battery.simulate import Simulated


@dataclass(frozen=True, slots=True)
class TableCell:
    """One cell of MAUTC-2010-02, eqs 55 and 56, with parameters that are no constants.

    Between the tables' points everything is linear, outside of them as at the nearest edge.

    Attributes
    ----------
    curve : OpenCircuit
    capacity_ah : float
    temperature_c, current_a, soc : ndarray (p,), (q,), (r,)
        Where the tables' values are, ascending; charging is positive.
    resistance_ohm, relaxation_resistance_ohm, relaxation_capacitance_f : ndarray (p, q, r)
    """

    curve: OpenCircuit
    capacity_ah: float
    temperature_c: FloatArray
    current_a: FloatArray
    soc: FloatArray
    resistance_ohm: FloatArray
    relaxation_resistance_ohm: FloatArray
    relaxation_capacitance_f: FloatArray


@dataclass(frozen=True, slots=True)
class TableTruth:
    """What a cell of tables did, and what its parameters were at each row.

    Attributes
    ----------
    simulated : Simulated
    resistance_ohm, relaxation_resistance_ohm, relaxation_capacitance_f : ndarray (n,)
    """

    simulated: Simulated
    resistance_ohm: FloatArray
    relaxation_resistance_ohm: FloatArray
    relaxation_capacitance_f: FloatArray


def simulate_tables(
    cell: TableCell, t_s: FloatArray, current_a: FloatArray, temperature_c: FloatArray | float, soc: float
) -> TableTruth:
    """Run a cell over a current, from rest; each row's current and parameters hold to the next row.

    Parameters
    ----------
    cell : TableCell
    t_s, current_a : ndarray (n,)
        Seconds, ascending, and amperes; charging is positive.
    temperature_c : ndarray (n,) or float
    soc : float
        At the first row.

    Returns
    -------
    TableTruth
    """
    widths = np.diff(t_s)
    moved = np.append(0.0, np.cumsum(current_a[:-1] * widths)) / (AS_PER_AH * cell.capacity_ah)
    charge = soc + moved
    at = _inside(cell, np.column_stack([np.broadcast_to(temperature_c, len(t_s)), current_a, charge]))
    series, pair = _looked_up(cell, cell.resistance_ohm, at), _looked_up(cell, cell.relaxation_resistance_ohm, at)
    capacitance = _looked_up(cell, cell.relaxation_capacitance_f, at)
    decay = np.exp(-widths / (pair * capacitance)[:-1])
    relaxation, end = np.zeros(len(t_s)), pair * current_a
    for k, kept in enumerate(decay):
        relaxation[k + 1] = end[k] + (relaxation[k] - end[k]) * kept
    volts = voltage_at(cell.curve.pieces, charge) + relaxation + series * current_a
    return TableTruth(Simulated(volts, charge, relaxation, np.zeros(len(t_s))), series, pair, capacitance)


def _inside(cell: TableCell, at: FloatArray) -> FloatArray:
    axes = (cell.temperature_c, cell.current_a, cell.soc)
    return np.clip(at, [axis[0] for axis in axes], [axis[-1] for axis in axes])


def _looked_up(cell: TableCell, table: FloatArray, at: FloatArray) -> FloatArray:
    from scipy.interpolate import RegularGridInterpolator

    return np.asarray(RegularGridInterpolator((cell.temperature_c, cell.current_a, cell.soc), table)(at))
