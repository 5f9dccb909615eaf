"""Fuel power over engine power: Willans lines with a friction that grows with engine speed, monotone and convex.

P_in = k₀ + k₁ ω + k₂ ω² + a P + b P² ω⁻¹, with P = ω T and every coefficient at least zero: fuel never falls with
load, and each further watt costs at least as much as the one before. The first four terms are Willans' line with a
friction that depends on engine speed, the last one bends it towards full load. Where the data want it otherwise, that
is said.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.optimize import nnls

from app.science.arrays import FloatArray
from app.science.engine.fitting.polynomial import SPARE_CELLS, Cells
from app.science.engine.fitting.terms import FitError

TERMS = 5
SIGNIFICANT = 3.0


@dataclass(frozen=True, slots=True)
class WillansFit:
    """A monotone, convex fuel model.

    Attributes
    ----------
    coefficients : array, shape (5,)
        Of 1, ω, ω², P and P²/ω, giving watts for rad/s and watts.
    r_squared, rmse_w : float
    efficiency_rmse : float
        Of the efficiency that the model gives, over the cells.
    non_convexity : float
        How many standard errors the freely fitted curvature in torque is below zero; 0 when it isn't. Above 3 the data
        contradict a convex model, and steady driving at the best point may lose against pulse and glide.
    """

    coefficients: FloatArray
    r_squared: float
    rmse_w: float
    efficiency_rmse: float
    non_convexity: float

    @property
    def is_convex(self) -> bool:
        """Whether the data allow a convex model."""
        return self.non_convexity <= SIGNIFICANT

    def fuel_power_w(self, omega: FloatArray, torque: FloatArray) -> FloatArray:
        """Return fuel power, W, at these engine speeds (rad/s) and torques (Nm)."""
        return _columns(omega, torque) @ self.coefficients

    def idle_fuel_power_w(self, omega: float) -> float:
        """Return the fuel power without load, W."""
        return float(self.fuel_power_w(np.array([omega]), np.zeros(1))[0])


def fit_willans(cells: Cells) -> WillansFit:
    """Fit the model to the cells of a map.

    Raises
    ------
    FitError
        When there are too few cells.
    """
    if len(cells) < TERMS + SPARE_CELLS:
        raise FitError(f"{len(cells)} trusted cells can't carry a Willans model of {TERMS} terms. Drive on.")
    y = cells.values("p_in")
    columns = _columns(cells.omega, cells.torque)
    root, scale = np.sqrt(cells.weight), np.sqrt(np.mean(columns**2, axis=0))
    scaled, _ = nnls(root[:, None] * columns / scale, root * y)
    coefficients = scaled / scale
    fitted = columns @ coefficients
    left = y - fitted
    engine_power = cells.omega * cells.torque
    return WillansFit(
        coefficients=coefficients,
        r_squared=1.0 - float(np.sum(cells.weight * left**2) / np.sum(cells.weight * (y - np.mean(y)) ** 2)),
        rmse_w=float(np.sqrt(np.average(left**2, weights=cells.weight))),
        efficiency_rmse=float(np.sqrt(np.mean((engine_power / fitted - cells.efficiency) ** 2))),
        non_convexity=_non_convexity(columns, y, root),
    )


def _columns(omega: FloatArray, torque: FloatArray) -> FloatArray:
    power = omega * torque
    return np.column_stack([np.ones_like(omega), omega, omega**2, power, power**2 / omega])


def _non_convexity(columns: FloatArray, y: FloatArray, root: FloatArray) -> float:
    """Return by how many standard errors the curvature term wants to be negative."""
    scale = np.sqrt(np.mean(columns**2, axis=0))
    design, wanted = root[:, None] * columns / scale, root * y
    free, *_ = np.linalg.lstsq(design, wanted, rcond=None)
    left = wanted - design @ free
    variance = float(left @ left) / (len(y) - TERMS)
    spread = np.linalg.pinv(design.T @ design)
    return max(0.0, -float(free[-1]) / np.sqrt(variance * spread[-1, -1])) if variance > 0.0 else 0.0
