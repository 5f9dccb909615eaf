"""A battery's configuration between its JSON form and `BatteryConfig`."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import asdict, fields
from math import isfinite, nan
from typing import Any, cast

from app.science.battery.circuit import Cell, Circuit, Hysteresis, Warmth
from app.science.battery.config import (
    ESTIMATORS,
    VALUES,
    BatteryConfig,
    EstimatorName,
    Gains,
    GpcSettings,
    usual_bias_a,
)
from app.science.battery.curve_reading import LOWEST_SOC, PERCENT_FROM, read_curve
from app.science.fields import Fields, ProblemError

__all__ = ["config_document", "read_config"]

LIMITS: Mapping[str, tuple[float, float]] = {
    "capacity_ah": (1e-4, 1e5),
    "resistance_ohm": (1e-7, 100.0),
    "relaxation_capacitance_f": (1e-2, 1e9),
    "relaxation_resistance_ohm": (1e-7, 100.0),
}
"""From a hearing aid's cell to a container's pack, given as one."""


def read_config(document: object) -> BatteryConfig:
    """Read a configuration.

    Parameters
    ----------
    document : object
        The JSON object: ``ocv`` and ``initial`` are needed, everything else has a default. Without ``initial.soc`` the
        cell's state of charge is NaN: not known, to be looked up from the first voltage.

    Raises
    ------
    ProblemError
        Naming the first field that can't be, and what is allowed.
    """
    top = Fields(document, what="configuration")
    curve = read_curve(top)
    circuit, soc = _initial(top.inner("initial"))
    cell = Cell(
        curve,
        circuit,
        soc,
        _whole(top, "series", 5000, 1),
        _whole(top, "parallel", 5000, 1),
        _warmth(top.inner("temperature")) if top.has("temperature") else None,
        _hysteresis(top.inner("hysteresis")) if top.has("hysteresis") else None,
    )
    rated_ah = _optional(top, "rated_capacity_ah", *LIMITS["capacity_ah"])
    config = BatteryConfig(
        cell,
        cast(EstimatorName, top.word("estimator", ESTIMATORS)) if top.has("estimator") else ESTIMATORS[0],
        _gpc(top),
        top.number("start_after_s", 0.0, 1e10, 0.0),
        rated_ah,
        _optional(top, "voltage_noise_v", 1e-7, 100.0),
        _optional(top, "current_noise_a", 0.0, 1000.0),
        top.number("current_bias_a", 0.0, 1000.0, usual_bias_a(rated_ah or circuit.capacity_ah)),
        _initial_sd(top.inner("initial_sd")) if top.has("initial_sd") else {},
    )
    top.close()
    return config


def config_document(config: BatteryConfig) -> dict[str, Any]:
    """Return a configuration as JSON holds it; `read_config` gives an equal one back."""
    cell, gpc = config.cell, config.gpc
    document: dict[str, Any] = {"ocv": cell.curve.document()}
    if cell.curve.coefficients:
        document["ocv_soc_range"] = list(cell.curve.soc_range)
    document["initial"] = {**asdict(cell.circuit), **({"soc": cell.soc} if isfinite(cell.soc) else {})}
    document |= {"series": cell.series, "parallel": cell.parallel, "estimator": config.estimator}
    document |= {"terms": gpc.terms, "sigma_range_1ps": list(gpc.sigma_range_1ps), "forgetting": gpc.forgetting}
    document |= {"gains": asdict(gpc.gains), "start_after_s": config.start_after_s}
    for name in ("rated_capacity_ah", "voltage_noise_v", "current_noise_a"):
        if getattr(config, name) is not None:
            document[name] = getattr(config, name)
    document["current_bias_a"] = config.current_bias_a
    document |= {"initial_sd": dict(config.initial_sd)} if config.initial_sd else {}
    document |= {"temperature": asdict(cell.warmth)} if cell.warmth else {}
    document |= {"hysteresis": asdict(cell.hysteresis)} if cell.hysteresis else {}
    return document


def _initial(given: Fields) -> tuple[Circuit, float]:
    circuit = Circuit(*(given.number(name, *limits) for name, limits in LIMITS.items()))
    soc = _soc(given) if given.has("soc") else nan
    given.close()
    return circuit, soc


def _soc(given: Fields) -> float:
    soc = given.number("soc", LOWEST_SOC, 100.0 * PERCENT_FROM)
    if soc > PERCENT_FROM:
        raise ProblemError(given.path("soc"), f"{soc:g} is percent; write it from 0 to 1, as {soc / 100.0:g}.")
    return given.number("soc", -0.1, 1.1)


def _gpc(top: Fields) -> GpcSettings:
    usual = GpcSettings()
    gains = _gains(top.inner("gains")) if top.has("gains") else usual.gains
    return GpcSettings(
        _whole(top, "terms", 20, usual.terms),
        top.pair("sigma_range_1ps", 1e-7, 100.0) if top.has("sigma_range_1ps") else usual.sigma_range_1ps,
        top.number("forgetting", 0.5, 1.0, usual.forgetting),
        gains,
    )


def _gains(given: Fields) -> Gains:
    gains = Gains(*(given.number(field.name, 0.0, 1e9, cast(float, field.default)) for field in fields(Gains)))
    given.close()
    return gains


def _warmth(given: Fields) -> Warmth:
    usual = Warmth()
    warmth = Warmth(
        given.number("reference_c", -60.0, 150.0, usual.reference_c),
        given.number("resistance_k", -2e4, 2e4, usual.resistance_k),
        given.number("relaxation_k", -2e4, 2e4, usual.relaxation_k),
        given.number("capacity_per_k", -0.1, 0.1, usual.capacity_per_k),
    )
    given.close()
    return warmth


def _hysteresis(given: Fields) -> Hysteresis:
    hysteresis = Hysteresis(given.number("voltage_v", 0.0, 100.0), given.number("rate", 0.0, 1e5, above=True))
    given.close()
    return hysteresis


def _initial_sd(given: Fields) -> dict[str, float]:
    highest = {name: 1.0 if name == "soc" else 10.0 for name in VALUES}
    found = {name: given.number(name, 0.0, highest[name], above=True) for name in VALUES if given.has(name)}
    given.close()
    return found


def _optional(top: Fields, name: str, low: float, high: float) -> float | None:
    return top.number(name, low, high) if top.has(name) else None


def _whole(top: Fields, name: str, most: int, usual: int) -> int:
    value = top.number(name, 1, most, usual)
    if value != int(value):
        raise ProblemError(top.path(name), f"{value:g} is not a whole number; allowed is 1 to {most}.")
    return int(value)
