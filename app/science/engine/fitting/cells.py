"""What a formula is fitted through: a map's trusted cells, and the engine at idle."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

import numpy as np

from app.science.arrays import BoolArray, FloatArray, IntArray
from app.science.engine.efficiency_map import EfficiencyMap, Idle
from app.science.engine.fitting.terms import FitError

Target = Literal["eta", "phi", "p_in"]
TARGETS: tuple[Target, ...] = ("eta", "phi", "p_in")
RADPS_PER_RPM = np.pi / 30.0
FOLDS = 10
BLOCK_RPM, BLOCK_NM = 250.0, 10.0
LOWEST_EFFICIENCY = 1e-3
BORDER_BEYOND = 1.25


@dataclass(frozen=True, slots=True)
class Cells:
    """What a formula is fitted through, each array of shape (n,): rad/s, Nm, 1, and each cell's weight.

    Rows of efficiency 0 take part in the fit without being judged by it: the border of the first remedy is no data, and
    an idling engine has no efficiency. The latter has torque 0 and its fuel power, W, in ``idle_fuel_power_w``, which
    is NaN elsewhere.
    """

    omega: FloatArray
    torque: FloatArray
    efficiency: FloatArray
    weight: FloatArray
    idle_fuel_power_w: FloatArray | None = None

    def values(self, target: Target) -> FloatArray:
        """Return the target's values: η, 1/η, or P_in = ωT/η in watts."""
        if target == "eta":
            return self.efficiency
        if target == "phi":
            return 1.0 / self.efficiency
        if self.idle_fuel_power_w is None:
            return self.omega * self.torque / self.efficiency
        driving = np.where(self.judged, self.efficiency, 1.0)
        return np.where(self.judged, self.omega * self.torque / driving, self.idle_fuel_power_w)

    @property
    def judged(self) -> BoolArray:
        """Tell which rows are data with an efficiency, shape (n,)."""
        return np.asarray(self.efficiency > 0.0)

    def __len__(self) -> int:
        return len(self.omega)


def trusted_cells(efficiency_map: EfficiencyMap, *, fewest: int, weighted: bool = False) -> Cells:
    """Return the trusted cells of a map; weighted, a cell counts by how well its mean is known.

    Raises
    ------
    FitError
        When they are fewer than ``fewest``, or all at one engine speed or one torque.
    """
    m = efficiency_map
    known = np.isfinite(m.efficiency) & (m.efficiency > LOWEST_EFFICIENCY) & (m.nm > 0.0) & (m.rpm > 0.0)
    rpm, nm = m.rpm[known], m.nm[known]
    if len(rpm) < fewest:
        raise FitError(f"The map has {len(rpm)} trusted cells; a formula needs more. Drive on, then try again.")
    for values, what, unit in ((rpm, "engine speed", "rpm"), (nm, "torque", "Nm")):
        if np.ptp(values) == 0.0:
            raise FitError(
                f"All trusted cells are at one {what} ({values[0]:g} {unit}), so nothing tells how efficiency changes "
                "with it. Drive with others, too."
            )
    weight = np.ones(len(rpm))
    if weighted:
        error = np.maximum(m.sd[known], 0.005) ** 2 / m.n[known]
        finite = np.isfinite(error)
        weight = np.min(error[finite]) / np.where(finite, error, np.max(error[finite])) if finite.any() else weight
    return Cells(rpm * RADPS_PER_RPM, nm, m.efficiency[known], weight)


def with_border(cells: Cells) -> Cells:
    """Return the cells with a column of no efficiency to the right of them, the thesis' first remedy; for η only."""
    torque = np.unique(cells.torque)
    omega = np.full(len(torque), BORDER_BEYOND * float(cells.omega.max()))
    return Cells(
        np.concatenate([cells.omega, omega]),
        np.concatenate([cells.torque, torque]),
        np.concatenate([cells.efficiency, np.zeros(len(torque))]),
        np.concatenate([cells.weight, np.full(len(torque), float(np.mean(cells.weight)))]),
    )


def with_idle(cells: Cells, idle: Idle, scatter_w: float) -> Cells:
    """Return the cells with the idling engine at torque 0; for P_in only.

    Parameters
    ----------
    cells : Cells
    idle : Idle
        Counts by how much better it is known than a cell, at most as much as all cells together.
    scatter_w : float
        How far P_in of a cell lies from a formula without idle, W.
    """
    times = np.clip((scatter_w / max(idle.fuel_power_sd_w, 1.0)) ** 2, 1.0, len(cells))
    return Cells(
        np.append(cells.omega, idle.rpm * RADPS_PER_RPM),
        np.append(cells.torque, 0.0),
        np.append(cells.efficiency, 0.0),
        np.append(cells.weight, times * float(np.mean(cells.weight))),
        np.append(np.full(len(cells), np.nan), idle.fuel_power_w),
    )


def folds(cells: Cells) -> IntArray:
    """Return which tenth each cell belongs to; neighbours stay together, else one would tell the other's value."""
    column = np.floor(cells.omega / (BLOCK_RPM * RADPS_PER_RPM)).astype(np.int64)
    row = np.floor(cells.torque / BLOCK_NM).astype(np.int64)
    return (3 * column + 7 * row + column * row) % FOLDS
