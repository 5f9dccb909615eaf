"""From the single values of a car's XML to the car: do they fit together, and what is it then."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from app.science.vehicle.battery import BatterySpec
from app.science.vehicle.battery_checks import find_battery_conflict
from app.science.vehicle.element_kinds import GEARS
from app.science.vehicle.elements import FIELD_OF
from app.science.vehicle.field import Value
from app.science.vehicle.fuels import find_fuel
from app.science.vehicle.model import INJECTION_DOUBTS, Injection, Mounting, Vehicle
from app.science.vehicle.quantities import cylinder_count, parse_list, parse_rating, tyre_radius_m


@dataclass(frozen=True, slots=True)
class Conflict:
    """A value that can't stand beside the others, and why."""

    path: str
    problem: str


def find_conflict(values: Mapping[str, Value]) -> Conflict | None:
    """Return the first value (by `Field.path`) that is possible alone but not together with the others, or None."""
    before: tuple[str, float] | None = None
    gap = ""
    for gear in GEARS:
        path = f"transmission/{gear}@gear"
        ratio = values.get(path)
        if not isinstance(ratio, float):
            gap = gap or gear
            continue
        if gap:
            return Conflict(path, f"stands without a {gap} gear; fill that in, or leave this one empty")
        if before and ratio >= before[1]:
            return Conflict(
                path, f"{ratio:g} isn't smaller than the {before[0]} gear's {before[1]:g}; ratios must fall"
            )
        before = (gear, ratio)
    if values.get("inj/timing@pattern") == "grouped" and "inj/timing@groups" not in values:
        return Conflict("inj/timing@pattern", "“grouped” needs groups=…, the number of injector groups")
    fuel = values.get("fuel@type")
    if isinstance(fuel, str) and find_fuel(fuel) is None and "fuel@energy" not in values:
        return Conflict("fuel@type", f"“{fuel}” isn't a fuel Ponthy knows; give its energy in MJ/l beside it")
    found = find_battery_conflict(values)
    return Conflict(*found) if found else None


def remarks_together(values: Mapping[str, Value]) -> list[str]:
    """Return what is odd about the values (by `Field.path`) as a whole, in sentences."""
    remarks = []
    first = values.get("transmission/first@gear")
    if isinstance(first, float) and first < 6.0:
        remarks.append(
            f"The first gear's ratio of {first:g} looks like the gearbox alone; the final drive belongs into it."
        )
    engine = values.get("engine/type@type")
    if values.get("inj/timing@pattern") == "simultaneous" and cylinder_count(str(engine or "")) is None:
        remarks.append(
            f"The engine's description doesn't tell its cylinders, which simultaneous injection needs; "
            f"{Vehicle().cylinders} are assumed."
        )
    fuel = values.get("fuel@type")
    if isinstance(fuel, str) and find_fuel(fuel) is None and "fuel@density" not in values:
        remarks.append(
            f"“{fuel}” isn't a fuel Ponthy knows; petrol's density of {Vehicle().fuel_density_kg_per_l:g} kg/l is "
            "assumed for its consumption in g/kWh. Give its density beside its energy."
        )
    system = values.get("inj/system@type")
    if system in INJECTION_DOUBTS:
        remarks.append(INJECTION_DOUBTS[str(system)])
    return remarks


def assemble(values: Mapping[str, Value], load_kg: float, files: tuple[str, ...]) -> Vehicle:
    """Put the values of a file, by `Field.path` in the fields' units, over the defaults of `Vehicle`."""
    parts: dict[str, dict[str, Any]] = {"": {}, "mounting": {}, "injection": {}, "battery": {}}
    for path, value in values.items():
        field = FIELD_OF[path]
        owner, _, name = field.target.rpartition(".")
        if owner == "gear_ratios" or field.form == "rating":
            continue
        if field.form == "whole":
            parts[owner][name] = int(value)
        elif field.kind == "list":
            parts[owner][name] = parse_list(str(value))
        else:
            parts[owner][name] = value * field.si if isinstance(value, float) else value
    own = parts[""]
    gears = (values.get(f"transmission/{gear}@gear") for gear in GEARS)
    own["gear_ratios"] = tuple(ratio for ratio in gears if isinstance(ratio, float))
    for path, stem, unit in (("engine/power@power", "power", "w"), ("engine/torque@torque", "torque", "nm")):
        field = FIELD_OF[path]
        if path in values and field.quantity:
            rating = parse_rating(str(values[path]), field.quantity)
            own |= {f"max_{stem}_{unit}": rating.value * field.si, f"max_{stem}_rpm": rating.rpm}
    own["cylinders"] = cylinder_count(own.get("engine_type", "")) or Vehicle().cylinders
    if "tyre" in own and "wheel_radius_m" not in own:
        own["wheel_radius_m"] = tyre_radius_m(own["tyre"])
    fuel = find_fuel(own.get("fuel_name", "petrol"))
    if fuel:
        own.setdefault("fuel_energy_j_per_l", fuel.energy_j_per_l)
        own.setdefault("fuel_density_kg_per_l", fuel.density_kg_per_l)
    mounting, injection = Mounting(**parts["mounting"]), Injection(**parts["injection"])
    battery = BatterySpec(**parts["battery"]) if parts["battery"] else None
    return Vehicle(mounting=mounting, injection=injection, battery=battery, load_kg=load_kg, files=files, **own)
