"""The car's form: what it shows of an XML, and an XML with what was typed in."""

from __future__ import annotations

from collections.abc import Mapping

from app.science.errors import VehicleConfigError
from app.science.vehicle.document import ROOT, ConfigDocument
from app.science.vehicle.elements import FIELD_OF, FIELDS
from app.science.vehicle.field import Field, Value
from app.science.vehicle.xml import new_text, write_vehicle

__all__ = ["FIELDS", "FIELD_OF", "Field", "FormError", "apply_form", "form_values"]


class FormError(VehicleConfigError):
    """Some of the form's values can't be used.

    Parameters
    ----------
    fields : mapping of str to str
        What is wrong, by `Field.path`.
    """

    def __init__(self, fields: Mapping[str, str]) -> None:
        path, problem = next(iter(fields.items()))
        label = FIELD_OF[path].label if path in FIELD_OF else path
        more = f" ({len(fields) - 1} more)" if len(fields) > 1 else ""
        super().__init__(f"{label}: {problem}.{more}", 0, f"{ROOT}/{path.partition('@')[0]}")
        self.fields = dict(fields)


def form_values(xml: bytes) -> dict[str, Value | None]:
    """Return what the file says, for the form.

    Returns
    -------
    dict of str to float, str or None
        By `Field.path`, in the order of `FIELDS`: numbers in the field's unit, None where the file is silent. A value
        that can't be understood is given as its text, so that the form can be used to mend it.

    Raises
    ------
    VehicleConfigError
        When the file isn't the XML of a car.
    """
    document = ConfigDocument(xml)
    values: dict[str, Value | None] = {}
    for field in FIELDS:
        found = document.find(field.element, field.attribute)
        try:
            values[field.path] = field.read(found.text) if found else None
        except ValueError:
            values[field.path] = found.text if found else None
    return values


def apply_form(xml: bytes | None, values: Mapping[str, Value | None]) -> bytes:
    """Return the file with the form's values, changed only where they differ.

    Parameters
    ----------
    xml : bytes or None
        The file as it is; None for a new car.
    values : mapping of str to float, str or None
        By `Field.path`. Paths left out stay as they are; None or an empty text empties a value.

    Raises
    ------
    FormError
        With what is wrong, per field.
    VehicleConfigError
        When the file itself can't be read.
    """
    problems: dict[str, str] = {}
    for path, value in values.items():
        try:
            new_text(FIELD_OF[path], value, "")
        except KeyError:
            problems[path] = "there is no such value in a car's XML"
        except ValueError as error:
            problems[path] = f"“{value}” {error}"
    if problems:
        raise FormError(problems)
    try:
        return write_vehicle(xml, values)
    except VehicleConfigError as error:
        path = _path_in(error, values)
        if not path:
            raise
        raise FormError({path: str(error).partition(f"{path}: ")[2].rstrip(".") or str(error)}) from error


def _path_in(error: VehicleConfigError, values: Mapping[str, Value | None]) -> str:
    """Return the field that a conflict between values was found at, if it is one of the form's."""
    element = error.element.removeprefix(f"{ROOT}/")
    return next((path for path in values if path.partition("@")[0] == element and f"{path}: " in str(error)), "")
