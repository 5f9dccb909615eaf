"""Sections added up: parts, cells of the map, and litres."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from app.science.arrays import FloatArray
from app.science.eco.fuel_model import FuelModel
from app.science.eco.losses import in_cells, lost_along, parts
from app.science.eco.result import PARTS, CellLoss, Loss
from app.science.eco.sections import Compared
from app.science.optimal.problem import RADPS_PER_RPM


@dataclass(frozen=True, slots=True)
class Scale:
    """What modelled joules are in litres and percent.

    Attributes
    ----------
    l_per_j : float
        Measured litres for a modelled joule of the scored driving.
    driven_j : float
    """

    l_per_j: float
    driven_j: float

    def loss(self, name: str, energy_j: float) -> Loss:
        """Return a part."""
        return Loss(name, energy_j, energy_j * self.l_per_j, 100.0 * energy_j / self.driven_j)

    def losses(self, energies_j: Mapping[str, float]) -> tuple[Loss, ...]:
        """Return parts in their order."""
        return tuple(self.loss(name, energy) for name, energy in energies_j.items())


def parts_of(compared: Sequence[Compared]) -> list[dict[str, float]]:
    """Return the parts of each section, J."""
    return [parts(one.driven, one.best) for one in compared]


def summed(sections: Sequence[Mapping[str, float]]) -> dict[str, float]:
    """Return the parts of all sections, J."""
    return {name: sum(section[name] for section in sections) for name in PARTS}


def lost_pieces(compared: Sequence[Compared], accelerated_kg: float) -> list[FloatArray]:
    """Return for each section what was lost at each piece of the driven ride, J."""
    return [lost_along(one.driven, one.best, accelerated_kg) for one in compared]


def by_cell(
    compared: Sequence[Compared], lost_j: Sequence[FloatArray], model: FuelModel, scale: Scale
) -> tuple[tuple[CellLoss, ...], tuple[Loss, ...]]:
    """Return what was lost in each cell of the map, and what was lost while the engine ran in none."""
    lost = np.concatenate(lost_j)
    dt = np.concatenate([one.driven.ride.dt_s for one in compared])
    fuel = np.concatenate([one.driven.took.fuel_w for one in compared]) * dt
    pulling = np.concatenate([in_cells(one.driven) for one in compared])
    braking = ~pulling & (np.concatenate([one.driven.took.brake_w for one in compared]) > 0.0)
    rpm = np.concatenate([one.driven.ride.engine_radps for one in compared])[pulling] / RADPS_PER_RPM
    nm = np.concatenate([one.driven.took.torque_nm for one in compared])[pulling]
    where = np.stack((np.floor(rpm / model.cell_rpm), np.floor(nm / model.cell_nm)), axis=1)
    cells, index = np.unique(where, axis=0, return_inverse=True)
    index = index.ravel()
    sums = [np.bincount(index, values[pulling]) for values in (dt, fuel, lost)]
    found = tuple(
        CellLoss(
            (i + 0.5) * model.cell_rpm, (j + 0.5) * model.cell_nm, seconds, burnt * scale.l_per_j, lost * scale.l_per_j
        )
        for (i, j), seconds, burnt, lost in zip(cells.tolist(), *(s.tolist() for s in sums), strict=True)
    )
    rolling = ~pulling & ~braking
    return found, scale.losses({"braking": float(lost[braking].sum()), "rolling": float(lost[rolling].sum())})
