"""What a litre of each common fuel holds.

Energies are lower heating values by volume of Directive (EU) 2018/2001, Annex III (petrol 32, diesel 36, ethanol 21,
propane 24 MJ/l), blends by volume; densities are the middle of EN 228, EN 590, EN 15376 and EN 589 at 15 °C.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

from app.science.vehicle.model import PETROL_DENSITY_KG_PER_L, PETROL_ENERGY_J_PER_L


@dataclass(frozen=True, slots=True)
class Fuel:
    """Energy and density of a fuel."""

    name: str
    energy_j_per_l: float
    density_kg_per_l: float


FUELS: Mapping[str, Fuel] = {
    fuel.name: fuel
    for fuel in (
        Fuel("petrol", PETROL_ENERGY_J_PER_L, PETROL_DENSITY_KG_PER_L),
        Fuel("diesel", 36.0e6, 0.835),
        Fuel("e10", 30.9e6, 0.750),
        Fuel("e85", 22.65e6, 0.787),
        Fuel("lpg", 24.0e6, 0.540),
    )
}

_OTHER_NAMES = {
    "gasoline": "petrol",
    "gas": "petrol",
    "e5": "petrol",
    "super": "petrol",
    "benzin": "petrol",
    "essence": "petrol",
    "gazole": "diesel",
    "gasoil": "diesel",
    "dieselfuel": "diesel",
    "autogas": "lpg",
    "propane": "lpg",
    "flexfuel": "e85",
}


def find_fuel(name: str) -> Fuel | None:
    """Return the fuel of that name, by any of its common names, or None."""
    key = name.strip().lower()
    return FUELS.get(_OTHER_NAMES.get(key, key))
