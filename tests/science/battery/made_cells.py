"""Cells of known truth in a laboratory: slow sweeps and pulses with rests."""

from __future__ import annotations

import numpy as np

from app.science.arrays import FloatArray
from app.science.battery.circuit import Cell, Circuit
from app.science.battery.curve import OpenCircuit
from app.science.battery.record import BatteryRecord
from app.science.battery.simulate import simulate

NMC = OpenCircuit(
    points=((0.0, 3.0), (0.03, 3.25), (0.1, 3.45), (0.25, 3.58), (0.5, 3.68), (0.75, 3.92), (0.9, 4.06), (1.0, 4.2))
)
LFP = OpenCircuit(
    points=((0.0, 2.6), (0.02, 2.95), (0.1, 3.2), (0.3, 3.28), (0.6, 3.3), (0.9, 3.34), (0.98, 3.38), (1.0, 3.55))
)
CIRCUIT = Circuit(5.0, 0.02, 2000.0, 0.015)


def cycled(curve: OpenCircuit, rate_per_h: float, seed: int = 0, noise_v: float = 1e-3) -> BatteryRecord:
    """Return a rest when full, a discharge, a rest and a charge, all between empty and full by charge."""
    lasts = int(3600.0 / rate_per_h / 10.0)
    current = CIRCUIT.capacity_ah * rate_per_h
    flows = np.concatenate(
        [np.zeros(60), np.full(lasts, -current), np.zeros(360), np.full(lasts, current), np.zeros(60)]
    )
    return measured(curve, 10.0 * np.arange(len(flows)), flows, 1.0, seed, noise_v)


def pulsed(curve: OpenCircuit, seed: int = 0, noise_v: float = 1e-3) -> BatteryRecord:
    """Return 20 steps of 5 % down at a third of the capacity per hour, each with pulses and half an hour of rest."""
    step = [np.zeros(60), np.full(10, -5.0), np.zeros(40), np.full(10, 5.0), np.full(540, -5.0 / 3.0), np.zeros(1740)]
    flows = np.concatenate([*[np.concatenate(step) for _ in range(20)], np.zeros(1)])
    return measured(curve, np.arange(len(flows), dtype=np.float64), flows, 1.0, seed, noise_v)


def measured(
    curve: OpenCircuit, t_s: FloatArray, current_a: FloatArray, soc: float, seed: int, noise_v: float
) -> BatteryRecord:
    told = simulate(Cell(curve, CIRCUIT, soc), t_s, current_a)
    noise = noise_v * np.random.default_rng(seed).standard_normal(len(t_s))
    return BatteryRecord(t_s, current_a, told.voltage_v + noise)
