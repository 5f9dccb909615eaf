"""What the figures of a map have in common: which number is shown, in which colours."""

from __future__ import annotations

from dataclasses import dataclass
from math import ceil
from typing import Literal

import numpy as np

from app.figures.theme import EFFICIENCY_SCALE, FONT, Json
from app.science.arrays import FloatArray
from app.science.engine.efficiency_map import EfficiencyMap
from app.science.engine.raster import MapRaster, smoothed

Shown = Literal["efficiency", "bsfc"]
NOTHING = "No cell has enough points that agree yet: drive the car more, or choose coarser cells."
ENGINE_SPEED, TORQUE = "Engine speed, rpm", "Torque, Nm"


@dataclass(frozen=True, slots=True)
class MapScale:
    """How efficiency or consumption is shown; better is brighter in both."""

    name: str
    unit: str
    decimals: int
    reversed: bool
    low: float
    high: float
    step: float

    def colours(self, low: str, high: str) -> Json:
        """Return the colours of a trace whose limits are called ``low`` and ``high``."""
        return {"colorscale": EFFICIENCY_SCALE, "reversescale": self.reversed, low: self.low, high: self.high}

    def isolines(self, colour: str) -> Json:
        """Return labelled lines at the scale's steps, for a contour trace without colours of its own."""
        return {
            "coloring": "none",
            "showlabels": True,
            "start": self.step * ceil(self.low / self.step),
            "end": self.high,
            "size": self.step,
            "labelfont": {"family": FONT, "size": 11, "color": colour},
        }

    @property
    def title(self) -> str:
        """Name and unit, as a colour bar says them."""
        return f"{self.name}, {self.unit}"


def scale_of(shown: Shown, values: FloatArray) -> MapScale:
    """Span the values, a little cropped, between round numbers."""
    low, high = np.nanpercentile(values, [1.0, 99.0])
    if shown == "bsfc":
        high = min(high, 2.5 * low)
        step = 20.0 if high - low < 200.0 else 40.0
        return MapScale("Consumption", "g/kWh", 0, True, *_between(low, high, 10.0), step)
    step = 1.0 if high - low < 8.0 else 2.0
    return MapScale("Efficiency", "%", 1, False, *_between(low, high, 1.0), step)


def _between(low: float, high: float, unit: float) -> tuple[float, float]:
    return float(np.floor(low / unit) * unit), float(max(np.ceil(high / unit), np.floor(low / unit) + 1) * unit)


@dataclass(frozen=True, slots=True)
class ShownValues:
    """Numbers of the cells as shown, arrays of shape (rows, columns): of each cell, and smoothed with holes closed."""

    cells: FloatArray
    smooth: FloatArray


def shown_values(cells: MapRaster, shown: Shown) -> ShownValues:
    """Return what a figure of efficiency or consumption draws."""
    smooth = smoothed(cells).filled
    if shown == "bsfc":
        fuel_per_work = float(np.nanmedian(cells.bsfc_gpkwh * cells.efficiency))
        return ShownValues(cells.bsfc_gpkwh, fuel_per_work / smooth)
    return ShownValues(100.0 * cells.efficiency, 100.0 * smooth)


def map_meta(efficiency_map: EfficiencyMap) -> Json:
    """Return what the page writes beside the figure."""
    return {
        "cell": {"rpm": efficiency_map.grid.rpm, "nm": efficiency_map.grid.nm},
        "cells": len(efficiency_map.n),
        "trusted_cells": int(np.isfinite(efficiency_map.efficiency).sum()),
        "points": int(efficiency_map.n.sum()),
    }
