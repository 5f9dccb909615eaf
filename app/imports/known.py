"""Loggers whose tables Ponthy knows: mappings that come with it and are recognised by their columns."""

from __future__ import annotations

from functools import cache
from importlib.resources import files

from app.imports.mapping import SignalMapping
from app.imports.table import Table


@cache
def known_mappings() -> tuple[SignalMapping, ...]:
    """Return the mappings that come with Ponthy, the most particular first."""
    folder = files("app.imports") / "mappings"
    found = [SignalMapping.from_json(entry.read_text()) for entry in folder.iterdir() if entry.name.endswith(".json")]
    return tuple(sorted(found, key=lambda mapping: (-len(mapping.recognise), mapping.name)))


def recognise(table: Table) -> SignalMapping | None:
    """Return the mapping of the logger that writes such columns (or such names in a long table), or None."""
    return next((mapping for mapping in known_mappings() if _fits(mapping, table)), None)


def _fits(mapping: SignalMapping, table: Table) -> bool:
    present = set(table.names)
    if mapping.name_column in table:
        present.update(table.texts(mapping.name_column)[1])
    return present.issuperset(mapping.recognise)
