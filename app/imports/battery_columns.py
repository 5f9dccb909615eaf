"""Which columns of a foreign table are a battery's time, current, voltage and temperature."""

from __future__ import annotations

import re
from collections.abc import Mapping
from dataclasses import dataclass

from app.imports.streams import TIME_NAMES
from app.science.errors import SignalsError

NAMES: Mapping[str, tuple[str, ...]] = {
    "t_s": (*TIME_NAMES, "test_time", "total_time", "elapsed_time", "date_time", "date"),
    "current_a": (
        "current", "battery_current", "pack_current", "cell_current", "current_measured", "amps", "i", "i_batt",
    ),
    "voltage_v": (
        "voltage", "battery_voltage", "pack_voltage", "cell_voltage", "terminal_voltage", "voltage_measured", "volts",
        "v", "u", "v_batt",
    ),
    "temperature_c": (
        "temperature", "battery_temperature", "cell_temperature", "temperature_measured", "temp", "t_cell",
    ),
}  # fmt: skip
"""What each column may be called without its unit; the best first."""

UNITS: Mapping[str, Mapping[str, float]] = {
    "t_s": {"s": 1.0, "sec": 1.0, "seconds": 1.0, "ms": 1e-3, "min": 60.0, "h": 3600.0},
    "current_a": {"a": 1.0, "amps": 1.0, "ampere": 1.0, "ma": 1e-3},
    "voltage_v": {"v": 1.0, "volts": 1.0, "volt": 1.0, "mv": 1e-3},
    "temperature_c": {"c": 1.0, "degc": 1.0, "°c": 1.0, "deg_c": 1.0, "k": 1.0},
}  # fmt: skip
"""Units that stand in a name, as factors to the contract's; kelvin is recognised by its values."""

WANTED: Mapping[str, str] = {
    "t_s": "times in seconds",
    "current_a": "the current in amperes, charging positive",
    "voltage_v": "the voltage in volts",
}


@dataclass(frozen=True, slots=True)
class Column:
    """A column of the table and what its numbers are multiplied with."""

    name: str
    scale: float


def find_columns(names: tuple[str, ...], warnings: list[str]) -> dict[str, Column]:
    """Return the column of each wanted name; one with another name is taken with a warning.

    Raises
    ------
    SignalsError
        When time, current or voltage have no column.
    """
    found: dict[str, Column] = {}
    for wanted in NAMES:
        column = _find(wanted, names)
        if column is not None:
            found[wanted] = column
            if column.name.lower() != wanted:
                times = "" if column.scale == 1.0 else f", times {column.scale:g}"
                warnings.append(f"{wanted} is read from the column “{column.name}”{times}.")
        elif wanted in WANTED:
            raise _missing(wanted, names)
    unused = [name for name in names if name not in {column.name for column in found.values()}]
    if unused:
        warnings.append(f"Columns not used: {', '.join(unused[:20])}{' …' if len(unused) > 20 else ''}.")
    return found


def _find(wanted: str, names: tuple[str, ...]) -> Column | None:
    exact = next((name for name in names if name.lower() == wanted), None)
    if exact is not None:
        return Column(exact, 1.0)
    known = {plain: (name, scale) for name in reversed(names) for plain, scale in [_plain(name, wanted)] if scale}
    return next((Column(*known[plain]) for plain in NAMES[wanted] if plain in known), None)


def _plain(name: str, wanted: str) -> tuple[str, float]:
    """Return a name without its unit, and the unit's factor; 0 when the unit is none that is known."""
    lower = re.sub(r"[\s_.\-]+", "_", name.strip().lower()).strip("_")
    if lower in NAMES[wanted]:
        return lower, 1.0
    bracketed = re.fullmatch(r"(.*?)_?[\[(/](.*?)[\])]?", lower)
    if bracketed:
        return bracketed.group(1), UNITS[wanted].get(bracketed.group(2).strip("_"), 0.0)
    base, _, unit = lower.rpartition("_")
    return base, UNITS[wanted].get(unit, 0.0)


def _missing(wanted: str, names: tuple[str, ...]) -> SignalsError:
    shown = f"{', '.join(names[:12])}{' …' if len(names) > 12 else ''}"
    why = (
        " Current alone only counts charge: neither how full a battery is nor what is left of it can be told."
        if wanted == "voltage_v"
        else ""
    )
    return SignalsError(f"There is no column {wanted} ({WANTED[wanted]}); the table has {shown}.{why}", 1, wanted)
