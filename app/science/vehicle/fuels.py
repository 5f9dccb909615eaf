"""What a litre of each common fuel holds.

Energies are lower heating values by volume of Directive (EU) 2018/2001, Annex III (petrol 32, diesel 36, ethanol 21,
propane 24 MJ/l), blends by volume; densities are the middle of EN 228, EN 590 and EN 15376 at 15 °C. Liquefied
petroleum gas may hold any share of butane: its density is what the directive's 24 MJ/l and 46 MJ/kg say together.
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
        Fuel("lpg", 24.0e6, 0.522),
    )
}

_OTHER_NAMES = {
    "gasoline": "petrol",
    "gas": "petrol",
    "e5": "petrol",
    "super": "petrol",
    "benzin": "petrol",
    "essence": "petrol",
    "sp95": "petrol",
    "sp98": "petrol",
    "sp95-e10": "e10",
    "super e10": "e10",
    "gazole": "diesel",
    "gasoil": "diesel",
    "dieselfuel": "diesel",
    "b7": "diesel",
    "autogas": "lpg",
    "propane": "lpg",
    "gpl": "lpg",
    "flexfuel": "e85",
    "superethanol": "e85",
}


def find_fuel(name: str) -> Fuel | None:
    """Return the fuel of that name, by any of its common names, or None."""
    key = name.strip().lower()
    return FUELS.get(_OTHER_NAMES.get(key, key))
