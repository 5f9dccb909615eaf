"""The cell's exact recurrences with their derivatives by everything that is unknown, inside a hot loop."""

from __future__ import annotations

import numpy as np

from app.science.arrays import FloatArray
from app.science.battery.curve import CurvePieces
from app.science.battery.curve_kernels import open_circuit
from app.science.battery.simulate_kernels import RowFactors, factor_at
from app.science.jit import kernel

UNKNOWNS = 7
"""ln capacity_as, ln R, ln C_r, ln R_r, state of charge, relaxation voltage, current bias, as `Carry` has them."""


@kernel
def sensitive_voltage(
    pieces: CurvePieces, factors: RowFactors, unknowns: FloatArray, t_s: FloatArray, current_a: FloatArray
) -> tuple[FloatArray, FloatArray, FloatArray, FloatArray]:
    """Return the voltage (n,), its derivatives (n, 7), the state of charge (n,), and (2, 8) of the last row.

    The last are state of charge and relaxation voltage, each followed by its derivatives.
    """
    n = len(t_s)
    capacity, resistance, relaxed = np.exp(unknowns[0]), np.exp(unknowns[1]), np.exp(unknowns[3])
    time_constant, bias = np.exp(unknowns[2] + unknowns[3]), unknowns[6]
    soc, relaxation = unknowns[4], unknowns[5]
    by_soc, by_relaxation = np.zeros(UNKNOWNS), np.zeros(UNKNOWNS)
    by_soc[4], by_relaxation[5] = 1.0, 1.0
    voltages, slopes, socs = np.empty(n), np.empty((n, UNKNOWNS)), np.empty(n)
    width, decay = -1.0, 0.0
    for k in range(n):
        current = current_a[k] - bias
        rest, slope = open_circuit(pieces, soc)
        ohms = resistance * factor_at(factors.resistance, k)
        voltages[k], socs[k] = rest + relaxation + ohms * current, soc
        for j in range(UNKNOWNS):
            slopes[k, j] = slope * by_soc[j] + by_relaxation[j]
        slopes[k, 1] += ohms * current
        slopes[k, 6] -= ohms
        if k == n - 1:
            break
        if t_s[k + 1] - t_s[k] != width:
            width = t_s[k + 1] - t_s[k]
            decay = np.exp(-width / time_constant)
        room = capacity * factor_at(factors.capacity, k)
        level = relaxed * factor_at(factors.relaxation, k) * current
        by_soc[0] -= current * width / room
        by_soc[6] -= width / room
        for j in range(UNKNOWNS):
            by_relaxation[j] *= decay
        slower = decay * width / time_constant * (relaxation - level)
        by_relaxation[2] += slower
        by_relaxation[3] += slower + (1.0 - decay) * level
        by_relaxation[6] -= (1.0 - decay) * relaxed * factor_at(factors.relaxation, k)
        soc += current * width / room
        relaxation = decay * relaxation + (1.0 - decay) * level
    last = np.empty((2, 1 + UNKNOWNS))
    last[0, 0], last[1, 0] = soc, relaxation
    last[0, 1:], last[1, 1:] = by_soc, by_relaxation
    return voltages, slopes, socs, last
