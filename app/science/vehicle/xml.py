"""The car's XML (Sebesta 2010, App. C.1.2) ⇄ `Vehicle`."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from math import isfinite

from app.science.errors import VehicleConfigError
from app.science.vehicle.assemble import assemble, find_conflict, remarks_together
from app.science.vehicle.battery_checks import battery_remarks
from app.science.vehicle.document import ROOT, ConfigDocument
from app.science.vehicle.elements import FIELD_OF, FIELDS
from app.science.vehicle.field import Field, Value, value_of
from app.science.vehicle.fuels import find_fuel
from app.science.vehicle.model import Vehicle
from app.science.vehicle.quantities import cylinder_count, format_number, tyre_radius_m
from app.science.vehicle.template import TEMPLATE

LONGEST_SHOWN = 80
"""Characters of a value that a refusal repeats."""


@dataclass(frozen=True, slots=True)
class VehicleReading:
    """A car's XML, understood.

    Attributes
    ----------
    vehicle : Vehicle
        The car.
    defaulted : tuple of str
        Paths (`Field.path`) of values that the science uses and the file leaves open, so that a default stands in.
    warnings : tuple of str
        What is odd but possible, with its line.
    unknown : tuple of str
        ``element@attribute`` that Ponthy keeps but doesn't read.
    """

    vehicle: Vehicle
    defaulted: tuple[str, ...]
    warnings: tuple[str, ...]
    unknown: tuple[str, ...]


def read_vehicle(xml: bytes, *, load_kg: float = 75.0) -> Vehicle:
    """Read a car's XML; every element is optional.

    Parameters
    ----------
    xml : bytes
        The file.
    load_kg : float
        Driver and things, which ``mass wet`` leaves out; 75 kg in the thesis.

    Returns
    -------
    Vehicle
        In SI units, with the defaults of Sebesta 2010, Table 3.1 where the file is silent.

    Raises
    ------
    VehicleConfigError
        When the file isn't the XML of a car, or a value can't be: with line and element.
    """
    return examine_vehicle(xml, load_kg=load_kg).vehicle


def examine_vehicle(xml: bytes, *, load_kg: float = 75.0) -> VehicleReading:
    """Read a car's XML as `read_vehicle` does, and tell what was defaulted, odd or unknown."""
    if not (isfinite(load_kg) and 0.0 <= load_kg <= 50_000.0):
        raise VehicleConfigError(f"A load of {load_kg} kg can't be; give driver and things in kg, usually 75.")
    document = ConfigDocument(xml)
    values: dict[str, Value] = {}
    warnings: list[str] = []
    for field in FIELDS:
        found = document.find(field.element, field.attribute)
        if found is None:
            continue
        try:
            values[field.path] = field.read(found.text)
        except ValueError as error:
            text = found.text if len(found.text) <= LONGEST_SHOWN else f"{found.text[:LONGEST_SHOWN]}…"
            raise _refusal(document, field.path, f"“{text}” {error}") from error
        if remark := field.remark(values[field.path]):
            warnings.append(f"Line {found.line}, {field.path}: “{found.text}” {remark}.")
        if len(set(document.values(field.element, field.attribute))) > 1:
            warnings.append(f"Line {found.line}, {field.path} is given more than once; “{found.text}” is used.")
    if conflict := find_conflict(values):
        raise _refusal(document, conflict.path, conflict.problem)
    warnings.extend(remarks_together(values))
    known = FIELD_OF.keys() | {"file@Name"}
    unknown = (path for path, _ in document.attributes() if path not in known)
    vehicle = assemble(values, load_kg, document.values("file", "Name"))
    warnings.extend(battery_remarks(values, vehicle.battery))
    return VehicleReading(
        vehicle,
        tuple(field.path for field in FIELDS if _is_defaulted(field, values)),
        tuple(warnings),
        tuple(dict.fromkeys(unknown)),
    )


