"""Single streams of a foreign table: times and values with the row each stands in."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Protocol

import numpy as np

from app.imports.mapping import ColumnMapping, SignalMapping
from app.imports.table import Table
from app.science.arrays import BoolArray, FloatArray, IntArray
from app.science.errors import SignalsError

TIME_NAMES = ("t_s", "time_s", "t", "time", "timestamp", "seconds", "datetime", "utc_s")


@dataclass(frozen=True, slots=True)
class Stream:
    """Values with their times, arrays of shape (n,); nothing in it is NaN."""

    t_s: FloatArray
    value: FloatArray
    row: IntArray

    def __len__(self) -> int:
        return len(self.t_s)

    def where(self, keep: BoolArray | IntArray) -> Stream:
        """Return the entries that are kept, or in another order."""
        return Stream(self.t_s[keep], self.value[keep], self.row[keep])


class Source(Protocol):
    """Where streams come from: a wide or a long table."""

    @property
    def names(self) -> tuple[str, ...]:
        """Foreign names that streams can be asked for."""
        ...

    def stream(self, name: str, time_column: str = "") -> Stream:
        """Return the stream of that name, without the entries that lack a time or a value."""
        ...


class WideTable:
    """A table with a column for each signal.

    Raises
    ------
    SignalsError
        When there is no column of times, or most of it can't be read.
    """

    def __init__(self, table: Table, mapping: SignalMapping) -> None:
        self._table, self._mapping = table, mapping
        self._time_column = find_time_column(table, mapping)
        own_times = {column.time_column for column in mapping.signals.values()}
        self._times: dict[str, FloatArray] = {}
        self._lack_reported: set[str] = set()
        self.names = tuple(name for name in table.names if name not in own_times | {self._time_column})

    def stream(self, name: str, time_column: str = "") -> Stream:
        """Return a column with the times of its own, or the table's."""
        column = time_column if time_column in self._table else self._time_column
        if column not in self._times:
            self._times[column] = _times(self._table, column, self._mapping)
        t_s, value = self._times[column], self._table.numbers(name)
        lost = np.isfinite(value) & ~np.isfinite(t_s)
        if lost.any() and column not in self._lack_reported:
            self._lack_reported.add(column)
            self._table.warnings.append(_without_time(lost, column, self._table.row))
        keep = np.isfinite(value) & np.isfinite(t_s)
        return Stream(t_s, value, self._table.row).where(keep)


class LongTable:
    """A table with a row for each value: time, name, value.

    Raises
    ------
    SignalsError
        As for `WideTable`.
    """

    def __init__(self, table: Table, mapping: SignalMapping) -> None:
        t_s = _times(table, find_time_column(table, mapping), mapping)
        value = table.numbers(mapping.value_column or "value")
        index, self.names = _named(table, mapping.name_column or "signal")
        lost = np.isfinite(value) & ~np.isfinite(t_s)
        if lost.any():
            table.warnings.append(_without_time(lost, "time", table.row))
        good = np.flatnonzero(np.isfinite(value) & np.isfinite(t_s) & (index >= 0))
        order = good[np.argsort(index[good], kind="stable")]
        self._all = Stream(t_s, value, table.row).where(order)
        self._first = np.searchsorted(index[order], np.arange(len(self.names) + 1))

    def stream(self, name: str, time_column: str = "") -> Stream:
        """Return all rows of a name; a long table has one column of times, whatever `time_column` says."""
        at = self.names.index(name)
        return self._all.where(np.arange(self._first[at], self._first[at + 1]))


def open_source(table: Table, mapping: SignalMapping) -> Source:
    """Return the table as a source of streams: long where it has a column of names and one of values, else wide."""
    name, value = mapping.name_column or "signal", mapping.value_column or "value"
    if name in table and value in table:
        return LongTable(table, mapping)
    if mapping.name_column:
        raise SignalsError(
            f"The mapping says that the table is long with the columns “{name}” and “{value}”; it has "
            f"{_listed(table.names)}.",
            field="mapping.layout",
        )
    return WideTable(table, mapping)


def mapped_stream(source: Source, name: str, column: ColumnMapping, mapping: SignalMapping) -> Stream | None:
    """Return a foreign stream as the mapping turns it into a signal; None when its factor is not to be had."""
    stream = source.stream(name, column.time_column)
    value = stream.value
    if column.mean_with:
        present = [other for other in column.mean_with if other in source.names]
        others = [_held(source.stream(other, column.time_column), stream.t_s) for other in present]
        value = np.mean([value, *others], axis=0)
    value = value * column.scale + column.offset
    if column.times in source.names:
        value = value * _held(source.stream(column.times, column.time_column), stream.t_s)
    elif column.times in mapping.constants:
        value = value * mapping.constants[column.times]
    elif column.times:
        return None
    keep = np.isfinite(value)
    if column.only_where and column.only_where.column in source.names:
        gate = _held(source.stream(column.only_where.column, column.time_column), stream.t_s)
        keep &= (gate >= column.only_where.minimum) & (gate <= column.only_where.maximum)
    return Stream(stream.t_s, value, stream.row).where(keep)


def find_time_column(table: Table, mapping: SignalMapping) -> str:
    """Return the name of the column of times; raises `SignalsError` when there is none."""
    wanted = [mapping.time_column] if mapping.time_column else list(TIME_NAMES)
    by_lower = {name.lower(): name for name in reversed(table.names)}
    for name in wanted:
        if name in table:
            return name
        if name.lower() in by_lower:
            return by_lower[name.lower()]
    raise SignalsError(
        f"There is no column of times: {' or '.join(f'“{name}”' for name in wanted[:2])} is expected among "
        f"{_listed(table.names)}. Name it t_s (seconds), or give a mapping.",
        1,
        wanted[0],
    )


def _times(table: Table, column: str, mapping: SignalMapping) -> FloatArray:
    t_s = table.times(column)
    if np.isfinite(t_s).sum() * 2 < len(t_s):
        missing = np.flatnonzero(~np.isfinite(t_s))
        row = table.first_bad_row(column) or int(table.row[missing[0]])
        if not np.isfinite(t_s).any() or table.first_bad_row(column):
            raise SignalsError(
                f"Row {row}: most times in the column “{column}” can't be read; seconds or ISO dates are expected.",
                row,
                column,
            )
    return t_s * mapping.time_scale + mapping.time_offset


def _held(stream: Stream, t_s: FloatArray) -> FloatArray:
    """Return a stream's last value at or before each time, its first one before that, NaN when it is empty."""
    if not len(stream):
        return np.full(len(t_s), np.nan)
    order = np.argsort(stream.t_s, kind="stable")
    at = np.searchsorted(stream.t_s[order], t_s, side="right") - 1
    held: FloatArray = stream.value[order][np.maximum(at, 0)]
    return held


def _named(table: Table, column: str) -> tuple[IntArray, tuple[str, ...]]:
    index, names = table.texts(column)
    return index, tuple(names)


def _without_time(lost: BoolArray, column: str, row: IntArray) -> str:
    first = int(row[np.flatnonzero(lost)[0]])
    rows = "1 row has no time" if lost.sum() == 1 else f"{int(lost.sum())} rows have no time"
    return f"{rows} in “{column}” and were left out (first: row {first})."


def _listed(names: tuple[str, ...]) -> str:
    shown = ", ".join(names[:12])
    return f"{shown} and {len(names) - 12} more" if len(names) > 12 else shown
