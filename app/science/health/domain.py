"""Where a car's usual is known: outside, a polynomial says anything."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from app.science.arrays import BoolArray, IntArray
from app.science.health.evidence import TripDesign

PARTS = 14
"""Cells along each axis, up to what the baseline exceeds only once in a hundred windows, and half of that beyond."""
LEAST_POWER = 0.1
"""Of the same power: below, the engine may idle with the brakes on. The choice must not look at the force."""
LEAST_WINDOWS = 6
LEAST_TRIPS = 2


@dataclass(frozen=True, slots=True)
class Domain:
    """Cells of engine speed and fuel power that the baseline trips visited often enough.

    Attributes
    ----------
    speed_step_radps, power_step_w : float
    seen : array of bool, shape (m, m)
    """

    speed_step_radps: float
    power_step_w: float
    seen: BoolArray

    def holds(self, design: TripDesign) -> BoolArray:
        """Return which windows of a trip lie inside, shape (n,)."""
        row, column = _cells(design, self.speed_step_radps, self.power_step_w, len(self.seen))
        pulls = design.fuel_power_w > LEAST_POWER * PARTS * self.power_step_w
        return np.asarray(self.seen[row, column] & pulls)


def domain_of(designs: Sequence[TripDesign]) -> Domain:
    """Find the cells with at least `LEAST_WINDOWS` windows of at least `LEAST_TRIPS` trips."""
    speed_step = float(np.percentile(np.concatenate([one.engine_speed_radps for one in designs]), 99.0)) / PARTS
    power_step = float(np.percentile(np.concatenate([one.fuel_power_w for one in designs]), 99.0)) / PARTS
    size = PARTS + PARTS // 2
    windows, trips = np.zeros((2, size, size), np.int64)
    for design in designs:
        here = np.zeros((size, size), np.int64)
        np.add.at(here, _cells(design, speed_step, power_step, size), 1)
        windows += here
        trips += here > 0
    seen = (windows >= LEAST_WINDOWS) & (trips >= LEAST_TRIPS)
    seen[-1, :] = seen[:, -1] = False
    return Domain(speed_step, power_step, seen)


def _cells(design: TripDesign, speed_step: float, power_step: float, size: int) -> tuple[IntArray, IntArray]:
    """Return the cell of each window; the last row and column gather what lies beyond."""
    row = np.minimum(design.engine_speed_radps / speed_step, size - 1).astype(np.int64)
    column = np.minimum(design.fuel_power_w / power_step, size - 1).astype(np.int64)
    return row, column
