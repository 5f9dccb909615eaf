"""A car's battery between the XML's values and the JSON document that configures an estimate."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import fields
from typing import Any

from app.science.fields import Fields, ProblemError, shown
from app.science.vehicle.battery import BatterySpec

PLACES: Mapping[str, str] = {
    "initial.capacity_ah": "capacity_ah",
    "initial.resistance_ohm": "resistance_ohm",
    "initial.relaxation_capacitance_f": "relaxation_capacitance_f",
    "initial.relaxation_resistance_ohm": "relaxation_resistance_ohm",
    "initial.soc": "soc",
    "estimator": "estimator",
    "terms": "terms",
    "forgetting": "forgetting",
    "gains.alpha": "gain_alpha",
    "gains.r": "gain_r",
    "gains.beta": "gain_beta",
    "gains.xi": "gain_xi",
    "gains.x10": "gain_x10",
    "start_after_s": "start_after_s",
    "series": "series",
    "parallel": "parallel",
    "rated_capacity_ah": "rated_capacity_ah",
    "voltage_noise_v": "voltage_noise_v",
    "current_noise_a": "current_noise_a",
    "current_bias_a": "current_bias_a",
    "initial_sd.capacity_ah": "sd_capacity_ah",
    "initial_sd.resistance_ohm": "sd_resistance_ohm",
    "initial_sd.relaxation_capacitance_f": "sd_relaxation_capacitance_f",
    "initial_sd.relaxation_resistance_ohm": "sd_relaxation_resistance_ohm",
    "initial_sd.soc": "sd_soc",
    "temperature.reference_c": "reference_c",
    "temperature.resistance_k": "resistance_k",
    "temperature.relaxation_k": "relaxation_k",
    "temperature.capacity_per_k": "capacity_per_k",
    "hysteresis.voltage_v": "hysteresis_voltage_v",
    "hysteresis.rate": "hysteresis_rate",
}
"""Attribute of `BatterySpec` by path in the document; curve and pairs are apart."""

OPEN = 1e300
"""Limits are the XML's; here a number only has to be one."""


def battery_document(spec: BatterySpec) -> dict[str, Any]:
    """Return a battery as a configuration document: what the XML leaves open is left out.

    Without a capacity to begin with the rated one stands for it. Name and end of life are no part of a configuration.
    """
    document: dict[str, Any] = {}
    if spec.ocv_coefficients:
        document["ocv"] = list(spec.ocv_coefficients)
    elif spec.ocv_soc:
        document["ocv"] = [list(row) for row in zip(spec.ocv_soc, spec.ocv_volts, strict=True)]
    if spec.ocv_from is not None and spec.ocv_to is not None:
        document["ocv_soc_range"] = [spec.ocv_from, spec.ocv_to]
    if spec.sigma_min_1ps is not None and spec.sigma_max_1ps is not None:
        document["sigma_range_1ps"] = [spec.sigma_min_1ps, spec.sigma_max_1ps]
    for path, attribute in PLACES.items():
        value = getattr(spec, attribute)
        if value is None and attribute == "capacity_ah":
            value = spec.rated_capacity_ah
        if value is not None:
            outer, _, inner = path.rpartition(".")
            (document.setdefault(outer, {}) if outer else document)[inner] = value
    return document


def spec_of_document(document: object) -> BatterySpec:
    """Return what a configuration document says; null is as good as left out.

    Raises
    ------
    ProblemError
        Where it has a field that no XML could hold, or something else than a number where one belongs.
    """
    top = Fields(document, what="configuration")
    values: dict[str, Any] = dict(_curve(top))
    for name, (low, high) in {
        "ocv_soc_range": ("ocv_from", "ocv_to"),
        "sigma_range_1ps": ("sigma_min_1ps", "sigma_max_1ps"),
    }.items():
        if top.has(name):
            values |= dict(zip((low, high), top.numbers(name, -OPEN, OPEN, 2), strict=True))
    inner = {
        outer: top.inner(outer)
        for outer in dict.fromkeys(path.rpartition(".")[0] for path in PLACES)
        if outer and top.has(outer)
    }
    for path, attribute in PLACES.items():
        outer, _, name = path.rpartition(".")
        at = inner.get(outer) if outer else top
        if at is not None and at.has(name):
            values[attribute] = _value(at, name, attribute)
    for one in (*inner.values(), top):
        one.close()
    return BatterySpec(**values)


_WHOLE = frozenset(field.name for field in fields(BatterySpec) if str(field.type).startswith("int"))


def _value(at: Fields, name: str, attribute: str) -> float | int | str:
    if attribute == "estimator":
        return str(at.get(name))
    number = at.number(name, -OPEN, OPEN)
    if attribute not in _WHOLE:
        return number
    if number != int(number):
        raise ProblemError(at.path(name), f"{number:g} is not a whole number.")
    return int(number)


def _curve(top: Fields) -> Iterator[tuple[str, tuple[float, ...]]]:
    if not top.has("ocv"):
        return
    curve = top.get("ocv")
    if isinstance(curve, list | tuple) and curve and all(isinstance(row, list | tuple) for row in curve):
        rows = Fields({f"ocv[{k}]": row for k, row in enumerate(curve)}, what="configuration")
        pairs = [rows.numbers(f"ocv[{k}]", -OPEN, OPEN, 2) for k in range(len(curve))]
        yield "ocv_soc", tuple(soc for soc, _ in pairs)
        yield "ocv_volts", tuple(volts for _, volts in pairs)
    elif isinstance(curve, list | tuple):
        yield "ocv_coefficients", top.numbers("ocv", -OPEN, OPEN)
    else:
        raise ProblemError("ocv", f"{shown(curve)} is neither coefficients nor rows of state of charge and volts.")
