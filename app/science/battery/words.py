"""Numbers as the sentences about batteries hold them."""

from __future__ import annotations

from collections.abc import Sequence


def counted(number: int, what: str, many: str = "") -> str:
    """Return “1 row”, “2 rows”."""
    return f"{number} {what if number == 1 else many or what + 's'}"


def have(number: int, what: str, many: str = "") -> str:
    """Return “1 row has”, “2 rows have”."""
    return f"{counted(number, what, many)} {'has' if number == 1 else 'have'}"


def duration(seconds: float) -> str:
    """Return a length of time in the unit it is thought of in."""
    for unit, length in (("days", 86400.0), ("h", 3600.0), ("min", 60.0)):
        if seconds >= 2.0 * length:
            return f"{seconds / length:.3g} {unit}"
    return f"{seconds:.3g} s"


def listed(words: Sequence[str]) -> str:
    """Return “a”, “a and b”, “a, b and c”."""
    *before, last = words
    return f"{', '.join(before)} and {last}" if before else last
