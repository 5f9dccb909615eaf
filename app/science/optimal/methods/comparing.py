"""All methods on one problem in one table: energy, time, error, milliseconds, and what each says."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from math import isfinite, nan
from time import perf_counter
from typing import Any

from app.science.errors import ScienceError
from app.science.optimal.methods.registry import METHODS, method
from app.science.optimal.methods.running import Method, Options, Result
from app.science.optimal.problem import Problem
from app.science.progress import Progress, between, silent

AGAIN_BELOW_S = 3.0
ROUNDING = 1e-9
CERTIFIED = ("optimal", "extremal")


@dataclass(frozen=True, slots=True)
class MethodRow:
    """What one method says.

    Attributes
    ----------
    name, title, source : str
    fuel_energy_j, cost_j, shift_charges_j, time_s : float
        NaN where the method gives none. The cost is the fuel, or where fuel and emissions are weighted their sum.
    relative_error : float
        Cost and charges above the best certified ones, of those; NaN where there is nothing to compare.
    milliseconds : float
        Of finding the drive, without its certificate.
    first_call : bool
        Whether that was the method's first run here, which may hold compiling; methods that take long run once.
    verdict : str
        Empty where there is no drive.
    reason : str
        Why the method does not apply, or what it met; empty where it has a drive.
    """

    name: str
    title: str
    source: str
    fuel_energy_j: float = nan
    cost_j: float = nan
    shift_charges_j: float = 0.0
    time_s: float = nan
    relative_error: float = nan
    milliseconds: float = nan
    first_call: bool = False
    verdict: str = ""
    reason: str = ""

    def document(self) -> dict[str, Any]:
        """Return the row with the names others rely on; what isn't known is null."""
        return {name: _known(getattr(self, name)) for name in self.__slots__}


@dataclass(frozen=True, slots=True)
class Comparison:
    """Methods side by side.

    Attributes
    ----------
    rows : tuple of MethodRow
    best : str
        Name of the method whose certified drive takes the least, the first of those that agree to 1e-9; where none is
        certified, of the least that isn't rejected; empty where there is none.
    """

    rows: tuple[MethodRow, ...]
    best: str

    def document(self) -> dict[str, Any]:
        """Return the comparison with the names others rely on."""
        return {"best": self.best or None, "rows": [row.document() for row in self.rows]}


def compare(problem: Problem, names: Sequence[str] | None = None, progress: Progress = silent) -> Comparison:
    """Solve a problem by several methods.

    Parameters
    ----------
    problem : Problem
    names : sequence of str or None
        None for all.
    progress : callable
        What it raises ends the work.

    Raises
    ------
    MethodFailed
        For a name that no method has.
    """
    chosen = [method(name) for name in (METHODS if names is None else names)]
    rows = []
    for k, one in enumerate(chosen):
        rows.append(_row(one, problem, between(progress, k / len(chosen), (k + 1) / len(chosen))))
        progress((k + 1) / len(chosen))
    return _compared(rows)


def _row(one: Method, problem: Problem, progress: Progress) -> MethodRow:
    reason = one.reason(problem)
    if reason is not None:
        return MethodRow(one.name, one.title, one.source, reason=reason)
    try:
        result, seconds = _timed(one, problem, between(progress, 0.0, 0.5))
        first = seconds >= AGAIN_BELOW_S
        if not first:
            result, seconds = _timed(one, problem, between(progress, 0.5, 1.0))
        answer = result.judged()
    except ScienceError as error:  # a method that finds nothing is a row of the table, with its reason
        return MethodRow(one.name, one.title, one.source, reason=str(error))
    document = answer.document()
    certificate = document.get("certificate") or {}
    return MethodRow(
        one.name,
        one.title,
        one.source,
        fuel_energy_j=float(document.get("fuel_energy_j", nan)),
        cost_j=result.cost_j,
        shift_charges_j=float(certificate.get("shift_charges_j", 0.0)),
        time_s=result.time_s,
        milliseconds=1e3 * seconds,
        first_call=first,
        verdict=str(certificate.get("verdict", "")),
    )


def _timed(one: Method, problem: Problem, progress: Progress) -> tuple[Result, float]:
    begin = perf_counter()
    result = one.run(problem, Options(), progress)
    return result, perf_counter() - begin


def _compared(rows: list[MethodRow]) -> Comparison:
    def taken(row: MethodRow) -> float:
        return row.cost_j + row.shift_charges_j

    known = [row for row in rows if isfinite(taken(row))]
    certified = [row for row in known if row.verdict in CERTIFIED]
    candidates = certified or [row for row in known if row.verdict != "rejected"]
    if not candidates:
        return Comparison(tuple(rows), "")
    least = min(taken(row) for row in candidates)
    best = next(row for row in candidates if taken(row) <= least * (1.0 + ROUNDING))
    off = [(taken(row) - taken(best)) / taken(best) for row in rows]
    return Comparison(tuple(replace(row, relative_error=e) for row, e in zip(rows, off, strict=True)), best.name)


def _known(value: Any) -> Any:
    return None if isinstance(value, float) and not isfinite(value) else value
