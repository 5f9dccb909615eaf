"""A battery's history, and laboratory tests, as tables (CSV, packed CSV, Parquet)."""

from __future__ import annotations

import numpy as np

from app.imports.table import Table, read_table
from app.science.arrays import BoolArray, FloatArray
from app.science.battery.health import HealthPoint, LabTest
from app.science.errors import SignalsError

__all__ = ["read_history", "read_tests"]

DAYS, DATES = "at_days", ("ended_at", "at", "date", "start_time")
UNSAID_SD = 0.01
"""Share of a capacity by which it is taken to be uncertain where its table doesn't say."""
DAY_S = 86400.0


def read_history(data: bytes) -> tuple[HealthPoint, ...]:
    """Read estimates or measured capacities, one a row.

    Parameters
    ----------
    data : bytes
        Columns ``at_days``, or dates in ``ended_at``, ``at``, ``date`` or ``start_time``; ``capacity_ah``; perhaps
        ``capacity_ah_sd resistance_ohm resistance_ohm_sd charge_ah follows_id``. An exported history is one.

    Returns
    -------
    tuple of HealthPoint
        Rows without time or capacity are left out. Only where ``follows_id`` names one does a row take over from the
        one before it.

    Raises
    ------
    SignalsError
        When times or capacities are missing altogether, or a standard deviation is none.
    """
    table = read_table(data)
    at, capacity, sd = _capacities(table)
    resistance = _column(table, "resistance_ohm")
    resistance_sd = _positive(table, "resistance_ohm_sd", UNSAID_SD * resistance)
    charge, carried = _column(table, "charge_ah"), _carried(table)
    return tuple(
        HealthPoint(
            at=float(at[k]),
            capacity_ah=float(capacity[k]),
            capacity_sd=float(sd[k]),
            resistance_ohm=float(resistance[k]),
            resistance_sd=float(resistance_sd[k]),
            charge_ah=float(charge[k]),
            carried=bool(carried[k]),
        )
        for k in np.flatnonzero(np.isfinite(at) & np.isfinite(capacity))
    )


def read_tests(data: bytes) -> tuple[LabTest, ...]:
    """Read laboratory tests: times as in a history, ``capacity_ah`` and perhaps ``capacity_ah_sd``; raises alike."""
    at, capacity, sd = _capacities(read_table(data))
    known = np.isfinite(at) & np.isfinite(capacity)
    return tuple(
        LabTest(*(float(one) for one in row)) for row in zip(at[known], capacity[known], sd[known], strict=True)
    )


def _capacities(table: Table) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Return days, capacities and their standard deviations; rows without a capacity stay as NaN."""
    at = _days(table)
    if "capacity_ah" not in table:
        raise SignalsError(
            f"The table lacks the column capacity_ah; it has {', '.join(table.names[:12])}.", 1, "capacity_ah"
        )
    capacity = table.numbers("capacity_ah")
    wrong = np.flatnonzero(capacity <= 0.0)
    if len(wrong):
        row = int(table.row[wrong[0]])
        raise SignalsError(f"Row {row}: a capacity of {capacity[wrong[0]]:g} Ah can't be.", row, "capacity_ah")
    if not np.any(np.isfinite(at) & np.isfinite(capacity)):
        raise SignalsError("No row has both a time and a capacity that can be read.", 0, "capacity_ah")
    return at, capacity, _positive(table, "capacity_ah_sd", UNSAID_SD * capacity)


def _days(table: Table) -> FloatArray:
    if DAYS in table:
        return table.numbers(DAYS)
    name = next((name for name in DATES if name in table), None)
    if name is None:
        raise SignalsError(
            f"The table lacks a time: {DAYS} in days, or dates in one of {', '.join(DATES)}; it has "
            f"{', '.join(table.names[:12])}.",
            1,
            DAYS,
        )
    return np.asarray(table.times(name) / DAY_S)


def _column(table: Table, name: str) -> FloatArray:
    return table.numbers(name) if name in table else np.full(len(table.row), np.nan)


def _positive(table: Table, name: str, otherwise: FloatArray) -> FloatArray:
    """Return standard deviations, and what stands in where the table says none."""
    sd = _column(table, name)
    wrong = np.flatnonzero(sd <= 0.0)
    if len(wrong):
        row = int(table.row[wrong[0]])
        raise SignalsError(f"Row {row}: {name} is {sd[wrong[0]]:g}; a standard deviation is above 0.", row, name)
    return np.where(np.isfinite(sd), sd, otherwise)


def _carried(table: Table) -> BoolArray:
    """Tell which rows began with what the one before knew."""
    if "follows_id" not in table:
        return np.zeros(len(table.row), dtype=np.bool_)
    index, words = table.texts("follows_id")
    named = np.array([*(bool(word) for word in words), False])  # an index of −1 says that there is none
    return named[index]
