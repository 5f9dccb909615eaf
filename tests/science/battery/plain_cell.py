"""A cell simulated row by row with plain Python, apart from everything under test."""

from __future__ import annotations

from functools import cache
from math import exp
from typing import Any

import numpy as np

from app.science.battery.record import BatteryRecord

OCV = [3.0, 1.1, -2.6, 3.4, -1.2]
"""Ascending coefficients of a curve that rises everywhere."""
TRUTH = {
    "capacity_ah": 2.0,
    "resistance_ohm": 0.02,
    "relaxation_capacitance_f": 2000.0,
    "relaxation_resistance_ohm": 0.015,
    "soc": 0.7,
}
CONFIG: dict[str, Any] = {
    "ocv": OCV,
    "initial": {
        "capacity_ah": 2.2,
        "resistance_ohm": 0.025,
        "relaxation_capacitance_f": 2300.0,
        "relaxation_resistance_ohm": 0.013,
        "soc": 0.55,
    },
}
INITIAL_OF_LAB = {
    "capacity_ah": 2.0,
    "resistance_ohm": 0.05,
    "relaxation_capacitance_f": 3000.0,
    "relaxation_resistance_ohm": 0.02,
    "soc": 0.5,
}
NOISE_A, NOISE_V = 0.01, 0.002


@cache
def driven(rows: int, seed: int = 1) -> BatteryRecord:
    """Return a drive of so many seconds: blocks of changing current between 25 and 85 % of the charge."""
    rng = np.random.default_rng(seed)
    soc, relaxation, down = TRUTH["soc"], 0.0, True
    ohm, settling = TRUTH["resistance_ohm"], TRUTH["relaxation_resistance_ohm"]
    left = exp(-1.0 / (settling * TRUTH["relaxation_capacitance_f"]))
    current, voltage = np.zeros(rows), np.zeros(rows)
    until = 0
    for k in range(rows):
        if k == until:
            until = k + int(rng.integers(3, 40))
            amps = float(rng.normal(-1.5 if down else 2.0, 2.0))
        current[k] = amps
        voltage[k] = sum(c * soc**power for power, c in enumerate(OCV)) + relaxation + ohm * amps
        soc += amps / (3600.0 * TRUTH["capacity_ah"])
        relaxation = left * relaxation + settling * (1.0 - left) * amps
        down = soc > 0.25 if down else soc > 0.85
    return BatteryRecord(
        np.arange(rows, dtype=np.float64),
        current + rng.normal(0.0, NOISE_A, rows),
        voltage + rng.normal(0.0, NOISE_V, rows),
    )
