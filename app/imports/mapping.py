"""How the columns of a foreign table become Ponthy's signals: names, scales, products, and whose time is whose.

A mapping is a small JSON file::

    {"name": "My logger",
     "time": {"column": "Time", "scale": 0.001, "offset": 0},
     "layout": {"signal": "s", "value": "v"},
     "signals": {
       "speed_kmh": {"signal": "speed_mps", "scale": 0.2777777778, "time_column": "speed_kmh__t"},
       "act_torque_pct": {"signal": "engine_torque_nm", "scale": 0.01, "times": "ref_torque_nm"},
       "rl": {"signal": "speed_mps", "mean_with": ["rr"]},
       "lat": {"signal": "lat_deg", "only_where": {"column": "fix", "minimum": 2}}},
     "drop": ["comment"],
     "constants": {"ref_torque_nm": 250.0}}

Every part is optional. ``layout`` says that the table is long and names its columns. A signal is column · scale +
offset, times a second column or constant where ``times`` names one. Columns that bear the name of a signal need no
entry; ``drop`` leaves them out, and ``"*"`` in it keeps silent about all that isn't mapped.
"""

from __future__ import annotations

import json
from collections.abc import Mapping
from dataclasses import dataclass, field
from math import isfinite
from typing import Any

from app.science.errors import SignalsError
from app.science.logger.recording import SIGNAL_UNITS


@dataclass(frozen=True, slots=True)
class Condition:
    """Only rows whose `column` lies within the limits count."""

    column: str
    minimum: float = -float("inf")
    maximum: float = float("inf")


@dataclass(frozen=True, slots=True)
class ColumnMapping:
    """What becomes of one foreign column.

    Attributes
    ----------
    signal : str
        Name in `SIGNAL_UNITS`.
    scale, offset : float
        signal = column · scale + offset.
    time_column : str
        Its own column of times, where it has one.
    times : str
        A column or constant it is multiplied by, at its last value before.
    mean_with : tuple of str
        Columns of the same rows it is averaged with.
    only_where : Condition or None
        Rows that count.
    """

    signal: str
    scale: float = 1.0
    offset: float = 0.0
    time_column: str = ""
    times: str = ""
    mean_with: tuple[str, ...] = ()
    only_where: Condition | None = None


@dataclass(frozen=True, slots=True)
class SignalMapping:
    """How a table's columns become signals; the empty mapping takes the columns that bear a signal's name.

    Attributes
    ----------
    name : str
        What it is for.
    signals : mapping of str to ColumnMapping
        By foreign column (in a long table: by foreign signal name).
    time_column : str
        Column of times; empty looks for one of the usual names.
    time_scale, time_offset : float
        seconds = time · scale + offset, for every column of times.
    name_column, value_column : str
        The columns of a long table; empty for a wide one, or for ``signal`` and ``value``.
    drop : frozenset of str
        Columns to leave out without a word.
    constants : mapping of str to float
        Numbers that `ColumnMapping.times` may name.
    recognise : tuple of str
        Columns (or names in a long table) by which a file of this kind is known.
    """

    name: str = ""
    signals: Mapping[str, ColumnMapping] = field(default_factory=dict)
    time_column: str = ""
    time_scale: float = 1.0
    time_offset: float = 0.0
    name_column: str = ""
    value_column: str = ""
    drop: frozenset[str] = frozenset()
    constants: Mapping[str, float] = field(default_factory=dict)
    recognise: tuple[str, ...] = ()

    @classmethod
    def from_json(cls, text: str | bytes) -> SignalMapping:
        """Read a mapping file.

        Raises
        ------
        SignalsError
            When it isn't JSON, names a signal that doesn't exist, or holds what a mapping hasn't. `field` says where.
        """
        try:
            document = json.loads(text)
        except ValueError as error:
            raise SignalsError(f"The mapping isn't JSON: {error}.", field="mapping") from error
        return cls.from_dict(document)

    @classmethod
    def from_dict(cls, document: object) -> SignalMapping:
        """Read a mapping from a parsed JSON document; errors as for `from_json`."""
        root = _Part(document, "mapping")
        time, layout, signals = root.part("time"), root.part("layout"), root.part("signals")
        constants = root.part("constants")
        mapping = cls(
            name=root.text("name"),
            signals={column: _column(signals.part(column)) for column in signals.names()},
            time_column=time.text("column"),
            time_scale=time.number("scale", 1.0),
            time_offset=time.number("offset", 0.0),
            name_column=layout.text("signal"),
            value_column=layout.text("value"),
            drop=frozenset(root.texts("drop")),
            constants={name: constants.number(name, 0.0) for name in constants.names()},
            recognise=root.texts("recognise"),
        )
        for part in (time, layout, root):
            part.refuse_others()
        return mapping


