"""A table from a dynamometer or a manufacturer laid over the map (Sebesta 2010, 3.5)."""

from __future__ import annotations

import csv
import io
import itertools
from dataclasses import dataclass

import numpy as np

from app.science.arrays import FloatArray
from app.science.errors import SignalsError

RADPS_PER_RPM = np.pi / 30.0
HIGHEST_EFFICIENCY = 0.65
FEWEST_POINTS = 6
SAME_LINE = 0.01
"""Points whose engine speeds, or torques, differ by less than this share of the largest are of one line."""
SPEED_NAMES = ("rpm", "engine_speed_rpm", "speed_rpm")
TORQUE_NAMES = ("nm", "torque_nm")
VALUE_NAMES = {
    "efficiency": "1",
    "eff": "1",
    "fuel_gps": "g/s",
    "fuel_g_s": "g/s",
    "bsfc_gpkwh": "g/kWh",
    "bsfc_g_kwh": "g/kWh",
}
"""Columns that tell how efficient a point is, and their units."""


@dataclass(frozen=True, slots=True)
class ReferenceMap:
    """Points of a table, each array of shape (n,), measured along lines of equal engine speed or equal torque."""

    rpm: FloatArray
    nm: FloatArray
    efficiency: FloatArray

    def at(self, rpm: FloatArray, nm: FloatArray) -> FloatArray:
        """Return the efficiency between the points, linear along the lines and across them; NaN outside them."""
        by_speed, by_torque = _lines(self.rpm, self.nm, self.efficiency), _lines(self.nm, self.rpm, self.efficiency)
        rpm, nm = (np.asarray(values, dtype=np.float64) for values in (rpm, nm))
        if sum(len(line.along) for line in by_speed) >= sum(len(line.along) for line in by_torque):
            return _between(by_speed, rpm, nm)
        return _between(by_torque, nm, rpm)


@dataclass(frozen=True, slots=True)
class _Line:
    """Points at one engine speed (or torque) by rising torque (or engine speed), arrays of shape (k,), k > 1."""

    at: float
    along: FloatArray
    efficiency: FloatArray


def _lines(key: FloatArray, along: FloatArray, efficiency: FloatArray) -> list[_Line]:
    order = np.lexsort((along, key))
    key, along, efficiency = key[order], along[order], efficiency[order]
    begins = np.flatnonzero(np.diff(key, prepend=-np.inf) > SAME_LINE * key.max())
    parts = [slice(a, b) for a, b in zip(begins, [*begins[1:], len(key)], strict=True)]
    lines = [_Line(float(key[part].mean()), *_rising(along[part], efficiency[part])) for part in parts]
    return [line for line in lines if len(line.along) > 1]


def _rising(along: FloatArray, efficiency: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Sort, and average what was measured more than once at the same place."""
    places, which = np.unique(along, return_inverse=True)
    return places, np.bincount(which, efficiency) / np.bincount(which)


def _between(lines: list[_Line], key: FloatArray, along: FloatArray) -> FloatArray:
    """Interpolate across neighbouring lines; where one reaches further, both are walked to their ends together."""
    found = np.full(np.broadcast(key, along).shape, np.nan)
    for low, high in itertools.pairwise(lines):
        share = (key - low.at) / (high.at - low.at)
        inside = (share >= 0.0) & (share <= 1.0)
        t, x = share[inside], along[inside]
        ends = [line.along[-1] for line in (low, high)]
        shorter = min(ends)
        reach = np.maximum((1.0 - t) * ends[0] + t * ends[1] - shorter, 1e-9)
        beyond = np.maximum(x - shorter, 0.0) / reach
        values = [
            np.interp(np.minimum(x, shorter) + beyond * (end - shorter), line.along, line.efficiency, left=np.nan)
            for line, end in zip((low, high), ends, strict=True)
        ]
        found[inside] = np.where(beyond <= 1.0, (1.0 - t) * values[0] + t * values[1], np.nan)
    return found


def read_reference(data: bytes, heating_value_jpg: float) -> ReferenceMap:
    """Read a CSV with engine speed, torque, and efficiency, fuel flow (g/s) or specific consumption (g/kWh).

    Where the table has a column ``max_torque_nm_at_rpm``, points above it are padding and left out. Columns may be
    separated by semicolons or tabs, and numbers may then have decimal commas.

    Parameters
    ----------
    data : bytes
    heating_value_jpg : float
        Lower heating value of the fuel, J/g.

    Raises
    ------
    SignalsError
        With the row and the column that can't be used.
    """
    text = data.decode("utf-8-sig", errors="replace")
    delimiter = max(",;\t", key=text.partition("\n")[0].count)
    rows = list(csv.DictReader(io.StringIO(text), delimiter=delimiter))
    if not rows:
        raise SignalsError("The table has no row below its header.")
    columns = {(name or "").strip().lower(): name for name in rows[0]}
    speed, torque = _named(columns, SPEED_NAMES, "engine speed"), _named(columns, TORQUE_NAMES, "torque")
    value = _named(columns, tuple(VALUE_NAMES), "efficiency, fuel flow or specific consumption")
    limit = columns.get("max_torque_nm_at_rpm")
    rpm, nm, told = (_numbers(rows, name) for name in (speed, torque, value))
    useful = (rpm > 0.0) & (nm > 0.0) & (told > 0.0)
    if limit is not None:
        useful &= nm <= _numbers(rows, limit) * (1.0 + 1e-6)
    efficiency = _as_efficiency(VALUE_NAMES[value.strip().lower()], told, rpm, nm, heating_value_jpg)
    absurd = np.flatnonzero(useful & (efficiency > HIGHEST_EFFICIENCY))
    if len(absurd):
        raise SignalsError(
            f"An efficiency of {efficiency[absurd[0]]:.2f} is impossible; check the unit of {value!r}.",
            int(absurd[0]) + 2, value,
        )  # fmt: skip
    if np.count_nonzero(useful) < FEWEST_POINTS:
        raise SignalsError(f"Only {np.count_nonzero(useful)} rows are usable; it takes {FEWEST_POINTS}.")
    found = ReferenceMap(rpm[useful], nm[useful], efficiency[useful])
    if max(len(_lines(found.rpm, found.nm, found.efficiency)), len(_lines(found.nm, found.rpm, found.efficiency))) < 2:
        raise SignalsError(
            "The points lie on no lines: it takes two torques or more at each of two engine speeds or more, or the "
            "other way round."
        )
    return found


def _named(columns: dict[str, str], names: tuple[str, ...], what: str) -> str:
    for name in names:
        if name in columns:
            return columns[name]
    raise SignalsError(f"There is no column of {what}: it is called {' or '.join(names)}.", 1)


def _numbers(rows: list[dict[str, str]], column: str) -> FloatArray:
    numbers = np.empty(len(rows))
    for number, row in enumerate(rows):
        try:
            numbers[number] = float((row[column] or "nan").replace(",", "."))
        except (TypeError, ValueError):
            raise SignalsError(f"{row[column]!r} is not a number.", number + 2, column) from None
    return numbers


def _as_efficiency(
    unit: str, told: FloatArray, rpm: FloatArray, nm: FloatArray, heating_value_jpg: float
) -> FloatArray:
    if unit == "1":
        return told
    with np.errstate(divide="ignore", invalid="ignore"):
        if unit == "g/s":
            return nm * rpm * RADPS_PER_RPM / (told * heating_value_jpg)
        return 3.6e6 / (told * heating_value_jpg)
