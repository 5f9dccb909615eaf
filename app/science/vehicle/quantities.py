"""Numbers as people write them: units inside the value, decimal commas, ``60kW @5250rpm``."""

from __future__ import annotations

import re
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from decimal import Decimal

_NUMBER = re.compile(r"([+-]?(?:\d+(?:[.,]\d*)?|[.,]\d+)(?:[eE][+-]?\d{1,3})?)\s*(.*)", re.DOTALL)
_SPELLING = str.maketrans({"²": "2", "³": "3", "·": "", "*": "", "^": "", "µ": "u", "μ": "u"})


def format_number(value: float) -> str:
    """Return the shortest text that reads back as the very same number, without a trailing ``.0``."""
    short = f"{value:.15g}"
    return short if float(short) == value else repr(value)


@dataclass(frozen=True, slots=True)
class Quantity:
    """A kind of number and the ways to write its unit.

    Attributes
    ----------
    unit : str
        Unit of the parsed number, and of a number written without one.
    factors : mapping of str to float
        What a number in that unit is multiplied by. Keys are in lower case without blanks, dots or carets.
    """

    unit: str
    factors: Mapping[str, float]

    def parse(self, text: str) -> float:
        """Read one number with an optional unit.

        Parameters
        ----------
        text : str
            For example ``698cc``, ``1,25``, ``-0.4 ms`` or ``9:1``.

        Returns
        -------
        float
            The number in `unit`.

        Raises
        ------
        ValueError
            When there is no number, or its unit is not one of `factors`.
        """
        number, unit = _split(text)
        key = _plain(unit)
        if key and key not in self.factors:
            raise ValueError(f"has the unit “{unit}”, which isn't one of {self._spellings()}")
        return float(number * _decimal(self.factors[key])) if key else float(number)

    def render(self, value: float, like: str = "") -> str:
        """Write a number in the unit that the text `like` used, so that an edited file keeps its manner.

        The bare number in `unit` is written instead when the other spelling would not read back exactly.
        """
        try:
            _, unit = _split(like)
        except ValueError:
            unit = ""
        key = _plain(unit)
        if key in self.factors:
            gap = " " if like.rstrip().removesuffix(unit).endswith(" ") else ""
            text = f"{format_number(float(_decimal(value) / _decimal(self.factors[key])))}{gap}{unit}"
            if self.parse(text) == value:
                return text
        return format_number(value)

    def _spellings(self) -> str:
        return ", ".join(self.factors) if self.factors else "none (a bare number is expected)"


def _decimal(value: float) -> Decimal:
    """Return the number as written: 698 times 0.001 is 0.698 then, and not 0.6980000000000001."""
    return Decimal(repr(value))


def _split(text: str) -> tuple[Decimal, str]:
    match = _NUMBER.fullmatch(text.strip())
    if match is None or match[2][:1] in {",", "."} or match[2][:1].isdigit():
        raise ValueError("isn't a number")
    return Decimal(match[1].replace(",", ".")), match[2].strip()


def _plain(unit: str) -> str:
    return "".join(unit.translate(_SPELLING).lower().split())


RATIO = Quantity("", {":1": 1.0})
COUNT = Quantity("", {})
SPEED = Quantity("rpm", {"rpm": 1.0, "1/min": 1.0, "/min": 1.0, "min-1": 1.0, "tr/min": 1.0, "u/min": 1.0})
VOLUME = Quantity(
    "l", {"l": 1.0, "litre": 1.0, "litres": 1.0, "liter": 1.0, "dm3": 1.0, "cc": 1e-3, "ccm": 1e-3, "cm3": 1e-3}
)
POWER = Quantity("kW", {"kw": 1.0, "w": 1e-3, "ps": 0.73549875, "ch": 0.73549875, "hp": 0.7456998715822702})
TORQUE = Quantity("Nm", {"nm": 1.0, "lb-ft": 1.3558179483314004, "lbft": 1.3558179483314004, "mkg": 9.80665})
MASS = Quantity("kg", {"kg": 1.0, "t": 1000.0, "lb": 0.45359237, "lbs": 0.45359237})
LENGTH = Quantity("m", {"m": 1.0, "cm": 1e-2, "mm": 1e-3, "in": 0.0254})
AREA = Quantity("m²", {"m2": 1.0, "sqm": 1.0, "qm": 1.0})
ANGLE = Quantity("rad", {"rad": 1.0, "deg": 0.017453292519943295, "°": 0.017453292519943295})
INERTIA = Quantity("kg·m²", {"kgm2": 1.0})
TIME = Quantity("s", {"s": 1.0, "ms": 1e-3, "us": 1e-6})
FLOW = Quantity("l/s", {"l/s": 1.0, "ml/s": 1e-3, "cc/s": 1e-3, "l/min": 1.0 / 60.0, "cc/min": 1e-3 / 60.0})
ENERGY_DENSITY = Quantity("MJ/l", {"mj/l": 1.0, "kwh/l": 3.6})
DENSITY = Quantity("kg/l", {"kg/l": 1.0, "g/cm3": 1.0, "kg/m3": 1e-3})
CHARGE = Quantity("Ah", {"ah": 1.0, "mah": 1e-3, "as": 1.0 / 3600.0})
RESISTANCE = Quantity("Ω", {"ohm": 1.0, "ω": 1.0, "mohm": 1e-3, "mω": 1e-3})
CAPACITANCE = Quantity("F", {"f": 1.0, "kf": 1000.0})
VOLTAGE = Quantity("V", {"v": 1.0, "mv": 1e-3})
CURRENT = Quantity("A", {"a": 1.0, "ma": 1e-3})
SHARE = Quantity("", {"%": 1e-2})
TEMPERATURE = Quantity("°C", {"°c": 1.0, "c": 1.0})
KELVIN = Quantity("K", {"k": 1.0})
RATE = Quantity("1/s", {"1/s": 1.0, "/s": 1.0})
DISTANCE_PER_TICK = Quantity("m", {"m": 1.0, "m/tick": 1.0, "cm": 1e-2, "mm": 1e-3})


