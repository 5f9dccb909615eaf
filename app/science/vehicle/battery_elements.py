"""The values below ``<battery>`` of a car's XML, as rows of the table `app.science.vehicle.elements.FIELDS`."""

from __future__ import annotations

from app.science.vehicle import quantities as q
from app.science.vehicle.field import Field

ESTIMATORS = ("ekf_bias", "ekf", "ukf", "gpc", "rls")
CAPACITY_AH = (1e-4, 1e5)
OHM = (1e-7, 100.0)
FARAD = (1e-2, 1e9)
SD = (1e-6, 10.0)
"""Limits as the estimators' configuration has them."""


def _number(
    path: str,
    target: str,
    label: str,
    quantity: q.Quantity,
    limits: tuple[float, float],
    help_text: str,
    usual: tuple[float, float] | None = None,
) -> Field:
    low, high = limits
    return Field(f"battery{path}", label, help_text, f"battery.{target}", "number", quantity, 1.0, low, high, usual)


def _count(path: str, target: str, label: str, most: float, help_text: str) -> Field:
    return Field(
        f"battery{path}",
        label,
        help_text,
        f"battery.{target}",
        "number",
        q.COUNT,
        minimum=1.0,
        maximum=most,
        form="whole",
    )


def _list(
    attribute: str,
    target: str,
    label: str,
    limits: tuple[float, float],
    help_text: str,
    quantity: q.Quantity = q.COUNT,
) -> Field:
    low, high = limits
    return Field(
        f"battery/ocv@{attribute}",
        label,
        help_text,
        f"battery.{target}",
        "list",
        quantity,
        minimum=low,
        maximum=high,
    )


def _gain(name: str) -> Field:
    return _number(f"/gpc/gains@{name}", f"gain_{name}", f"Gain {name}", q.COUNT, (0.0, 1e9), _GAIN)


def _uncertain(
    attribute: str, target: str, label: str, share: str = "share of the value", limits: tuple[float, float] = SD
) -> Field:
    path = f"/uncertainty@{attribute}"
    return _number(
        path, f"sd_{target}", f"Doubt about {label}", q.SHARE, limits, f"Standard deviation to begin with, {share}."
    )


_GAIN = "Of the report's estimator (gpc), charge in ampere-seconds. Empty: Table 8's."

