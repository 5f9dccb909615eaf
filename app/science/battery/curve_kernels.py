"""The open-circuit curve inside hot loops; `app.science.battery.curve` says the same with arrays."""

from __future__ import annotations

import numpy as np

from app.science.battery.curve import CurvePieces
from app.science.jit import inline_kernel


@inline_kernel
def open_circuit(pieces: CurvePieces, soc: float) -> tuple[float, float]:
    """Return voltage and slope of the curve, volts and volts per whole charge."""
    starts, coefficients = pieces.starts, pieces.coefficients
    inside = min(max(soc, starts[0]), starts[-1])
    piece = min(max(np.searchsorted(starts, inside, side="right") - 1, 0), len(coefficients) - 1)
    within = inside - starts[piece]
    voltage, slope = 0.0, 0.0
    for power in range(coefficients.shape[1] - 1, -1, -1):
        slope = slope * within + voltage
        voltage = voltage * within + coefficients[piece, power]
    return voltage + slope * (soc - inside), slope