def _column(part: _Part) -> ColumnMapping:
    signal = part.text("signal")
    if signal not in SIGNAL_UNITS:
        raise SignalsError(
            f"{part.path} names the signal “{signal}”, which doesn't exist; there are {', '.join(SIGNAL_UNITS)}.",
            field=part.path,
        )
    where = part.part("only_where")
    condition = None
    if where.names():
        condition = Condition(
            where.text("column"), where.number("minimum", -float("inf")), where.number("maximum", float("inf"))
        )
        where.refuse_others()
        if not condition.column:
            raise SignalsError(f"{where.path} must name a column.", field=where.path)
    mapping = ColumnMapping(
        signal,
        part.number("scale", 1.0),
        part.number("offset", 0.0),
        part.text("time_column"),
        part.text("times"),
        part.texts("mean_with"),
        condition,
    )
    part.refuse_others()
    return mapping


class _Part:
    """One object of the JSON document; remembers what was asked for, so that a misspelt key is noticed."""

    def __init__(self, content: object, path: str) -> None:
        if not isinstance(content, dict):
            raise SignalsError(f"{path} must be an object in braces, not {json.dumps(content)[:60]}.", field=path)
        self._content: dict[str, Any] = content
        self._asked: set[str] = set()
        self.path = path

    def names(self) -> list[str]:
        """Return the names in this object."""
        return list(self._content)

    def part(self, key: str) -> _Part:
        """Return an object inside; an empty one when it is absent."""
        self._asked.add(key)
        return _Part(self._content.get(key, {}), f"{self.path}.{key}")

    def text(self, key: str) -> str:
        """Return a text; empty when it is absent."""
        return str(self._typed(key, "", str, "a text"))

    def texts(self, key: str) -> tuple[str, ...]:
        """Return a list of texts."""
        found = self._typed(key, [], list, "a list of texts")
        if not all(isinstance(one, str) for one in found):
            raise SignalsError(f"{self.path}.{key} must be a list of texts.", field=f"{self.path}.{key}")
        return tuple(found)

    def number(self, key: str, default: float) -> float:
        """Return a finite number."""
        found = self._typed(key, default, (int, float), "a number")
        if isinstance(found, bool) or (key in self._content and not isfinite(found)):
            raise SignalsError(f"{self.path}.{key} must be a number.", field=f"{self.path}.{key}")
        return float(found)

    def refuse_others(self) -> None:
        """Raise for a key that nobody asked for: it is misspelt, or meant for something else."""
        others = self._content.keys() - self._asked
        if others:
            name = min(others)
            raise SignalsError(
                f"{self.path}.{name} isn't part of a mapping; there may be {', '.join(sorted(self._asked))}.",
                field=f"{self.path}.{name}",
            )

    def _typed(self, key: str, default: Any, kind: type | tuple[type, ...], words: str) -> Any:
        self._asked.add(key)
        found = self._content.get(key, default)
        if not isinstance(found, kind):
            raise SignalsError(f"{self.path}.{key} must be {words}.", field=f"{self.path}.{key}")
        return found
