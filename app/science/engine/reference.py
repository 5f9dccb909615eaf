"""A table from a dynamometer or a manufacturer laid over the map (Sebesta 2010, 3.5)."""

from __future__ import annotations

import csv
import io
from dataclasses import dataclass

import numpy as np
from scipy.interpolate import LinearNDInterpolator

from app.science.arrays import FloatArray
from app.science.engine.efficiency_map import EfficiencyMap
from app.science.errors import SignalsError

RADPS_PER_RPM = np.pi / 30.0
HIGHEST_EFFICIENCY = 0.65
FEWEST_POINTS = 6
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
    """Points of a table, each array of shape (n,)."""

    rpm: FloatArray
    nm: FloatArray
    efficiency: FloatArray

    def at(self, rpm: FloatArray, nm: FloatArray) -> FloatArray:
        """Return the efficiency between the points; NaN outside them."""
        surface = LinearNDInterpolator(np.column_stack([self.rpm, self.nm]), self.efficiency, rescale=True)
        return np.asarray(surface(rpm, nm), dtype=np.float64)


@dataclass(frozen=True, slots=True)
class Agreement:
    """How a car's map lies beside a reference.

    Attributes
    ----------
    cells : int
        Trusted cells inside the reference.
    scale : float
        Factor from the reference to the map.
    correlation : float
        Of the two shapes, from −1 to 1.
    peak_rpm, peak_nm : float
        From the reference's best point to the map's.
    rmse, rmse_scaled : float
        Root mean square difference, as it is and after taking the scale out.
    """

    cells: int
    scale: float
    correlation: float
    peak_rpm: float
    peak_nm: float
    rmse: float
    rmse_scaled: float


def read_reference(data: bytes, heating_value_jpg: float) -> ReferenceMap:
    """Read a CSV with engine speed, torque, and efficiency, fuel flow (g/s) or specific consumption (g/kWh).

    Where the table has a column ``max_torque_nm_at_rpm``, points above it are padding and left out.

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
    rows = list(csv.DictReader(io.StringIO(data.decode("utf-8-sig", errors="replace"))))
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
    return ReferenceMap(rpm[useful], nm[useful], efficiency[useful])


def agreement(efficiency_map: EfficiencyMap, reference: ReferenceMap) -> Agreement | None:
    """Compare a map with a reference over the trusted cells inside it; None when they hardly overlap."""
    m = efficiency_map
    expected = reference.at(m.rpm, m.nm)
    both = np.isfinite(m.efficiency) & np.isfinite(expected)
    if np.count_nonzero(both) < FEWEST_POINTS:
        return None
    own, other = m.efficiency[both], expected[both]
    scale = float(own @ other / (other @ other))
    best, theirs = int(np.argmax(own)), int(np.argmax(other))
    rpm, nm = m.rpm[both], m.nm[both]
    return Agreement(
        cells=len(own),
        scale=scale,
        correlation=float(np.corrcoef(own, other)[0, 1]),
        peak_rpm=float(rpm[best] - rpm[theirs]),
        peak_nm=float(nm[best] - nm[theirs]),
        rmse=float(np.sqrt(np.mean((own - other) ** 2))),
        rmse_scaled=float(np.sqrt(np.mean((own - scale * other) ** 2))),
    )


def _named(columns: dict[str, str], names: tuple[str, ...], what: str) -> str:
    for name in names:
        if name in columns:
            return columns[name]
    raise SignalsError(f"There is no column of {what}: it is called {' or '.join(names)}.", 1)


def _numbers(rows: list[dict[str, str]], column: str) -> FloatArray:
    numbers = np.empty(len(rows))
    for number, row in enumerate(rows):
        try:
            numbers[number] = float(row[column] or "nan")
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
