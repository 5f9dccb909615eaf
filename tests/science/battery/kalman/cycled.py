"""Cells of known truth that are driven and charged for days, with wrong guesses to begin with."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from app.science.arrays import FloatArray
from app.science.battery.circuit import Cell, Circuit
from app.science.battery.config import BatteryConfig
from app.science.battery.curve import OpenCircuit
from app.science.battery.pack import cell_record
from app.science.battery.run import CellRecord, Run
from app.science.battery.virtual.a123 import CELL, GUESS
from app.science.battery.virtual.ageing import DegradationMap
from app.science.battery.virtual.pack import VirtualPack, pack_of, virtual_pack

NICKEL = OpenCircuit(
    points=((0.0, 3.0), (0.05, 3.3), (0.2, 3.52), (0.4, 3.62), (0.6, 3.78), (0.8, 4.0), (0.95, 4.12), (1.0, 4.2))
)
LARGE = Cell(NICKEL, Circuit(60.0, 1.2e-3, 30_000.0, 0.8e-3), soc=0.75)
LARGE_GUESS = Cell(NICKEL, Circuit(66.0, 1.6e-3, 24_000.0, 1.0e-3), soc=0.55)


@dataclass(frozen=True, slots=True)
class Cycled:
    """A record, what an estimator begins with, and the truth at the kept rows, (m, 5) in the order of `VALUES`."""

    record: CellRecord
    config: BatteryConfig
    truth: FloatArray

    def scores(self, run: Run) -> FloatArray:
        """Return errors over their standard deviations, (m, 5)."""
        return (run.values - self.truth) / run.sds


def cycled(
    days: float,
    seed: int,
    *,
    cell: Cell = CELL,
    guess: Cell = GUESS,
    bias_a: float = 0.02,
    noise_v: float = 2e-3,
    fade: DegradationMap | None = None,
    **settings: float,
) -> Cycled:
    pack = replace(pack_of(cell, days), seed=seed, current_bias_a=bias_a, voltage_noise_v=noise_v, fade=fade)
    if cell is CELL:
        pack = VirtualPack(days, seed=seed, current_bias_a=bias_a, voltage_noise_v=noise_v, fade=fade)
    data = virtual_pack(pack)
    config = BatteryConfig(guess, **settings)  # type: ignore[arg-type]  # settings of numbers alone
    record = cell_record(data.record, config)
    truth = np.empty((len(record.keep), 5))
    truth[:, 0] = data.capacity_ah[record.keep]
    truth[:, 1] = cell.circuit.resistance_ohm
    truth[:, 2] = cell.circuit.relaxation_capacitance_f
    truth[:, 3] = cell.circuit.relaxation_resistance_ohm
    truth[:, 4] = data.soc[record.keep]
    return Cycled(record, config, truth)
