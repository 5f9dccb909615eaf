"""From changes as the linear model sees them to true ones."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from app.science.arrays import FloatArray
from app.science.health.evidence import ENGINE, POWERS
from app.science.health.usual import QUANTITIES, Usual

LARGEST_EFFICIENCY_CHANGE = 20.0
"""In %; beyond, the engine's force would be asked far outside of where it is known."""


@dataclass(frozen=True, slots=True)
class Scale:
    """What a linear change means.

    Of mass: the model multiplies it with the usual acceleration, but a heavier car moves by the same force over M + ΔM,
    so that ΔM = x M / (M − x). Of efficiency: a share s less of it is the usual force at a share s less of fuel power,
    which is not quite linear in s.

    Attributes
    ----------
    mass_kg : float
    efficiency, efficiency_seen : array, shape (n,)
        True changes of efficiency, %, and what the linear model makes of them.
    """

    mass_kg: float
    efficiency: FloatArray
    efficiency_seen: FloatArray

    @classmethod
    def of(cls, usual: Usual, mass_kg: float) -> Scale:
        """Work out the scale of a car's usual."""
        true = np.linspace(-LARGEST_EFFICIENCY_CHANGE, LARGEST_EFFICIENCY_CHANGE, 81)
        exponent = np.array([i for i, _ in POWERS])
        engine, information = usual.coefficients[:ENGINE], usual.information[:ENGINE, :ENGINE]
        slope = 0.01 * exponent * engine
        bent = ((1.0 + 0.01 * true[:, None]) ** exponent - 1.0) * engine
        seen = bent @ information @ slope / (slope @ information @ slope)
        return cls(mass_kg, true, np.maximum.accumulate(seen))

    def true(self, quantity: int, change: float, sd: float) -> tuple[float, float]:
        """Return the true change and its sd, given those of the linear model."""
        name = QUANTITIES[quantity]
        if name == "mass":
            factor = self.mass_kg / max(self.mass_kg - change, 0.5 * self.mass_kg)
            return change * factor, sd * factor**2
        if name == "efficiency" and self.efficiency_seen[0] < change < self.efficiency_seen[-1]:
            around = np.interp([change - sd, change, change + sd], self.efficiency_seen, self.efficiency)
            return float(around[1]), float(0.5 * (around[2] - around[0]))
        return change, sd
