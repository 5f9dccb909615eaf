"""How noisy a current's sensor is, as its own stillest moments tell."""

from __future__ import annotations

import numpy as np

from app.science.arrays import FloatArray
from app.science.battery.config import BatteryConfig, usual_bias_a

LEAST_PER_H = 0.005
LEAST_A = 0.01
"""Nobody's sensor is taken to be quieter than half a percent of what empties the cell in an hour, or 10 mA."""
WINDOW = 64
WINDOWS = 4000
"""Rows of a window, and how many are looked at."""
STILL = 0.1
"""Share of the windows that are taken to be still: the car stands, or the charger holds its current."""


def current_noise_a(current_a: FloatArray, config: BatteryConfig) -> float:
    """Return the standard deviation of the noise of one cell's current, A.

    What a configuration states, holds. Else second differences, which know no slope, are looked at in windows, and the
    stillest windows tell; currents that are never still would tell too much, so more than what sensors are usually off
    by is not believed.

    Parameters
    ----------
    current_a : ndarray (n,)
    config : BatteryConfig

    Returns
    -------
    float
    """
    if config.current_noise_a is not None:
        return config.current_noise_a
    capacity_ah = config.rated_capacity_ah or config.cell.circuit.capacity_ah
    least = min(LEAST_A, LEAST_PER_H * capacity_ah)
    most = usual_bias_a(capacity_ah)
    return float(np.clip(_stillest(current_a), least, most))


def _stillest(current_a: FloatArray) -> float:
    if len(current_a) < WINDOW:
        return 0.0
    starts = np.linspace(0, len(current_a) - WINDOW, min(WINDOWS, len(current_a) // WINDOW)).astype(np.int64)
    bends = np.diff(current_a[starts[:, None] + np.arange(WINDOW)], n=2, axis=1)
    power = np.mean(bends**2, axis=1) / 6.0
    # A sensor that shows exactly nothing while nothing flows says nothing of its noise.
    power = power[power > 0.0]
    return float(np.sqrt(np.quantile(power, STILL))) if len(power) else 0.0
