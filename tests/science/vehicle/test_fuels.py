"""What fuels hold, against the same directive's energies by mass, and what that makes of specific consumption."""

from __future__ import annotations

import numpy as np
import pytest

from app.science.engine.cells import specific_consumption_gpkwh
from app.science.errors import VehicleConfigError
from app.science.vehicle.fuels import FUELS, find_fuel
from app.science.vehicle.xml import examine_vehicle, new_car_xml, read_vehicle

BY_MASS = {"petrol": 43.0, "diesel": 43.0, "lpg": 46.0}
ETHANOL_MJPKG, ETHANOL_KGPL, PETROL_KGPL = 27.0, 0.794, 0.745
"""Directive (EU) 2018/2001, Annex III, MJ/kg."""


def blend(ethanol: float) -> float:
    """Energy by mass of a blend of so much ethanol by volume, MJ/kg."""
    masses = np.array([ethanol * ETHANOL_KGPL, (1.0 - ethanol) * PETROL_KGPL])
    return float(masses @ [ETHANOL_MJPKG, BY_MASS["petrol"]] / masses.sum())


@pytest.mark.parametrize(
    ("name", "mjpkg"), [*BY_MASS.items(), ("e10", blend(0.10)), ("e85", blend(0.85))], ids=lambda value: str(value)
)
def test_energy_by_mass_and_specific_consumption(name: str, mjpkg: float) -> None:
    fuel = FUELS[name]
    assert fuel.energy_j_per_l / fuel.density_kg_per_l == pytest.approx(1e6 * mjpkg, rel=0.025)
    car = read_vehicle(new_car_xml({"fuel@type": name}))
    (consumption,) = specific_consumption_gpkwh(np.array([0.36]), car)
    assert consumption == pytest.approx(3600.0 / 0.36 / mjpkg, rel=0.025)


@pytest.mark.parametrize(
    ("written", "meant"),
    [("Diesel", "diesel"), (" GPL ", "lpg"), ("SP95-E10", "e10"), ("Superethanol", "e85"), ("gasoline", "petrol")],
)
def test_names_as_people_write_them(written: str, meant: str) -> None:
    found = find_fuel(written)
    assert found is not None
    assert found.name == meant


def test_an_unknown_fuel_needs_its_energy_and_says_what_is_assumed_of_its_density() -> None:
    with pytest.raises(VehicleConfigError, match="isn't a fuel Ponthy knows; give its energy"):
        new_car_xml({"fuel@type": "methanol"})
    reading = examine_vehicle(new_car_xml({"fuel@type": "methanol", "fuel@energy": 15.8}))
    assert reading.vehicle.fuel_energy_j_per_l == 15.8e6
    assert any("petrol's density of 0.745 kg/l is assumed" in remark for remark in reading.warnings)
    known = examine_vehicle(new_car_xml({"fuel@type": "methanol", "fuel@energy": 15.8, "fuel@density": 0.792}))
    assert not any("is assumed" in remark for remark in known.warnings)


@pytest.mark.parametrize(
    ("path", "absurd"),
    [("mass@wet", -900.0), ("drag/aero@Cd", 40.0), ("drag/rolling@Crr", 0.5), ("fuel@energy", 900.0)],
)
def test_absurd_values_are_refused_with_their_line_and_limits(path: str, absurd: float) -> None:
    element, _, attribute = path.partition("@")
    xml = new_car_xml()
    name = element.rpartition("/")[2].encode()
    lines = xml.splitlines()
    at = next(i for i, line in enumerate(lines) if b"<" + name in line and attribute.encode() in line)
    lines[at] = lines[at].replace(f'{attribute}=""'.encode(), f'{attribute}="{absurd}"'.encode())
    with pytest.raises(VehicleConfigError, match="must lie between") as caught:
        read_vehicle(b"\n".join(lines))
    assert caught.value.line == at + 1