def parse_list(text: str) -> tuple[float, ...]:
    """Read numbers with blanks, semicolons or commas and blanks between them; ``1,5`` is one and a half.

    Raises
    ------
    ValueError
        Naming the first that isn't a number.
    """
    numbers = []
    for word in text.replace(";", " ").replace(", ", " ").split():
        number, unit = _split(word) if _NUMBER.fullmatch(word) else (Decimal(0), word)
        if unit:
            raise ValueError(f"holds “{word[:40]}”, which isn't a number; put blanks between numbers")
        numbers.append(float(number))
    return tuple(numbers)


def render_list(numbers: Iterable[float]) -> str:
    """Return numbers as a text that `parse_list` reads back exactly."""
    return " ".join(format_number(number) for number in numbers)


@dataclass(frozen=True, slots=True)
class Rating:
    """A maximum and the engine speed where it is reached; the speed is None where the text is silent."""

    value: float
    rpm: float | None


def parse_rating(text: str, quantity: Quantity) -> Rating:
    """Read ``60kW @5250rpm`` or ``110 Nm``.

    Raises
    ------
    ValueError
        When a part isn't a number or has a foreign unit.
    """
    value, mark, speed = text.partition("@")
    return Rating(quantity.parse(value), SPEED.parse(speed) if mark else None)


_TYRE = re.compile(r"\s*P?(\d{3})\s*/\s*(\d{2})\s*-?\s*Z?R?\s*(\d{2})(?:C)?(?:\s.*)?", re.IGNORECASE | re.DOTALL)


def tyre_radius_m(code: str) -> float:
    """Return the radius that a tyre code stands for, m.

    The code gives nominal sizes, so the radius is rounded to a tenth of a millimetre: ``205/45 R16`` is 0.2954 m.

    Raises
    ------
    ValueError
        When the text isn't a metric tyre code of a road vehicle.
    """
    match = _TYRE.fullmatch(code)
    if match is None:
        raise ValueError("isn't a tyre code; write it as 205/45 R16")
    width_mm, aspect_percent, rim_in = (int(part) for part in match.groups())
    if not (100 <= width_mm <= 500 and 20 <= aspect_percent <= 95 and 8 <= rim_in <= 30):
        raise ValueError("isn't the code of a road tyre; write it as 205/45 R16")
    return round(width_mm * aspect_percent / 100.0 + rim_in * 25.4 / 2.0, 1) / 1000.0


_CYLINDERS = (
    re.compile(r"\b(\d{1,2})[\s-]*cyl", re.IGNORECASE),
    re.compile(r"\b(?:in-?line|straight|flat|boxer|row)[\s-]*(\d{1,2})\b", re.IGNORECASE),
    re.compile(r"\b[ILRVWHB]-?(\d{1,2})\b", re.IGNORECASE),
)


def cylinder_count(engine_type: str) -> int | None:
    """Find the number of cylinders in an engine's description: ``Inline 3``, ``V6``, ``4 cyl``, ``i4``.

    Returns
    -------
    int or None
        None where the text doesn't tell.
    """
    for pattern in _CYLINDERS:
        match = pattern.search(engine_type)
        if match and int(match[1]) in {1, 2, 3, 4, 5, 6, 8, 10, 12, 16}:
            return int(match[1])
    return None
