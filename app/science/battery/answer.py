"""What is said of a battery: the five values with their uncertainty, how they came about, and what to doubt."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from math import isfinite
from typing import Any

import numpy as np

from app.science.arrays import FloatArray
from app.science.battery.config import VALUES, EstimatorName
from app.science.battery.run import Carry

DIGITS = 9
"""Of each number of the history: more says nothing, and a history is long."""


@dataclass(frozen=True, slots=True)
class BatteryEstimate:
    """A judged estimate. Everything is of one cell; ``series`` and ``parallel`` tell how many there are.

    Attributes
    ----------
    estimator : EstimatorName
    values, sds : ndarray (5,)
        At the last row, in the order of `VALUES`, and standard deviations.
    initial_soc, initial_soc_sd : float
        State of charge at the first row, as it is thought of now.
    soh, soh_sd : float
        Capacity as a share of the rated one.
    rated_capacity_ah : float
    current_bias_a, current_bias_sd_a : float
        Error of the current sensor.
    voltage_rms_v, voltage_noise_v : float
        Root mean square of measured less predicted voltage in the second half of the record; noise of the voltage.
    duration_s : float
    rows, rows_learnt : int
    series, parallel : int
    history : mapping of str to ndarray (m,)
        Columns over time, two thousand rows at most.
    started_at_utc_s : float or None
    warnings : tuple of str
    carry : Carry
        To begin the next record with.
    """

    estimator: EstimatorName
    values: FloatArray
    sds: FloatArray
    initial_soc: float
    initial_soc_sd: float
    soh: float
    soh_sd: float
    rated_capacity_ah: float
    current_bias_a: float
    current_bias_sd_a: float
    voltage_rms_v: float
    voltage_noise_v: float
    duration_s: float
    rows: int
    rows_learnt: int
    series: int
    parallel: int
    history: Mapping[str, FloatArray]
    carry: Carry
    started_at_utc_s: float | None = None
    warnings: tuple[str, ...] = ()

    def document(self) -> dict[str, Any]:
        """Return the answer as JSON holds it: finite numbers, or null where nothing is known."""
        answer: dict[str, Any] = {}
        for name, value, sd in zip(VALUES, self.values, self.sds, strict=True):
            answer |= {name: _number(value), f"{name}_sd": _number(sd)}
        for name in ("initial_soc", "soh"):
            answer |= {name: _number(getattr(self, name)), f"{name}_sd": _number(getattr(self, f"{name}_sd"))}
        answer["rated_capacity_ah"] = self.rated_capacity_ah
        answer |= {"current_bias_a": _number(self.current_bias_a)}
        answer |= {"current_bias_a_sd": _number(self.current_bias_sd_a)}
        answer |= {name: _number(getattr(self, name)) for name in ("voltage_rms_v", "voltage_noise_v", "duration_s")}
        answer |= {"rows": self.rows, "rows_learnt": self.rows_learnt, "started_at_utc_s": self.started_at_utc_s}
        answer |= {"estimator": self.estimator, "cell": {"series": self.series, "parallel": self.parallel}}
        answer["history"] = {name: _numbers(column) for name, column in self.history.items()}
        answer["warnings"] = list(self.warnings)
        return answer


def _number(value: float) -> float | None:
    return float(value) if isfinite(value) else None


def _numbers(column: FloatArray) -> list[float | None]:
    return [float(f"{value:.{DIGITS}g}") if isfinite(value) else None for value in np.asarray(column).tolist()]
