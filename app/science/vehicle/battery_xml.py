"""The ``<battery>`` of a car's XML written anew, every other byte left as it is."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from xml.sax.saxutils import quoteattr

from app.science.errors import VehicleConfigError
from app.science.vehicle.battery import BatterySpec
from app.science.vehicle.battery_document import spec_of_document
from app.science.vehicle.battery_elements import GROUPS
from app.science.vehicle.document import ROOT, ConfigDocument
from app.science.vehicle.field import value_of
from app.science.vehicle.model import Vehicle
from app.science.vehicle.places import find_places
from app.science.vehicle.quantities import format_number
from app.science.vehicle.xml import read_vehicle

__all__ = ["with_battery"]

INDENT = "  "


def with_battery(xml: bytes, document: object, *, name: str | None = None, end_of_life: float | None = None) -> bytes:
    """Return a car's XML with another battery; all bytes outside ``<battery>`` stay.

    Parameters
    ----------
    xml : bytes
        The car's file.
    document : object
        A battery's configuration as JSON has it; None takes the battery out.
    name, end_of_life : optional
        What to call it, and the share of the rated capacity down to which it serves; None leaves both as they are.

    Returns
    -------
    bytes
        The very same bytes when the file says all that already.

    Raises
    ------
    VehicleConfigError
        When the file isn't the XML of a car, or the battery couldn't be read back.
    ProblemError
        When the document holds what no XML could.
    """
    before = read_vehicle(xml).battery
    wanted = None if document is None else _wanted(spec_of_document(document), before, name, end_of_life)
    if wanted == before:
        return xml
    result = _spliced(xml, wanted)
    after = read_vehicle(result).battery
    if after != wanted:
        raise VehicleConfigError("The battery would not read back as it was given.", 0, f"{ROOT}/battery")
    return result


def _wanted(spec: BatterySpec, before: BatterySpec | None, name: str | None, end_of_life: float | None) -> BatterySpec:
    known = before or BatterySpec()
    if known.capacity_ah is None and spec.capacity_ah == known.rated_capacity_ah == spec.rated_capacity_ah:
        spec = replace(spec, capacity_ah=None)  # a document tells the rated one where none was given
    if name is not None and not name.strip().isprintable():
        raise VehicleConfigError("The battery's name must be one printable line.", 0, f"{ROOT}/battery")
    return replace(
        spec,
        name=known.name if name is None else name.strip(),
        end_of_life=known.end_of_life if end_of_life is None else end_of_life,
    )


def _spliced(xml: bytes, battery: BatterySpec | None) -> bytes:
    encoding, places = ConfigDocument(xml).encoding, find_places(xml, "battery", "file")
    line = "\r\n" if "\r\n".encode(encoding) in xml else "\n"
    text = "" if battery is None else f"{line}{INDENT}".join(_lines(battery))

    def with_piece(start: int, end: int, piece: str) -> bytes:
        return xml[:start] + piece.encode(encoding, "xmlcharrefreplace") + xml[end:]

    for start, end in reversed(places.wanted[1:] if text else places.wanted):
        before = xml[:start].decode(encoding)
        lead = before[len(before.rstrip()) :]
        xml = with_piece(start - len(lead.encode(encoding)), end, "")
    if not text:
        return xml
    if places.wanted:
        return with_piece(*places.wanted[0], text)
    if places.empty_root:
        opening = xml[slice(*places.empty_root)].decode(encoding).removesuffix("/>").rstrip()
        return with_piece(*places.empty_root, f"{opening}>{line}{INDENT}{text}{line}</{ROOT}>")
    at = places.before
    lead = xml[:at].decode(encoding).rpartition("\n")[2]
    if lead.strip():  # the place is in the middle of a line
        return with_piece(at, at, f"{line}{INDENT}{text}{line}")
    gap = INDENT[len(lead) :]
    return with_piece(at, at, f"{gap}{text}{line}{lead}")


def _lines(battery: BatterySpec) -> Iterator[str]:
    """Yield the element's lines, its children indented by one step."""
    elements: dict[str, list[str]] = {}
    shown = Vehicle(battery=battery)
    for field in (field for fields in GROUPS.values() for field in fields):
        value = value_of(shown, field.target)
        if value is None or value == "":
            continue
        text = value if isinstance(value, str) else format_number(value)
        elements.setdefault(field.element, []).append(f"{field.attribute}={quoteattr(text)}")
    yield f"<{' '.join(['battery', *elements.pop('battery', [])])}>"
    gains = elements.pop("battery/gpc/gains", [])
    if gains:
        elements.setdefault("battery/gpc", [])
    for element, attributes in elements.items():
        opening = " ".join([element.partition("/")[2], *attributes])
        if element == "battery/gpc" and gains:
            yield f"{INDENT}<{opening}><gains {' '.join(gains)}/></gpc>"
        else:
            yield f"{INDENT}<{opening}/>"
    yield "</battery>"
