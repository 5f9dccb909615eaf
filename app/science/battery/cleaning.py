"""Rows as they come from anywhere, made into a record that can be worked with; every repair is said."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from app.science.arrays import BoolArray, FloatArray, IntArray
from app.science.battery.record import BatteryRecord
from app.science.battery.words import counted, have
from app.science.errors import SignalsError

MOST_AMPERES, MOST_VOLTS = 2e4, 5e3
"""Beyond these a number is a sensor's way of saying “not available”."""
LATEST_S = 1e11
COLDEST_C, HOTTEST_C = -60.0, 150.0
KELVIN = 273.15
LEAST_ROWS = 2
TEST_ROWS = 10
"""So many rows in order are a test of their own when they share their time with others."""


@dataclass(frozen=True, slots=True)
class Rows:
    """Columns as they were read: arrays of shape (n,), NaN where a cell is empty.

    Attributes
    ----------
    t_s, current_a, voltage_v : ndarray
    temperature_c : ndarray or None
    row : ndarray of int
        Where each entry stands in its file, for messages.
    """

    t_s: FloatArray
    current_a: FloatArray
    voltage_v: FloatArray
    temperature_c: FloatArray | None
    row: IntArray

    def where(self, keep: BoolArray | IntArray) -> Rows:
        """Return the rows that are kept, or in another order."""
        temperature = None if self.temperature_c is None else self.temperature_c[keep]
        return Rows(self.t_s[keep], self.current_a[keep], self.voltage_v[keep], temperature, self.row[keep])


@dataclass(slots=True)
class _Said:
    warnings: list[str] = field(default_factory=list)

    def rows(self, wrong: BoolArray, row: IntArray, words: str) -> None:
        """Say in how many rows something is, and where first."""
        places = np.flatnonzero(wrong)
        if len(places):
            self.warnings.append(f"{have(len(places), 'row')} {words} (first: row {int(row[places[0]])}).")


def clean(rows: Rows, warnings: tuple[str, ...] = ()) -> BatteryRecord:
    """Return a record: in order, finite, without double times.

    Rows without a time or a current are left out: the current before flows on. A voltage that can't be is left out
    alone. A temperature that is missing is read from its neighbours.

    Parameters
    ----------
    rows : Rows
    warnings : tuple of str
        What was said before; it stays in front.

    Raises
    ------
    SignalsError
        When less than two rows are left, there is no voltage at all, or the times begin anew.
    """
    said = _Said(list(warnings))
    rows = _usable(rows, said)
    _refuse_several_tests(rows)
    rows = _in_order(rows, said)
    voltage = _voltage(rows, said)
    return BatteryRecord(rows.t_s, rows.current_a, voltage, _temperature(rows, said), tuple(said.warnings))


def _usable(rows: Rows, said: _Said) -> Rows:
    timed = np.abs(rows.t_s) <= LATEST_S  # false for NaN, too
    said.rows(~timed, rows.row, "no usable time; what is in them is left out")
    rows = rows.where(timed)
    known = np.abs(rows.current_a) <= MOST_AMPERES  # false for NaN, too
    said.rows(~known, rows.row, "no usable current; the current before is taken to flow on")
    rows = rows.where(known)
    if len(rows.t_s) < LEAST_ROWS:
        raise SignalsError(
            f"{counted(len(rows.t_s), 'row')} with a time and a current {'is' if len(rows.t_s) == 1 else 'are'} left; "
            "a record needs two at least, and an hour of changing current to tell anything.",
            field="current_a",
        )
    return rows


def _refuse_several_tests(rows: Rows) -> None:
    """Refuse tests that follow each other in one file, each with times from zero: sorted, they would be mixed up."""
    back = np.flatnonzero(np.diff(rows.t_s) < 0.0) + 1
    begins, ends = np.concatenate([[0], back]), np.concatenate([back, [len(rows.t_s)]])
    whole = ends - begins >= TEST_ROWS
    begins, ends = begins[whole], ends[whole]
    for (begin, end), (begin_after, end_after) in zip(
        zip(begins, ends, strict=True), zip(begins[1:], ends[1:], strict=True), strict=False
    ):
        first, last = rows.t_s[[begin, end - 1]], rows.t_s[[begin_after, end_after - 1]]
        shared = min(first[1], last[1]) - max(first[0], last[0])
        if shared > 0.5 * min(first[1] - first[0], last[1] - last[0]):
            row = int(rows.row[begin_after])
            raise SignalsError(
                f"Row {row}: the times begin anew ({rows.t_s[begin_after - 1]:g} s, then {rows.t_s[begin_after]:g} s), "
                "as when several tests stand in one file. Give one test a file, or times that go on.",
                row,
                "t_s",
            )


def _in_order(rows: Rows, said: _Said) -> Rows:
    back = np.flatnonzero(np.diff(rows.t_s) < 0.0)
    if len(back):
        times = "once" if len(back) == 1 else f"{len(back)} times"
        said.warnings.append(f"Time went backwards {times} and was sorted (first: row {int(rows.row[back[0] + 1])}).")
        rows = rows.where(np.argsort(rows.t_s, kind="stable"))
    fresh = np.concatenate([[True], np.diff(rows.t_s) > 0.0])
    said.rows(~fresh, rows.row, "the time of an earlier one; of these the first counts")
    rows = rows.where(fresh)
    if len(rows.t_s) < LEAST_ROWS:
        raise SignalsError("All rows have the same time; seconds that rise are needed.", field="t_s")
    return rows


def _voltage(rows: Rows, said: _Said) -> FloatArray:
    empty = np.isnan(rows.voltage_v)
    wrong = ~empty & ~((rows.voltage_v > 0.0) & (rows.voltage_v <= MOST_VOLTS))
    if np.all(empty | wrong):
        raise SignalsError(
            "No row holds a voltage above zero. Current alone only counts charge: neither how full a battery is nor "
            "what is left of it can be told. Log voltage_v beside current_a.",
            field="voltage_v",
        )
    said.rows(empty, rows.row, "no voltage; charge is counted there, and nothing is learnt")
    said.rows(wrong, rows.row, f"a voltage that can't be (not above 0, or over {MOST_VOLTS:g} V); it counts as missing")
    return np.where(wrong, np.nan, rows.voltage_v)


def _temperature(rows: Rows, said: _Said) -> FloatArray | None:
    given = rows.temperature_c
    if given is None or np.isnan(given).all():
        return None
    if COLDEST_C + KELVIN <= np.nanmedian(given) <= HOTTEST_C + KELVIN:
        said.warnings.append(
            f"temperature_c is {np.nanmedian(given):.4g} in the middle: that is kelvin, and was taken as kelvin."
        )
        given = given - KELVIN
    known = (given >= COLDEST_C) & (given <= HOTTEST_C)
    said.rows(~known, rows.row, "no usable temperature; it is read from its neighbours")
    if not known.any():
        said.warnings.append("No temperature can be used; the cell is taken to be at its reference temperature.")
        return None
    return np.interp(rows.t_s, rows.t_s[known], given[known])
