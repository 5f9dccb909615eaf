"""Whether the truth lies where a battery's estimators say: other cells, and guesses as far off as they may be."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from app.cli.bench.figure import Figure
from app.cli.output import note
from app.science.arrays import FloatArray
from app.science.battery.circuit import Cell, Circuit
from app.science.battery.config import VALUES, BatteryConfig, usual_bias_a
from app.science.battery.curve import OpenCircuit
from app.science.battery.kalman.belief import INITIAL_SD
from app.science.battery.pack import cell_record
from app.science.battery.run import Estimator
from app.science.battery.virtual.a123 import CELL
from app.science.battery.virtual.pack import pack_of, virtual_pack
from app.science.progress import silent

DRAWS = 40
HOURS = 12.0
FARTHEST = 2.0
"""Guesses are drawn up to so many standard deviations off."""
EARLY_S, LATE_S = 600.0, 3600.0

NICKEL = OpenCircuit(
    points=((0.0, 3.0), (0.05, 3.3), (0.2, 3.52), (0.4, 3.62), (0.6, 3.78), (0.8, 4.0), (0.95, 4.12), (1.0, 4.2))
)
IRON = OpenCircuit(
    points=((0.0, 2.5), (0.05, 3.1), (0.15, 3.22), (0.3, 3.285), (0.6, 3.3), (0.7, 3.325), (0.9, 3.336), (1.0, 3.5))
)
CELLS = {
    "the report's 2 Ah": CELL,
    "flat iron phosphate, 2 Ah": replace(CELL, curve=IRON),
    "nickel, 60 Ah": Cell(NICKEL, Circuit(60.0, 1.2e-3, 30_000.0, 0.8e-3), soc=0.75),
    "nickel, 5 Ah, slow to settle": Cell(NICKEL, Circuit(5.0, 25e-3, 6_000.0, 18e-3), soc=0.6),
    "nickel, 0.1 Ah": Cell(NICKEL, Circuit(0.1, 0.3, 100.0, 0.2), soc=0.7),
}


def honesty(estimators: dict[str, Estimator]) -> list[Figure]:
    """Return how often the truth lies within two standard deviations, for each cell and estimator."""
    figures = []
    for name, estimator in estimators.items():
        for cell_name, cell in CELLS.items():
            note(f"{name}: {cell_name}, {DRAWS} guesses")
            inside = np.array([_inside(cell, seed, estimator) for seed in range(DRAWS)])
            for when, shares in (("from ten minutes to an hour", inside[:, 0]), ("after that", inside[:, 1])):
                figures.append(
                    Figure(
                        f"{name}: truth within two standard deviations, {cell_name}, {when}",
                        100.0 * float(shares.mean()), "%", 95.45, "a normal distribution", "higher", "90–99 %",
                    )
                )  # fmt: skip
    return figures


def _inside(cell: Cell, seed: int, estimator: Estimator) -> FloatArray:
    """Return the shares of all values within two standard deviations, early and late, (2,)."""
    rng = np.random.default_rng(9700 + seed)
    off = np.clip(rng.standard_normal(6), -FARTHEST, FARTHEST)
    circuit = cell.circuit
    wrong = {name: getattr(circuit, name) * np.exp(INITIAL_SD[name] * off[k]) for k, name in enumerate(VALUES[:4])}
    soc = float(np.clip(cell.soc + INITIAL_SD["soc"] * off[4], 0.05, 0.98))
    # Sensors of small cells are better than the usual ones, as their makers have it.
    scale = min(circuit.capacity_ah / 2.0, 1.0)
    bias = scale * usual_bias_a(circuit.capacity_ah)
    pack = replace(
        pack_of(cell, HOURS / 24.0), seed=9700 + seed, current_bias_a=bias * off[5], current_noise_a=0.01 * scale
    )
    data = virtual_pack(pack)
    config = BatteryConfig(Cell(cell.curve, Circuit(**wrong), soc), current_bias_a=bias, current_noise_a=0.01 * scale)
    record = cell_record(data.record, config)
    run = estimator(record, config, None, silent)
    constant = np.tile([getattr(circuit, name) for name in VALUES[1:4]], (len(record.keep), 1))
    truth = np.column_stack([data.capacity_ah[record.keep], constant, data.soc[record.keep]])
    # What is estimated of a parameter is its logarithm; while little is known the difference matters.
    score = (run.values - truth) / run.sds
    score[:, :4] = np.log(run.values / truth)[:, :4] * (run.values / run.sds)[:, :4]
    at = record.t_s[record.keep]
    held = np.abs(score) < 2.0
    return np.array([held[(at > EARLY_S) & (at <= LATE_S)].mean(), held[at > LATE_S].mean()])
