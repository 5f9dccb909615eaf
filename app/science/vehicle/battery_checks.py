"""Whether the values below ``<battery>`` fit together, and what is odd about them."""

from __future__ import annotations

from collections.abc import Mapping
from itertools import pairwise

import numpy as np

from app.science.arrays import FloatArray
from app.science.vehicle.battery import BatterySpec
from app.science.vehicle.field import Value
from app.science.vehicle.quantities import parse_list

COEFFICIENTS, SOC, VOLTS = "battery/ocv@coefficients", "battery/ocv@soc", "battery/ocv@volts"
FROM, TO = "battery/ocv@from", "battery/ocv@to"
TOLERATED_FALL_V = 0.005
"""Measured curves fall by this much in places."""
SAMPLES = 1001
PAIRS = (
    (FROM, TO, "ends"),
    ("battery/gpc@sigmaMin", "battery/gpc@sigmaMax", "ends"),
    ("battery/hysteresis@voltage", "battery/hysteresis@rate", ""),
)
"""Values that stand together; the first of two ends lies below the second."""


def find_battery_conflict(values: Mapping[str, Value]) -> tuple[str, str] | None:
    """Return path and problem of the first value (by `Field.path`) that can't be beside the others, or None."""
    for first, second, kind in PAIRS:
        low, high = values.get(first), values.get(second)
        if (low is None) != (high is None):
            there, other = (first, second) if high is None else (second, first)
            return there, f"stands without {other}; give both or none"
        if kind and isinstance(low, float) and isinstance(high, float) and low >= high:
            return second, f"{high:g} isn't above {first}, {low:g}"
    return _table_conflict(values) or _polynomial_conflict(values)


def battery_remarks(values: Mapping[str, Value], battery: BatterySpec | None) -> list[str]:
    """Return what is odd about a battery, in sentences."""
    if battery is None:
        return []
    remarks = []
    if battery.missing:
        remarks.append(
            f"The battery's state can't be estimated yet; the XML leaves open its {' and its '.join(battery.missing)}."
        )
    if COEFFICIENTS in values:
        soc, volts = _polynomial(values)
        falling = np.flatnonzero(np.diff(volts) < 0.0)
        if len(falling):
            remarks.append(
                f"The battery's open-circuit polynomial falls at a state of charge of {soc[falling[0]]:.3g}; where it "
                "falls, a voltage doesn't tell the charge. battery/ocv@from and @to say where it holds."
            )
    return remarks


def _table_conflict(values: Mapping[str, Value]) -> tuple[str, str] | None:
    if SOC not in values and VOLTS not in values:
        return None
    for path, other in ((SOC, VOLTS), (VOLTS, SOC)):
        if path not in values:
            return other, f"stands without {path}; a table has both"
    if COEFFICIENTS in values:
        return COEFFICIENTS, "stands beside a table of the same curve; give one of them"
    if FROM in values:
        return FROM, "belongs to a polynomial; a table's rows say where it is known"
    soc, volts = parse_list(str(values[SOC])), parse_list(str(values[VOLTS]))
    if len(soc) != len(volts):
        return VOLTS, f"has {len(volts)} voltages for {len(soc)} states of charge; each needs its own"
    if len(soc) < 2:
        return SOC, "has one row only; a curve needs two at least"
    for row, (before, after) in enumerate(pairwise(zip(soc, volts, strict=True)), start=2):
        if after[0] <= before[0]:
            return SOC, f"row {row}: {after[0]:g} isn't above the {before[0]:g} before it; states of charge must rise"
        if after[1] < before[1] - TOLERATED_FALL_V:
            return VOLTS, f"row {row}: {after[1]:g} V lie below the {before[1]:g} V before; the curve must not fall"
    if volts[-1] <= volts[0]:
        return VOLTS, "don't rise from the first to the last; nothing could be told from them"
    return None


def _polynomial_conflict(values: Mapping[str, Value]) -> tuple[str, str] | None:
    if COEFFICIENTS not in values:
        return (FROM, f"stands without {COEFFICIENTS}") if FROM in values else None
    soc, volts = _polynomial(values)
    inner = volts[len(soc) // 5 : len(soc) - len(soc) // 5]
    if inner[-1] <= inner[0]:
        return COEFFICIENTS, "make a voltage that doesn't rise with the state of charge; the constant one comes first"
    if inner.min() <= 0.0:
        return COEFFICIENTS, f"make {inner.min():.3g} V within the curve; the constant one comes first"
    return None


def _polynomial(values: Mapping[str, Value]) -> tuple[FloatArray, FloatArray]:
    low, high = values.get(FROM, 0.0), values.get(TO, 1.0)
    soc = np.linspace(float(low), float(high), SAMPLES)
    return soc, np.asarray(
        np.polynomial.polynomial.polyval(soc, parse_list(str(values[COEFFICIENTS]))), dtype=np.float64
    )