GROUPS: dict[str, tuple[Field, ...]] = {
    "Battery": (
        Field("battery@name", "Battery", "What to call it.", "battery.name"),
        _count("/cells@series", "series", "Cells in series", 5000.0, "How many cells the voltage adds up over."),
        _count("/cells@parallel", "parallel", "Cells in parallel", 5000.0, "How many cells share the current."),
        _number(
            "/capacity@rated",
            "rated_capacity_ah",
            "Rated capacity",
            q.CHARGE,
            CAPACITY_AH,
            "Of one cell when new; the state of health is a share of it.",
        ),
        _number(
            "/capacity@initial",
            "capacity_ah",
            "Capacity to begin with",
            q.CHARGE,
            CAPACITY_AH,
            "Of one cell, as it is thought to be now. Empty: the rated one.",
        ),
        _number("/resistance@ohm", "resistance_ohm", "Resistance", q.RESISTANCE, OHM, "Of one cell, in series."),
        _number(
            "/relaxation@capacitance",
            "relaxation_capacitance_f",
            "Relaxation capacitance",
            q.CAPACITANCE,
            FARAD,
            "Of one cell; with the resistance beside it, it makes the voltage settle slowly.",
        ),
        _number(
            "/relaxation@resistance",
            "relaxation_resistance_ohm",
            "Relaxation resistance",
            q.RESISTANCE,
            OHM,
            "Of one cell, beside the relaxation capacitance.",
        ),
        _number(
            "/soc@initial",
            "soc",
            "State of charge to begin with",
            q.SHARE,
            (-0.1, 1.1),
            "Of the first record, 0.5 or 50 %. Empty: read from the first voltage.",
        ),
        _list(
            "coefficients",
            "ocv_coefficients",
            "Open-circuit curve, polynomial",
            (-1e9, 1e9),
            "Volts of one cell over the state of charge: coefficients from the constant one upwards, blanks between.",
        ),
        _number(
            "/ocv@from", "ocv_from", "Polynomial from", q.SHARE, (-0.5, 1.5), "Where the polynomial begins to hold."
        ),
        _number("/ocv@to", "ocv_to", "Polynomial to", q.SHARE, (-0.5, 1.5), "Up to where the polynomial holds."),
        _list(
            "soc",
            "ocv_soc",
            "Open-circuit curve, states of charge",
            (-0.5, 1.5),
            "A table instead: states of charge from 0 to 1, rising, blanks between.",
            q.SHARE,
        ),
        _list(
            "volts",
            "ocv_volts",
            "Open-circuit curve, volts",
            (0.0, 5000.0),
            "The table's voltages of one cell, one for each state of charge.",
        ),
        _number(
            "/life@end",
            "end_of_life",
            "End of life",
            q.SHARE,
            (0.05, 1.0),
            "Share of the rated capacity at which the battery counts as spent. Empty: 0.8.",
            (0.5, 0.95),
        ),
    ),
    "Battery estimator": (
        Field(
            "battery/estimator@type",
            "Estimator",
            "Kalman filter with the current sensor's bias (ekf_bias), without (ekf), unscented (ukf), the report's "
            "(gpc), or least squares (rls).",
            "battery.estimator",
            "choice",
            choices=ESTIMATORS,
        ),
        _number(
            "/estimator@startAfter",
            "start_after_s",
            "Start after",
            q.TIME,
            (0.0, 1e10),
            "For so long from a record's first row on the parameters stay as given.",
        ),
        _number(
            "/noise@voltage",
            "voltage_noise_v",
            "Voltage noise",
            q.VOLTAGE,
            (1e-7, 100.0),
            "Standard deviation, one cell's. Empty: learnt from the data.",
        ),
        _number(
            "/noise@current",
            "current_noise_a",
            "Current noise",
            q.CURRENT,
            (0.0, 1000.0),
            "Standard deviation, one cell's share. Empty: the estimator's own.",
        ),
        _number(
            "/noise@bias",
            "current_bias_a",
            "Current bias",
            q.CURRENT,
            (0.0, 1000.0),
            "How far off the current sensor may be for good: standard deviation, one cell's share.",
        ),
        _uncertain("capacity", "capacity_ah", "the capacity"),
        _uncertain("resistance", "resistance_ohm", "the resistance"),
        _uncertain("relaxationCapacitance", "relaxation_capacitance_f", "the relaxation capacitance"),
        _uncertain("relaxationResistance", "relaxation_resistance_ohm", "the relaxation resistance"),
        _uncertain("soc", "soc", "the state of charge", "0.1 for a tenth of the whole charge", (1e-6, 1.0)),
        _number(
            "/temperature@reference",
            "reference_c",
            "Reference temperature",
            q.TEMPERATURE,
            (-60.0, 150.0),
            "Where resistance and capacity hold.",
        ),
        _number(
            "/temperature@resistance",
            "resistance_k",
            "Resistance over temperature",
            q.KELVIN,
            (-20_000.0, 20_000.0),
            "B of R · exp(B (1/T − 1/T_ref)).",
        ),
        _number(
            "/temperature@relaxation",
            "relaxation_k",
            "Relaxation over temperature",
            q.KELVIN,
            (-20_000.0, 20_000.0),
            "The same for the relaxation resistance.",
        ),
        _number(
            "/temperature@capacity",
            "capacity_per_k",
            "Capacity over temperature",
            q.SHARE,
            (-0.1, 0.1),
            "Share of the capacity gained per kelvin.",
        ),
        _number(
            "/hysteresis@voltage",
            "hysteresis_voltage_v",
            "Hysteresis",
            q.VOLTAGE,
            (0.0, 100.0),
            "Half of what lies between the voltages at rest after charging and after discharging.",
        ),
        _number(
            "/hysteresis@rate",
            "hysteresis_rate",
            "Hysteresis rate",
            q.COUNT,
            (1e-6, 1e5),
            "How fast it turns over, per whole charge moved.",
        ),
        _count("/gpc@terms", "terms", "Terms", 20.0, "Of the expansion in the report's estimator (gpc). Empty: 3."),
        _number(
            "/gpc@sigmaMin",
            "sigma_min_1ps",
            "Relaxation rate from",
            q.RATE,
            (1e-7, 100.0),
            "Lower bound of 1/(R C) of the relaxation in the report's estimator.",
        ),
        _number(
            "/gpc@sigmaMax",
            "sigma_max_1ps",
            "Relaxation rate to",
            q.RATE,
            (1e-7, 100.0),
            "Upper bound of the same.",
        ),
        _number(
            "/gpc@forgetting",
            "forgetting",
            "Forgetting",
            q.COUNT,
            (0.5, 1.0),
            "What a measurement's weight is multiplied with each second in the report's estimator.",
        ),
        *(_gain(name) for name in ("alpha", "r", "beta", "xi", "x10")),
    ),
}
"""By group of the form."""
