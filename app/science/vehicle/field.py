"""One editable value of a car's XML: where it stands, how it is read, which limits it has."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

from app.science.vehicle.fuels import find_fuel
from app.science.vehicle.model import Vehicle
from app.science.vehicle.quantities import (
    SHARE,
    Quantity,
    format_number,
    parse_list,
    parse_rating,
    render_list,
    tyre_radius_m,
)

Kind = Literal["number", "text", "choice", "list"]
Form = Literal["plain", "whole", "rating", "tyre", "engine", "fuel"]
Value = float | str
LONGEST_TEXT = 500
LONGEST_LIST = 100_000


@dataclass(frozen=True, slots=True)
class Field:
    """One row of the table `app.science.vehicle.elements.FIELDS`.

    A number beyond `minimum` and `maximum` is refused; one outside `usual` is taken and warned about.

    Attributes
    ----------
    path : str
        Element path below the root, ``@``, attribute: ``drag/aero@Cd``.
    target : str
        Attribute of `Vehicle`, dotted for a nested one; a gear is ``gear_ratios.0``.
    kind : {"number", "text", "choice", "list"}
        What the form shows; a list is numbers with blanks between them.
    quantity : Quantity or None
        Unit and spellings of a number; for a rating, of its first number.
    si : float
        Factor from the quantity's unit to the unit of `Vehicle`.
    minimum, maximum : float or None
        Hard limits, inclusive, in the quantity's unit.
    usual : pair of float or None
        Range that needs no second look.
    form : str
        ``rating`` for ``60kW @5250rpm``, ``tyre`` for a tyre code, ``engine`` for the description that tells the number
        of cylinders, ``fuel`` for a fuel's name, ``whole`` for a whole number.
    follows : str
        Path of the value that stands in for this one when it is silent.
    """

    path: str
    label: str
    help: str
    target: str
    kind: Kind = "text"
    quantity: Quantity | None = None
    si: float = 1.0
    minimum: float | None = None
    maximum: float | None = None
    usual: tuple[float, float] | None = None
    choices: tuple[str, ...] = ()
    form: Form = "plain"
    follows: str = ""
    group: str = ""

    @property
    def element(self) -> str:
        """Element path below the root."""
        return self.path.partition("@")[0]

    @property
    def attribute(self) -> str:
        """Attribute name."""
        return self.path.partition("@")[2]

    @property
    def unit(self) -> str:
        """Unit of the number in the form; empty for text."""
        return self.quantity.unit if self.quantity and self.kind == "number" else ""

    @property
    def default(self) -> Value | None:
        """What Ponthy uses while the file is silent, in the form's unit; None where it uses nothing of its own."""
        if self.form == "tyre":
            return DEFAULT_TYRE
        value = None if self.follows else value_of(_SILENT, self.target)
        if isinstance(value, float):
            return value / self.si
        return value or None

    def read(self, text: str) -> Value:
        """Turn the text of the file, or of the form, into the value in the form's unit.

        Returns
        -------
        float or str
            A number within the limits, a known choice, or the text itself.

        Raises
        ------
        ValueError
            With what is wrong and what to do, worded to follow the value: “… isn't a number”.
        """
        text = text.strip()
        longest = LONGEST_LIST if self.kind == "list" else LONGEST_TEXT
        if len(text) > longest or not text.isprintable():
            raise ValueError(f"must be one printable line of at most {longest} characters")
        if self.kind == "number" and self.quantity:
            return self._within(self.quantity.parse(text))
        if self.form == "rating" and self.quantity:
            rating = parse_rating(text, self.quantity)
            self._within(rating.value)
            if rating.rpm is not None and not 100.0 <= rating.rpm <= 30_000.0:
                raise ValueError("has an engine speed that can't be")
        elif self.kind == "list":
            return render_list(self._within(number) for number in parse_list(text))
        elif self.form == "tyre":
            tyre_radius_m(text)
        elif self.form == "fuel":
            fuel = find_fuel(text)
            return fuel.name if fuel else text
        elif self.kind == "choice":
            text = text.lower()
            if text not in self.choices:
                raise ValueError(f"must be one of {', '.join(self.choices)}")
        return text

    def remark(self, value: Value) -> str:
        """Return what is odd about a valid value, worded to follow it; empty when nothing is."""
        if self.usual is None or isinstance(value, str) or self.usual[0] <= value <= self.usual[1]:
            return ""
        low, high = (format_number(limit) for limit in self.usual)
        return f"is unusual: most cars have {low} to {high} {self.unit}".rstrip()

    def _within(self, value: float) -> float:
        if self.minimum is not None and self.maximum is not None and not self.minimum <= value <= self.maximum:
            unit = self.quantity.unit if self.quantity else ""
            limits = f"must lie between {self.minimum:.6g} and {self.maximum:.6g} {unit}".rstrip()
            hint = "; write 90° if degrees are meant" if unit == "rad" else ""
            hint = "; write 0.7 for 70 %" if self.quantity is SHARE else hint
            raise ValueError(limits + hint)
        if self.form == "whole" and value != int(value):
            raise ValueError("must be a whole number")
        return value


DEFAULT_TYRE = "205/45 R16"
"""Stands for `Vehicle.wheel_radius_m` of a car whose XML is silent."""

_SILENT = Vehicle()


def value_of(vehicle: Vehicle, target: str) -> Value | None:
    """Return the value of a dotted attribute of a car in the unit of `Vehicle`; None for what it doesn't have."""
    name, _, rest = target.partition(".")
    value: object = getattr(vehicle, name)
    if isinstance(value, tuple):
        value = value[int(rest)] if int(rest) < len(value) else None
    elif rest and value is not None:
        value = getattr(value, rest)
    if isinstance(value, tuple):
        value = render_list(value) or None
    return value if value is None or isinstance(value, str) else float(value)  # type: ignore[arg-type]  # a number