def write_vehicle(xml: bytes | None, changes: Vehicle | Mapping[str, Value | None]) -> bytes:
    """Change values of a car's XML and nothing else: comments, unknown elements, order and encoding stay.

    Parameters
    ----------
    xml : bytes or None
        The file to change; None begins a new one.
    changes : Vehicle or mapping of str to float, str or None
        By `Field.path`, numbers in the field's unit; None empties a value. A `Vehicle` sets everything it says
        (its load, air density and gravity are not the car's and stay outside).

    Returns
    -------
    bytes
        The very same bytes when nothing differs.

    Raises
    ------
    VehicleConfigError
        When the file can't be read, a path is unknown, or the result would not be a car.
    """
    wanted = values_of(changes) if isinstance(changes, Vehicle) else changes
    document = ConfigDocument(TEMPLATE if xml is None else xml)
    for path, value in wanted.items():
        field = FIELD_OF.get(path)
        if field is None:
            raise VehicleConfigError(f"There is no value {path!r} in a car's XML; see the form's fields.", 0, path)
        found = document.find(field.element, field.attribute)
        before = found.text if found else ""
        try:
            text = new_text(field, value, before)
        except ValueError as error:
            raise VehicleConfigError(f"{path}: “{value}” {error}.", 0, f"{ROOT}/{field.element}") from error
        if text != before:
            document.put(field.element, field.attribute, text)
    result = document.to_bytes()
    examine_vehicle(result)
    return result


def new_car_xml(changes: Mapping[str, Value | None] | None = None) -> bytes:
    """Return the XML of a new car: every element with an explanation, empty but for `changes`."""
    return write_vehicle(None, changes or {})


def config_fingerprint(xml: bytes) -> str:
    """Return a SHA-256 (hex) on which files agree that differ only in comments, blanks, quotes or attribute order.

    What they say of a battery doesn't count either: no trip is observed with it, so none has to be run again for it.

    Raises
    ------
    VehicleConfigError
        When the file isn't the XML of a car.
    """
    return ConfigDocument(xml).fingerprint()


def new_text(field: Field, value: Value | None, before: str) -> str:
    """Return the text to write for a value: `before` itself when it already means that.

    Raises
    ------
    ValueError
        When the value is not one the field takes.
    """
    if value is None or value == "":
        return ""
    text = value if isinstance(value, str) else format_number(float(value))
    meant = field.read(text)
    try:
        if before and field.read(before) == meant:
            return before
    except ValueError:
        before = ""  # the old text was unusable: don't take its manner over
    if isinstance(value, str) or isinstance(meant, str) or field.quantity is None:
        return text.strip()
    return field.quantity.render(meant, before)


def values_of(vehicle: Vehicle) -> dict[str, Value | None]:
    """Return what a car says as values by `Field.path`, in the fields' units."""
    values: dict[str, Value | None] = {}
    for field in FIELDS:
        value = value_of(vehicle, field.target)
        values[field.path] = value / field.si if isinstance(value, float) else value
    values["engine/power@power"] = _rating_text(vehicle.max_power_w, 1e-3, "kW", vehicle.max_power_rpm)
    values["engine/torque@torque"] = _rating_text(vehicle.max_torque_nm, 1.0, "Nm", vehicle.max_torque_rpm)
    if (cylinder_count(vehicle.engine_type) or Vehicle().cylinders) != vehicle.cylinders:
        values["engine/type@type"] = f"{vehicle.engine_type} {vehicle.cylinders} cyl".strip()
    if vehicle.tyre and tyre_radius_m(vehicle.tyre) == vehicle.wheel_radius_m:
        values["wheels/radius@m"] = None
    fuel = find_fuel(vehicle.fuel_name)
    if fuel and vehicle.fuel_energy_j_per_l == fuel.energy_j_per_l:
        values["fuel@energy"] = None
    if fuel and vehicle.fuel_density_kg_per_l == fuel.density_kg_per_l:
        values["fuel@density"] = None
    if vehicle.injection.pattern != "grouped":
        values["inj/timing@groups"] = None
    return values


def _rating_text(value: float | None, scale: float, unit: str, rpm: float | None) -> str | None:
    if value is None:
        return None
    return f"{format_number(value * scale)}{unit}" + (f" @{format_number(rpm)}rpm" if rpm is not None else "")


def _refusal(document: ConfigDocument, path: str, problem: str) -> VehicleConfigError:
    field = FIELD_OF[path]
    found = document.find(field.element, field.attribute)
    line = found.line if found else 0
    return VehicleConfigError(f"Line {line}, {path}: {problem}.", line, f"{ROOT}/{field.element}")


def _is_defaulted(field: Field, values: Mapping[str, Value]) -> bool:
    if field.path in values or field.default is None:
        return False
    return not (field.form == "tyre" and "wheels/radius@m" in values)
