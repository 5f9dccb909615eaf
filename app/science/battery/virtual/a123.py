"""The cell of MAUTC-2010-02, part 3, 4.1 and 4.3, and what its estimators begin with."""

from __future__ import annotations

from dataclasses import fields, replace

from app.science.battery.circuit import Cell, Circuit
from app.science.battery.config import BatteryConfig, usual_bias_a
from app.science.battery.curve import OpenCircuit

SECONDS_PER_DAY = 86400.0

CURVE = OpenCircuit((3.168, 0.0505, 4.154, -18.38, 33.52, -27.934, 8.7728))
"""Open-circuit voltage of sixth order, as in fig. 25b.

The report prints no coefficients. These are ours: a fit to the mean of slow charge and discharge that iron phosphate
cells beside graphite usually show, 3.20 V at 10 %, two flat stretches, 3.34 V at 90 %, kept rising by at least 50 mV
per whole charge from empty to full.
"""

CELL = Cell(CURVE, Circuit(2.0, 0.008, 2700.0, 0.011), soc=0.7)
"""Table 7, "Value used in the model"; 2 Ah and 3.3 V."""

GUESS = Cell(CURVE, Circuit(2.2, 0.010, 3000.0, 0.010), soc=0.5)
"""Table 7, "Initial guess for the estimator"."""

CURRENT_NOISE_A = 0.010
VOLTAGE_NOISE_V = 0.002


def first_guess(cell: Cell = CELL, start_after_s: float = SECONDS_PER_DAY) -> BatteryConfig:
    """Return what an estimator begins with in 4.3: off for the first day, then from the guesses of Table 7.

    Another cell is guessed as far from its truth, value by value, as Table 7 guesses its own.
    """
    true, told, guessed = cell.circuit, CELL.circuit, GUESS.circuit
    names = [field.name for field in fields(Circuit)]
    wrong = [getattr(true, name) * getattr(guessed, name) / getattr(told, name) for name in names]
    circuit = Circuit(*(float(f"{value:.6g}") for value in wrong))
    soc = min(max(round(cell.soc + GUESS.soc - CELL.soc, 6), 0.0), 1.0)
    return BatteryConfig(
        cell=replace(cell, circuit=circuit, soc=soc),
        start_after_s=start_after_s,
        rated_capacity_ah=true.capacity_ah,
        current_bias_a=usual_bias_a(true.capacity_ah),
    )
