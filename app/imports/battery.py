"""Tables of a battery's current and voltage (CSV, packed CSV, Parquet, one of them in a ZIP archive) as records."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np

from app.imports.battery_columns import find_columns
from app.imports.bundle import MAGIC, open_bundle
from app.imports.repair import find_clock
from app.imports.signals import read_signals
from app.imports.streams import Stream
from app.imports.table import LARGEST_BYTES, Table, read_table
from app.science.arrays import FloatArray
from app.science.battery.cleaning import Rows, clean
from app.science.battery.laboratory import held_from_logged, tells_the_past
from app.science.battery.record import BatteryRecord
from app.science.battery.streams import CURRENT, VOLTAGE, has_battery, record_of
from app.science.errors import SignalsError

__all__ = ["read_battery", "read_discharges"]

COUNTERS = ("cap_ah", "capacity_ah", "charge_ah", "amp-hours", "amp_hours", "ah")
"""Names, in small letters, under which cyclers write their count of charge."""


def read_battery(data: bytes | Path, name: str = "") -> BatteryRecord:
    """Read a battery's data.

    Parameters
    ----------
    data : bytes or Path
        CSV with comma, semicolon or tab (with a semicolon or tab, numbers may have decimal commas), the same packed
        with gzip, Parquet, or a ZIP archive with one of them. Columns ``t_s current_a voltage_v``, perhaps
        ``temperature_c``; near names are taken with a warning. A signals table will do, too.
    name : str
        Of the file, for messages.

    Returns
    -------
    BatteryRecord
        Clean; its warnings say what had to be done. Dates are counted from the first one.

    Raises
    ------
    SignalsError
        When nothing can be used: with row and column where that helps.
    """
    if isinstance(data, Path):
        return read_battery(data.read_bytes(), name or data.name)
    if data.startswith(MAGIC):
        name, data = _only_table(data)
    table = read_table(data)
    if table.metadata or {"signal", "value"} <= set(table.names):
        return _of_signals(data, name)
    columns = find_columns(table.names, table.warnings)
    numbers = {
        wanted: column.scale * table.numbers(column.name) for wanted, column in columns.items() if wanted != "t_s"
    }
    t_s, started = _seconds(table, columns["t_s"].name, columns["t_s"].scale)
    rows = Rows(t_s, numbers["current_a"], numbers["voltage_v"], numbers.get("temperature_c"), table.row)
    record = replace(clean(rows, tuple(table.warnings)), started_at_utc_s=started)
    return _as_held(record, table, rows)


def read_discharges(data: bytes, by: str) -> dict[str, BatteryRecord]:
    """Read one table of many discharges, such as a life's, as records by the values of a column, in their order.

    Raises
    ------
    SignalsError
        When there is no such column, or a discharge can't be used.
    """
    table = read_table(data)
    if by not in table.names:
        raise SignalsError(f"There is no column {by}; the table has {', '.join(table.names[:12])}.", field=by)
    columns = find_columns(tuple(name for name in table.names if name != by), table.warnings)
    numbers = {wanted: column.scale * table.numbers(column.name) for wanted, column in columns.items()}
    index, names = table.texts(by)
    found = {}
    for at in dict.fromkeys(index[index >= 0].tolist()):
        rows = index == at
        t_s, current_a, voltage_v = (numbers[name][rows] for name in ("t_s", "current_a", "voltage_v"))
        temperature_c = numbers["temperature_c"][rows] if "temperature_c" in numbers else None
        told = Rows(t_s, current_a, voltage_v, temperature_c, table.row[rows])
        found[names[at]] = clean(told, tuple(table.warnings))
    return found


def _as_held(record: BatteryRecord, table: Table, rows: Rows) -> BatteryRecord:
    """Turn a cycler's rows, which tell what has flowed, into rows that tell what flows, where its counter says so."""
    counter = next((name for name in table.names if name.strip().lower() in COUNTERS), None)
    if counter is None or not tells_the_past(rows.t_s, rows.current_a, table.numbers(counter)):
        return record
    said = (
        f"The file's own count of charge, “{counter}”, shows that each row tells the current that has flowed up to it; "
        "currents are taken to flow before their rows."
    )
    return held_from_logged(replace(record, warnings=(*record.warnings, said)))


def _only_table(data: bytes) -> tuple[str, bytes]:
    bundle = open_bundle(data, LARGEST_BYTES)
    if len(bundle.tables) > 1:
        names = ", ".join(name for name, _ in bundle.tables[:5])
        raise SignalsError(f"The ZIP archive holds {len(bundle.tables)} tables ({names}); give one record at a time.")
    return bundle.tables[0]


def _of_signals(data: bytes, name: str) -> BatteryRecord:
    recording = read_signals(data, filename=name)
    if not has_battery(recording):
        raise SignalsError(
            f"The signals table lacks {VOLTAGE if CURRENT in recording else CURRENT}; both {CURRENT} and {VOLTAGE} are "
            "needed to tell a battery's state.",
            1,
            VOLTAGE if CURRENT in recording else CURRENT,
        )
    record = record_of(recording)
    said = (*recording.warnings, *record.warnings)
    return replace(record, warnings=said, started_at_utc_s=recording.started_at_utc_s)


def _seconds(table: Table, column: str, scale: float) -> tuple[FloatArray, float | None]:
    """Return times in seconds; dates are counted from the first, whose UTC stands beside."""
    t_s = table.times(column)
    known = np.isfinite(t_s)
    if 2 * known.sum() < len(t_s):
        row = table.first_bad_row(column) or int(table.row[np.flatnonzero(~known)[0]])
        raise SignalsError(
            f"Row {row}: most times in the column “{column}” can't be read; seconds or ISO dates are expected.",
            row,
            column,
        )
    clock = find_clock({column: Stream(t_s[known], t_s[known], table.row[known])})
    if not clock.is_utc:
        return t_s * scale, None
    table.warnings.append(f"The times in “{column}” are dates; t_s counts seconds from the first one.")
    return t_s * clock.scale - clock.zero_s, clock.zero_s
