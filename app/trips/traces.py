"""Quantities of a trip over time, with as few samples as a screen can show and every spike among them."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from app.errors import Invalid
from app.figures.decimate import minmax_indices
from app.science.arrays import FloatArray
from app.storage.blobs import Blobs
from app.trips.models import Trip
from app.trips.states import TIME, StatesTable

UNITS = {"mps2": "m/s²", "mps": "m/s", "radps": "rad/s", "radpm": "rad/m", "rad": "rad", "nm": "Nm", "deg": "°"}
PLAIN_UNITS = {"m": "m", "n": "N", "j": "J", "w": "W", "s": "s"}


def traces(
    blobs: Blobs, trip: Trip, signals: Sequence[str], from_s: float | None, to_s: float | None, points: int
) -> dict[str, Any]:
    """Return quantities over a span of time, decimated; plain lists in the shape of `app.trips.schemas.Traces`.

    Raises
    ------
    Invalid
        When a signal is unknown or the span is empty.
    PonthyError
        When the trip has no result yet.
    """
    if from_s is not None and to_s is not None and from_s > to_s:
        raise Invalid("empty-span", f"The span from {from_s} s to {to_s} s is empty.", field="to_s")
    with StatesTable(blobs, trip) as table:
        table.check(signals)
        columns = table.columns(table.with_deviations(signals), from_s, to_s)
    t = columns[TIME]
    result = {name: _trace(t, columns[name], columns.get(f"{name}_sd"), unit_of(name), points) for name in signals}
    return {
        "signals": result,
        "shown": max((len(trace["t_s"]) for trace in result.values()), default=0),
        "total": len(t),
        "from_s": float(t[0]) if len(t) else from_s or 0.0,
        "to_s": float(t[-1]) if len(t) else to_s or 0.0,
    }


def at(blobs: Blobs, trip: Trip, t_s: float) -> dict[str, float | None]:
    """Return all columns at the node nearest to a time."""
    with StatesTable(blobs, trip) as table:
        columns = table.columns(table.names, t_s, t_s)
    nearest = int(np.argmin(np.abs(columns[TIME] - t_s)))
    return dict(zip(columns, (_finite(values[nearest : nearest + 1])[0] for values in columns.values()), strict=True))


def unit_of(name: str) -> str:
    """Return the unit that the name of a column carries, empty for a plain number."""
    stem, _, ending = name.removesuffix("_sd").rpartition("_")
    return UNITS.get(ending) or (PLAIN_UNITS.get(ending, "") if stem else "")


def _trace(t_s: FloatArray, value: FloatArray, sd: FloatArray | None, unit: str, points: int) -> dict[str, Any]:
    kept = minmax_indices(value, points) if len(value) else np.empty(0, np.int64)
    return {
        "t_s": np.round(t_s[kept], 4).tolist(),
        "value": _finite(value[kept]),
        "sd": None if sd is None else _finite(sd[kept]),
        "unit": unit,
    }


def _finite(values: FloatArray) -> list[float | None]:
    listed: list[float | None] = values.tolist()
    if np.isfinite(values).all():
        return listed
    return [value if known else None for value, known in zip(listed, np.isfinite(values).tolist(), strict=True)]
