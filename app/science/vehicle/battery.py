"""What a car's XML says of its traction battery."""

from __future__ import annotations

from dataclasses import dataclass

END_OF_LIFE = 0.8
"""Share of the rated capacity at which a traction battery is usually called spent (USABC; ISO 12405)."""


@dataclass(frozen=True, slots=True)
class BatterySpec:
    """A battery as the XML has it; what is None or empty is left to the estimators' defaults.

    Everything from the capacity to the curve is of one cell. With one cell in series and one in parallel, "one cell" is
    whatever current and voltage were measured of.

    Attributes
    ----------
    name : str
    series, parallel : int
        Cells in series, and how many of such strings stand side by side.
    rated_capacity_ah : float or None
        When new; the state of health is a share of it.
    capacity_ah, resistance_ohm, relaxation_capacitance_f, relaxation_resistance_ohm, soc : float or None
        What an estimate begins with (MAUTC-2010-02, eqs 55 and 56).
    ocv_coefficients : tuple of float
        Open-circuit voltage, polynomial in the state of charge, ascending; holds between `ocv_from` and `ocv_to`.
    ocv_soc, ocv_volts : tuple of float
        The curve as rows instead, both ascending.
    estimator : str or None
        By name.
    start_after_s : float or None
        For so long from a record's first row on parameters stay as given.
    terms, sigma_min_1ps, sigma_max_1ps, forgetting
        Of the report's estimator: terms of the expansion, bounds of the relaxation's rate, forgetting per second.
    gain_alpha, gain_r, gain_beta, gain_xi, gain_x10 : float or None
        Its gains (MAUTC-2010-02, Table 8).
    voltage_noise_v, current_noise_a, current_bias_a : float or None
        Standard deviations of the sensors.
    sd_capacity_ah, sd_resistance_ohm, sd_relaxation_capacitance_f, sd_relaxation_resistance_ohm, sd_soc : float or None
        Standard deviations of what an estimate begins with: shares of the value, for ``soc`` absolute.
    reference_c, resistance_k, relaxation_k, capacity_per_k : float or None
        Dependence on temperature.
    hysteresis_voltage_v, hysteresis_rate : float or None
    end_of_life : float
        Share of the rated capacity down to which the battery serves.
    """

    name: str = ""
    series: int = 1
    parallel: int = 1
    rated_capacity_ah: float | None = None
    capacity_ah: float | None = None
    resistance_ohm: float | None = None
    relaxation_capacitance_f: float | None = None
    relaxation_resistance_ohm: float | None = None
    soc: float | None = None
    ocv_coefficients: tuple[float, ...] = ()
    ocv_from: float | None = None
    ocv_to: float | None = None
    ocv_soc: tuple[float, ...] = ()
    ocv_volts: tuple[float, ...] = ()
    estimator: str | None = None
    start_after_s: float | None = None
    terms: int | None = None
    sigma_min_1ps: float | None = None
    sigma_max_1ps: float | None = None
    forgetting: float | None = None
    gain_alpha: float | None = None
    gain_r: float | None = None
    gain_beta: float | None = None
    gain_xi: float | None = None
    gain_x10: float | None = None
    voltage_noise_v: float | None = None
    current_noise_a: float | None = None
    current_bias_a: float | None = None
    sd_capacity_ah: float | None = None
    sd_resistance_ohm: float | None = None
    sd_relaxation_capacitance_f: float | None = None
    sd_relaxation_resistance_ohm: float | None = None
    sd_soc: float | None = None
    reference_c: float | None = None
    resistance_k: float | None = None
    relaxation_k: float | None = None
    capacity_per_k: float | None = None
    hysteresis_voltage_v: float | None = None
    hysteresis_rate: float | None = None
    end_of_life: float = END_OF_LIFE

    @property
    def missing(self) -> tuple[str, ...]:
        """What an estimate needs and the XML leaves open, in words."""
        needed = {
            "open-circuit curve": self.ocv_coefficients or self.ocv_soc,
            "capacity": self.capacity_ah or self.rated_capacity_ah,
            "resistance": self.resistance_ohm,
            "relaxation capacitance": self.relaxation_capacitance_f,
            "relaxation resistance": self.relaxation_resistance_ohm,
        }
        return tuple(words for words, value in needed.items() if not value)
