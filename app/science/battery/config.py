"""What an estimate is asked to do: the cell as it is thought to be, the estimator, and how it is set."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Literal

from app.science.battery.circuit import Cell

EstimatorName = Literal["gpc", "ekf", "ekf_bias", "ukf", "rls"]
ESTIMATORS: tuple[EstimatorName, ...] = ("ekf_bias", "ekf", "ukf", "gpc", "rls")
"""By name, the default first."""

VALUES = ("capacity_ah", "resistance_ohm", "relaxation_capacitance_f", "relaxation_resistance_ohm", "soc")
"""What every estimator estimates, in the order of every array of values."""


def usual_bias_a(capacity_ah: float) -> float:
    """Return how far a current's sensor may be off where nobody says: 1 % of what empties a cell in an hour, or 20 mA.

    Sensors are made for the currents that they measure, and what they are off by goes with their range.
    """
    return max(0.02, 0.01 * capacity_ah)


@dataclass(frozen=True, slots=True)
class Gains:
    """Γ of MAUTC-2010-02, eq. 80 and Table 8; charge is in ampere-seconds."""

    alpha: float = 2e-14
    r: float = 1e-8
    beta: float = 1e-10
    xi: float = 1e-5
    x10: float = 100.0


@dataclass(frozen=True, slots=True)
class GpcSettings:
    """How the report's estimator is set (MAUTC-2010-02, part 3, 4.3).

    Attributes
    ----------
    terms : int
        N, terms of the expansion.
    sigma_range_1ps : tuple of float
        Between which the relaxation's rate 1/(R_r C_r) is looked for, 1/s.
    forgetting : float
        λ, per second.
    gains : Gains
    """

    terms: int = 3
    sigma_range_1ps: tuple[float, float] = (0.02, 0.05)
    forgetting: float = 0.99999
    gains: Gains = Gains()


@dataclass(frozen=True, slots=True)
class BatteryConfig:
    """A cell, an estimator and its settings.

    Attributes
    ----------
    cell : Cell
    estimator : EstimatorName
    gpc : GpcSettings
    start_after_s : float
        For so long from the first row on the parameters stay as they were given.
    rated_capacity_ah : float or None
        Of one cell when new: what the state of health is a share of. None: the capacity given to begin with.
    voltage_noise_v, current_noise_a : float or None
        Standard deviations of the sensors; None: the estimator's default, corrected by what the residuals say.
    current_bias_a : float
        Standard deviation of the current sensor's constant error, one cell's share.
    initial_sd : mapping
        Standard deviations of what the cell is thought to be, by names of `VALUES`: for the parameters as shares of
        the value, for ``soc`` absolute. What is not named has the estimator's default.
    """

    cell: Cell
    estimator: EstimatorName = "ekf_bias"
    gpc: GpcSettings = GpcSettings()
    start_after_s: float = 0.0
    rated_capacity_ah: float | None = None
    voltage_noise_v: float | None = None
    current_noise_a: float | None = None
    current_bias_a: float = 0.02
    initial_sd: Mapping[str, float] = field(default_factory=dict)
