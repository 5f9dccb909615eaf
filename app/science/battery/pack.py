"""From a pack's measurements to one of its cells: shares of voltage and current, temperature, hysteresis."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from app.science.arrays import FloatArray, IntArray
from app.science.battery.circuit import AS_PER_AH, Warmth
from app.science.battery.config import BatteryConfig
from app.science.battery.record import BatteryRecord
from app.science.battery.run import CellRecord
from app.science.battery.sensor_noise import current_noise_a

ZERO_CELSIUS_K = 273.15
LEAST_CAPACITY = 0.05
"""Share of its capacity that a cell keeps however cold it is: a straight line would go below nothing."""


@dataclass(frozen=True, slots=True)
class WarmthFactors:
    """What R, R_r and Q are multiplied with at each row, (n,), or (1,) where that never changes."""

    resistance: FloatArray
    relaxation: FloatArray
    capacity: FloatArray


def warmth_factors(warmth: Warmth | None, temperature_c: FloatArray | None) -> WarmthFactors:
    """Return what temperature does to a cell; without a dependence or a temperature, nothing.

    Parameters
    ----------
    warmth : Warmth or None
    temperature_c : ndarray (n,) or None
        °C.

    Returns
    -------
    WarmthFactors
    """
    one = np.ones(1)
    if warmth is None or temperature_c is None:
        return WarmthFactors(one, one, one)
    reference = 1.0 / (warmth.reference_c + ZERO_CELSIUS_K)
    colder = 1.0 / (np.asarray(temperature_c, dtype=np.float64) + ZERO_CELSIUS_K) - reference
    capacity = 1.0 + warmth.capacity_per_k * (temperature_c - warmth.reference_c)
    return WarmthFactors(
        resistance=np.exp(warmth.resistance_k * colder),
        relaxation=np.exp(warmth.relaxation_k * colder),
        capacity=np.maximum(capacity, LEAST_CAPACITY),
    )


def cell_record(
    record: BatteryRecord,
    config: BatteryConfig,
    points: int = 2000,
    capacity_ah: float | None = None,
    bias_a: float = 0.0,
) -> CellRecord:
    """Return what happens to one cell of a pack.

    The hysteresis is followed from the current alone, from the middle at the first row: where it begins is not known,
    and is forgotten once a few percent of the capacity have moved.

    Parameters
    ----------
    record : BatteryRecord
        Of the pack.
    config : BatteryConfig
        Its cell says how many stand in series and side by side, and how they depend on temperature and direction.
    points : int
        Rows at most in the history, spread evenly over all rows.
    capacity_ah : float or None
        Of one cell, for following its hysteresis; None: as configured.
    bias_a : float
        What the sensor shows too much of one cell's current, for following its hysteresis: while a battery rests for
        days, an error would slowly turn it round.

    Returns
    -------
    CellRecord
    """
    cell = config.cell
    factors = warmth_factors(cell.warmth, record.temperature_c)
    current = record.current_a / cell.parallel
    voltage = record.voltage_v / cell.series
    if cell.hysteresis is not None:
        voltage = voltage - hysteresis_voltage(
            config, record.t_s, current - bias_a, factors.capacity * (capacity_ah or cell.circuit.capacity_ah)
        )
    return CellRecord(
        t_s=record.t_s,
        current_a=current,
        voltage_v=voltage,
        resistance_factor=factors.resistance,
        relaxation_factor=factors.relaxation,
        capacity_factor=factors.capacity,
        keep=spread(len(record.t_s), points),
    )


def hysteresis_voltage(
    config: BatteryConfig, t_s: FloatArray, current_a: FloatArray, capacity_ah: FloatArray
) -> FloatArray:
    """Return the voltage, (n,), that the direction of a cell's current adds to its open-circuit voltage.

    The capacity is that at each row, or (1,) where it never changes.
    """
    # Compiled code is loaded only by who has a cell with hysteresis: servers that show configurations don't.
    from app.science.battery.simulate_kernels import hysteresis_states

    cell = config.cell
    if cell.hysteresis is None:
        return np.zeros(len(t_s))
    noise_a = current_noise_a(current_a, config)
    states = hysteresis_states(t_s, current_a, AS_PER_AH * capacity_ah, cell.hysteresis.rate, noise_a)
    return np.asarray(cell.hysteresis.voltage_v * states)


def spread(rows: int, points: int) -> IntArray:
    """Return at most ``points`` of some rows, evenly spread, ascending, the first and the last among them."""
    if rows <= points:
        return np.arange(rows, dtype=np.int64)
    return np.round(np.linspace(0, rows - 1, max(points, 2))).astype(np.int64)
