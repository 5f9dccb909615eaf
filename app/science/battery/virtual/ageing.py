"""How fast a cell loses capacity: a map over current and voltage, or state of charge (MAUTC-2010-02, 4.4, fig. 32)."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

import numpy as np

from app.science.arrays import FloatArray, IntArray
from app.science.fields import Fields, ProblemError

Axis = Literal["voltage_v", "soc"]
LIMITS: dict[Axis, tuple[float, float]] = {"voltage_v": (0.0, 10.0), "soc": (0.0, 1.0)}
LARGEST_CURRENT_A = 1e4
LARGEST_LOSS = 0.01
"""Ampere-hours lost per ampere-hour moved: a cell that loses more is gone within fifty cycles."""


@dataclass(frozen=True, slots=True)
class DegradationMap:
    """Capacity that is lost for each ampere-hour that flows, in either direction.

    Between the table's points the loss is bilinear, outside of them that of the nearest edge.

    Attributes
    ----------
    current_a : tuple of float
        Of one cell, ascending; charging is positive.
    axis : str
        What the columns are: ``voltage_v`` of one cell, or ``soc``.
    at : tuple of float
        Values of the columns, ascending.
    loss_ah_per_ah : tuple of tuple of float
        One row for each current.
    """

    current_a: tuple[float, ...]
    axis: Axis
    at: tuple[float, ...]
    loss_ah_per_ah: tuple[tuple[float, ...], ...]

    def document(self) -> dict[str, list[float] | list[list[float]]]:
        """Return the map as configurations hold it."""
        rows = [list(row) for row in self.loss_ah_per_ah]
        return {"current_a": list(self.current_a), self.axis: list(self.at), "loss_ah_per_ah": rows}


def read_degradation(document: object, path: str = "degradation") -> DegradationMap:
    """Read a map from ``{"current_a": […], "voltage_v" | "soc": […], "loss_ah_per_ah": [[…]]}``.

    Raises
    ------
    ProblemError
        With the path of the field that can't be used.
    """
    fields = Fields(document, path, "degradation map")
    currents = _ascending(fields, "current_a", -LARGEST_CURRENT_A, LARGEST_CURRENT_A)
    axis: Axis = "soc" if fields.has("soc") else "voltage_v"
    if axis == "soc" and fields.has("voltage_v"):
        raise ProblemError(fields.path("soc"), "stands beside voltage_v; the columns are one of them.")
    at = _ascending(fields, axis, *LIMITS[axis])
    rows = fields.get("loss_ah_per_ah")
    if not isinstance(rows, list | tuple) or len(rows) != len(currents):
        told = f"{len(rows)} rows" if isinstance(rows, list | tuple) else "no list of rows"
        raise ProblemError(fields.path("loss_ah_per_ah"), f"has {told}; {len(currents)} are needed, one a current.")
    inner = Fields({str(k): row for k, row in enumerate(rows)}, fields.path("loss_ah_per_ah"), "degradation map")
    loss = tuple(inner.numbers(str(k), 0.0, LARGEST_LOSS, len(at)) for k in range(len(rows)))
    fields.close()
    return DegradationMap(currents, axis, at, loss)


def loss_at(degradation: DegradationMap, current_a: FloatArray, at: FloatArray) -> FloatArray:
    """Return the loss, Ah per Ah, at currents and voltages (or states of charge) of one shape."""
    table = np.array(degradation.loss_ah_per_ah)
    row, down = _places(np.array(degradation.current_a), current_a)
    column, right = _places(np.array(degradation.at), at)
    next_row, next_column = np.minimum(row + 1, len(table) - 1), np.minimum(column + 1, table.shape[1] - 1)
    above = table[row, column] * (1.0 - right) + table[row, next_column] * right
    below = table[next_row, column] * (1.0 - right) + table[next_row, next_column] * right
    return np.asarray(above * (1.0 - down) + below * down)


def _places(points: FloatArray, values: FloatArray) -> tuple[IntArray, FloatArray]:
    inside = np.clip(values, points[0], points[-1])
    place = np.clip(np.searchsorted(points, inside, side="right") - 1, 0, max(len(points) - 2, 0)).astype(np.int64)
    if len(points) == 1:
        return place, np.zeros_like(inside)
    return place, (inside - points[place]) / (points[place + 1] - points[place])


def _ascending(fields: Fields, name: str, low: float, high: float) -> tuple[float, ...]:
    values = fields.numbers(name, low, high)
    if not values:
        raise ProblemError(fields.path(name), "is empty; at least one value is needed.")
    for k in range(1, len(values)):
        if values[k] <= values[k - 1]:
            raise ProblemError(f"{fields.path(name)}[{k}]", f"{values[k]:g} is not above {values[k - 1]:g} before it.")
    return values


DEFAULT_MAP = DegradationMap(
    current_a=(-10.0, -5.0, -2.0, 0.0, 2.0, 4.0, 8.0),
    axis="voltage_v",
    at=(2.8, 3.1, 3.3, 3.4, 3.6, 3.8),
    loss_ah_per_ah=(
        (9.0e-5, 7.0e-5, 6.0e-5, 6.0e-5, 7.0e-5, 9.0e-5),
        (6.5e-5, 5.0e-5, 4.5e-5, 4.5e-5, 5.5e-5, 7.5e-5),
        (5.5e-5, 4.2e-5, 3.8e-5, 4.0e-5, 5.0e-5, 7.0e-5),
        (5.0e-5, 4.0e-5, 3.6e-5, 4.0e-5, 5.5e-5, 8.0e-5),
        (5.5e-5, 4.6e-5, 4.4e-5, 5.2e-5, 8.0e-5, 1.2e-4),
        (6.5e-5, 5.5e-5, 5.6e-5, 7.0e-5, 1.2e-4, 1.8e-4),
        (9.0e-5, 8.0e-5, 9.0e-5, 1.2e-4, 2.0e-4, 3.0e-4),
    ),
)
"""A map of our own, as the report shows its map but prints no number of it.

Its level is what graphite and iron phosphate cells are known to lose at room temperature: about 6 % for 2000 Ah through
2 Ah, 5e-5 Ah per Ah. Its shape is what is generally held of them: more with the size of the current, most when charged
fast at a high voltage, where lithium may plate the graphite, and a little more when driven down to a low one.
"""
