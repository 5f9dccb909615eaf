"""A JSON object read field by field: what is wrong is refused by its path, with what is allowed."""

from __future__ import annotations

from collections.abc import Mapping
from difflib import get_close_matches
from math import isfinite
from typing import Any

from app.science.errors import ScienceError


class ProblemError(ScienceError):
    """A document, such as a drive problem, can't be used.

    Parameters
    ----------
    path : str
        Of the field, such as ``vehicle.mass_kg``.
    message : str
        What is wrong with it and what is allowed.
    """

    code = "problem-document"

    def __init__(self, path: str, message: str) -> None:
        super().__init__(f"{path}: {message}" if path else message)
        self.path = path


class Fields:
    """One JSON object; every field that is asked for counts as known, `close` refuses all others."""

    def __init__(self, value: object, path: str = "", what: str = "problem") -> None:
        if not isinstance(value, Mapping):
            raise ProblemError(path or what, f"{shown(value)} is not an object of named fields.")
        self._value = value
        self._path = path
        self._what = what
        self._known: list[str] = []

    def path(self, name: str) -> str:
        """Return the path of a field."""
        return f"{self._path}.{name}" if self._path else name

    def has(self, name: str) -> bool:
        """Tell whether the field is there and not null."""
        self._known.append(name)
        return self._value.get(name) is not None

    def get(self, name: str) -> Any:
        """Return a field that must be there."""
        self._known.append(name)
        if name not in self._value:
            raise ProblemError(self.path(name), "is missing.")
        return self._value[name]

    def inner(self, name: str) -> Fields:
        """Return an object inside."""
        return Fields(self.get(name), self.path(name), self._what)

    def number(self, name: str, low: float, high: float, default: float | None = None, *, above: bool = False) -> float:
        """Return a number from ``low`` (with ``above``: more than that) to ``high``."""
        if default is not None and not self.has(name):
            return default
        return checked(self.get(name), self.path(name), low, high, above=above)

    def numbers(self, name: str, low: float, high: float, count: int | None = None) -> tuple[float, ...]:
        """Return a list of numbers, of a given length where ``count`` says so."""
        path, values = self.path(name), self.get(name)
        if not isinstance(values, list | tuple):
            raise ProblemError(path, f"{shown(values)} is not a list of numbers.")
        if count is not None and len(values) != count:
            raise ProblemError(path, f"has {len(values)} numbers; {count} are needed.")
        return tuple(checked(value, f"{path}[{k}]", low, high) for k, value in enumerate(values))

    def pair(self, name: str, low: float, high: float) -> tuple[float, float]:
        """Return a lowest and a highest value."""
        first, second = self.numbers(name, low, high, 2)
        if not first < second:
            raise ProblemError(self.path(name), f"the lowest, {first:g}, is not below the highest, {second:g}.")
        return first, second

    def flag(self, name: str, default: bool) -> bool:
        """Return true or false."""
        if not self.has(name):
            return default
        value = self.get(name)
        if not isinstance(value, bool):
            raise ProblemError(self.path(name), f"{shown(value)} is neither true nor false.")
        return value

    def word(self, name: str, allowed: tuple[str, ...]) -> str:
        """Return one of some words."""
        value = self.get(name)
        if value not in allowed:
            near = nearest(value, allowed)
            raise ProblemError(self.path(name), f"{shown(value)} is none of {', '.join(allowed)}{near}")
        return str(value)

    def close(self) -> None:
        """Refuse fields nobody asked for, with the nearest known name."""
        for name in self._value:
            if name not in self._known:
                known = tuple(dict.fromkeys(self._known))
                near = (
                    nearest(name, known) if get_close_matches(str(name), known) else f"; known are {', '.join(known)}."
                )
                raise ProblemError(self.path(str(name)), f"is not a field of this {self._what}{near}")


def checked(value: object, path: str, low: float, high: float, *, above: bool = False) -> float:
    """Return a value that is a finite number inside its limits."""
    if isinstance(value, bool) or not isinstance(value, int | float):
        raise ProblemError(path, f"{shown(value)} is not a number.")
    number = float(value) if abs(value) < 1e300 else float("inf")
    if not isfinite(number):
        raise ProblemError(path, f"{shown(value)} is not a finite number.")
    if number < low or number > high or (above and number == low):
        span = f"above {low:g} up to {high:g}" if above else f"from {low:g} to {high:g}"
        raise ProblemError(path, f"{number:g} is out of range; allowed is {span}.")
    return number


def shown(value: object) -> str:
    """Return a value as a short piece of text."""
    text = "null" if value is None else repr(value)
    return text if len(text) <= 40 else f"{text[:37]}…"


def nearest(word: object, known: tuple[str, ...]) -> str:
    """Return the nearest of some words as the end of a sentence."""
    found = get_close_matches(str(word), known, n=1)
    return f"; did you mean {found[0]}?" if found else "."
