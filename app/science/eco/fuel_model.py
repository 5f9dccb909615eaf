"""What the car's engine burns: one convex formula for the driven trip and for the best drive alike."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from app.science.arrays import FloatArray
from app.science.engine.document import read_map_document
from app.science.engine.fitting.family import FitRequest, fit_map
from app.science.engine.fitting.terms import FitError
from app.science.engine.fitting.willans import WILLANS

LEAST_ERROR = 0.02
"""No formula is believed to be nearer to an engine than this share of its fuel."""


@dataclass(frozen=True, slots=True)
class FuelModel:
    """P_in = k₀ + k₁ω + k₂ω² + aωT + bωT², W, every coefficient at least zero; in overrun it ends at no fuel.

    Attributes
    ----------
    coefficients : array, shape (5,)
        k₀, k₁, k₂, a, b with ω in rad/s and T in Nm.
    idle_w : float
        Burned while the engine turns without moving the car.
    error_share : float
        By how much the formula misses efficiencies of cells that it was not shown, of them.
    cell_rpm, cell_nm : float
        Size of the map's cells.
    rpm : (lowest, highest)
        Of the cells.
    """

    coefficients: FloatArray
    idle_w: float
    error_share: float
    cell_rpm: float
    cell_nm: float
    rpm: tuple[float, float]

    def unloaded_w(self, omega: FloatArray) -> FloatArray:
        """Return what keeps the engine turning without load, W, at engine speeds in rad/s."""
        k0, k1, k2, _, _ = self.coefficients
        return np.asarray(k0 + (k1 + k2 * omega) * omega)

    def fuel_power_w(self, omega: FloatArray, torque: FloatArray) -> FloatArray:
        """Return fuel power, W; 0 in overrun, below the torque at which the formula ends."""
        _, _, _, a, b = self.coefficients
        held = np.maximum(torque, self.overrun_nm(omega))
        return np.asarray(np.maximum(self.unloaded_w(omega) + (a + b * held) * omega * held, 0.0))

    def overrun_nm(self, omega: FloatArray) -> FloatArray:
        """Return the torque at which the fuel is cut, Nm, below 0: what the engine then holds the car back by."""
        _, _, _, a, b = self.coefficients
        drag = self.unloaded_w(omega) / np.maximum(omega, 1e-6)
        root = np.sqrt(np.maximum(a**2 - 4.0 * b * drag, 0.0))
        return np.asarray(-2.0 * drag / (a + root))

    def rescaled(self, ratio: float) -> FuelModel:
        """Return the model that the same fuel gives when every torque is that many times larger."""
        return replace(self, coefficients=self.coefficients / np.array([1.0, 1.0, 1.0, ratio, ratio**2]))

    def of(self, four: FloatArray) -> FuelModel:
        """Return the model with k₀ = 0 and other k₁, k₂, a, b."""
        return replace(self, coefficients=np.concatenate(([0.0], four)))


def fuel_model_of_map(document: Mapping[str, Any]) -> FuelModel | None:
    """Return the fuel model of a map (``map.json``); None where the map has too few cells to carry it."""
    efficiency_map = read_map_document(document)
    try:
        fits = fit_map(efficiency_map, FitRequest(target="p_in"))
        willans = fits.named(WILLANS.name)
    except FitError:
        return None  # what takes its place is said in the score
    formula, idle = willans.formula, fits.idle
    typical = float(np.nanmedian(efficiency_map.efficiency))
    return FuelModel(
        coefficients=formula.coefficients,
        idle_w=idle.fuel_power_w if idle is not None else max(willans.idle_fuel_power_w or 0.0, 0.0),
        error_share=max(formula.cross_validated_eta / typical, LEAST_ERROR),
        cell_rpm=efficiency_map.grid.rpm,
        cell_nm=efficiency_map.grid.nm,
        rpm=(float(fits.area.rpm[0]), float(fits.area.rpm[-1])),
    )
