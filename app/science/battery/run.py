"""What an estimator takes and gives: one interface for all of them."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

from app.science.arrays import BoolArray, FloatArray, IntArray
from app.science.battery.config import BatteryConfig
from app.science.progress import Progress


@dataclass(frozen=True, slots=True)
class CellRecord:
    """What happens to one cell of the pack, with everything known about it taken out of the estimator's way.

    Attributes
    ----------
    t_s : ndarray (n,)
    current_a : ndarray (n,)
        Of one cell; charging is positive.
    voltage_v : ndarray (n,)
        Of one cell, less its hysteresis; NaN where none is believed.
    resistance_factor, relaxation_factor, capacity_factor : ndarray (n,) or (1,)
        What R, R_r and Q are multiplied with at each row's temperature; one entry where that never changes. C_r is
        divided by the relaxation's factor, so that the time constant stays.
    keep : ndarray (m,)
        Rows whose estimates the history holds, ascending; the last row is one of them.
    """

    t_s: FloatArray
    current_a: FloatArray
    voltage_v: FloatArray
    resistance_factor: FloatArray
    relaxation_factor: FloatArray
    capacity_factor: FloatArray
    keep: IntArray


@dataclass(frozen=True, slots=True)
class Carry:
    """What is known of a cell when a record ends, to begin the next one with.

    Attributes
    ----------
    mean : ndarray (7,)
        ln capacity_as, ln R, ln C_r, ln R_r, state of charge, relaxation voltage (V), current bias (A).
    covariance : ndarray (7, 7)
    t_s : float
        When, in the record's own time.
    """

    mean: FloatArray
    covariance: FloatArray
    t_s: float


@dataclass(frozen=True, slots=True)
class Run:
    """What an estimator makes of a record, before anybody judges it.

    Attributes
    ----------
    values, sds : ndarray (m, 5)
        Estimates at the kept rows after these rows' voltages, in the order of `VALUES`, and standard deviations.
    bias_a, bias_sd_a : ndarray (m,)
        Error of the current sensor, for one cell; zero where the estimator knows none.
    relaxation_v : ndarray (m,)
        Voltage over the relaxation pair.
    residual_v : ndarray (n,)
        Measured less predicted voltage before the row was learnt from; NaN where there was none.
    residual_sd_v : ndarray (n,)
        Its standard deviation as predicted.
    learnt : ndarray (n,) of bool
        Rows that were learnt from: false where there is no voltage, before the start, or where it was not believed.
    voltage_noise_v : float
        Standard deviation of the voltage's noise that the estimator came to believe in.
    carry : Carry
    warnings : tuple of str
        What this estimator noticed about itself: a parameter at a bound.
    """

    values: FloatArray
    sds: FloatArray
    bias_a: FloatArray
    bias_sd_a: FloatArray
    relaxation_v: FloatArray
    residual_v: FloatArray
    residual_sd_v: FloatArray
    learnt: BoolArray
    voltage_noise_v: float
    carry: Carry
    warnings: tuple[str, ...] = ()


Estimator = Callable[[CellRecord, BatteryConfig, Carry | None, Progress], Run]
"""Runs over a record from its first row to its last, beginning with what was carried over, or as configured."""
