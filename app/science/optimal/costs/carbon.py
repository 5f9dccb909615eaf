"""How much carbon dioxide a fuel becomes.

Carbon by mass of the fuels of JEC Well-to-Tank v5 (petrol 86.4 %, diesel 86.1 %, ethanol 52.2 %, LPG 82.4 %), blends by
mass of 10 and 85 volume per cent ethanol of 0.794 kg/l; with density and energy of `app.science.vehicle.fuels`. All
carbon counts that leaves the tailpipe, of whatever origin, and none that was spent before the tank.
"""

from __future__ import annotations

from collections.abc import Mapping

from app.science.vehicle.fuels import FUELS

CO2_PER_CARBON = 44.0095 / 12.0107
_PETROL, _ETHANOL = 0.864, 0.522
_ETHANOL_KG_PER_L = 0.794


def _blend(ethanol: float) -> float:
    """Return the carbon by mass of petrol with a share of ethanol by volume."""
    parts = {_ETHANOL: ethanol * _ETHANOL_KG_PER_L, _PETROL: (1.0 - ethanol) * FUELS["petrol"].density_kg_per_l}
    return sum(share * mass for share, mass in parts.items()) / sum(parts.values())


CARBON: Mapping[str, float] = {
    "petrol": _PETROL,
    "diesel": 0.861,
    "e10": _blend(0.10),
    "e85": _blend(0.85),
    "lpg": 0.824,
}
"""Share of carbon by mass, by the name of the fuel."""


def co2_g_per_mj(fuel_name: str) -> float:
    """Return the CO2 of a fuel by its name in `FUELS`, g for each MJ."""
    fuel = FUELS[fuel_name]
    return CARBON[fuel_name] * CO2_PER_CARBON * 1e9 * fuel.density_kg_per_l / fuel.energy_j_per_l
