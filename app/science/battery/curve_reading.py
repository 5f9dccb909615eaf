"""The open-circuit curve of a configuration, looked at before anything is built upon it."""

from __future__ import annotations

from itertools import pairwise
from typing import Any

import numpy as np

from app.science.battery.curve import SAMPLES, OpenCircuit, voltage_at
from app.science.fields import Fields, ProblemError, checked, shown

MOST_VOLTS = 5000.0
MOST_POINTS, MOST_COEFFICIENTS = 20_000, 30
PERCENT_FROM = 1.5
"""States of charge above this are in percent; a cell is overcharged by less."""
LOWEST_SOC, HIGHEST_SOC = -0.5, PERCENT_FROM
TOLERATED_FALL_V = 0.005
"""Measured curves fall by this much in places; a fall between two rows that is deeper is an error of the table."""


def read_curve(top: Fields) -> OpenCircuit:
    """Read ``ocv`` and ``ocv_soc_range`` of a configuration.

    Raises
    ------
    ProblemError
        Naming the coefficient or the row.
    """
    path, value = top.path("ocv"), top.get("ocv")
    if not isinstance(value, list | tuple) or len(value) < 2:
        raise ProblemError(
            path,
            f"{shown(value)} is no curve; a list of ascending coefficients or of [soc, volt] rows is needed, with two "
            "entries at least.",
        )
    tabled = [isinstance(entry, list | tuple) for entry in value]
    if all(tabled):
        return _table(value, path, top)
    if any(tabled):
        row = tabled.index(not tabled[0])
        raise ProblemError(
            f"{path}[{row}]", f"{shown(value[row])} is not like the entries before it; mix no rows and coefficients."
        )
    return _polynomial(value, path, top)


def _table(rows: Any, path: str, top: Fields) -> OpenCircuit:
    if top.has("ocv_soc_range"):
        raise ProblemError(
            top.path("ocv_soc_range"), "belongs to polynomials; the rows of a table say where it is known."
        )
    if len(rows) > MOST_POINTS:
        raise ProblemError(path, f"has {len(rows)} rows; allowed are {MOST_POINTS}.")
    points = [_row(row, f"{path}[{k}]") for k, row in enumerate(rows)]
    most = max(soc for soc, _ in points)
    if most > PERCENT_FROM:
        raise ProblemError(path, f"its state of charge goes up to {most:g}: that is percent; divide it by 100.")
    if all(after[0] < before[0] for before, after in pairwise(points)):
        raise ProblemError(path, "its rows descend in state of charge; turn the list round.")
    for k, (before, after) in enumerate(pairwise(points), start=1):
        if after[0] <= before[0]:
            raise ProblemError(
                f"{path}[{k}]",
                f"its state of charge, {after[0]:g}, is not above the row before, {before[0]:g}; rows ascend.",
            )
        if after[1] < before[1] - TOLERATED_FALL_V:
            raise ProblemError(
                f"{path}[{k}]",
                f"its {after[1]:g} V are below the {before[1]:g} V of the row before; a curve must not fall (rows are "
                "[soc, volt], soc first).",
            )
    return _rising(OpenCircuit(points=tuple(points)), path)


def _row(row: Any, path: str) -> tuple[float, float]:
    if len(row) != 2:
        raise ProblemError(path, f"has {len(row)} numbers; a row is [soc, volt].")
    soc = checked(row[0], f"{path}[0]", LOWEST_SOC, 100.0 * PERCENT_FROM)
    return soc, checked(row[1], f"{path}[1]", 0.0, MOST_VOLTS)


def _polynomial(values: Any, path: str, top: Fields) -> OpenCircuit:
    if len(values) > MOST_COEFFICIENTS:
        raise ProblemError(path, f"has {len(values)} coefficients; allowed are {MOST_COEFFICIENTS}.")
    coefficients = tuple(checked(value, f"{path}[{k}]", -1e9, 1e9) for k, value in enumerate(values))
    known = top.pair("ocv_soc_range", LOWEST_SOC, HIGHEST_SOC) if top.has("ocv_soc_range") else (0.0, 1.0)
    curve = OpenCircuit(coefficients=coefficients, soc_range=known)
    # at its ends a polynomial may leave what it was fitted to; in its middle it must be a battery's
    middle = voltage_at(curve.pieces, np.linspace(*_middle(known), SAMPLES))
    if middle.min() <= 0.0 or middle.max() > MOST_VOLTS:
        odd = float(middle.min() if middle.min() <= 0.0 else middle.max())
        raise ProblemError(
            path, f"the polynomial goes to {odd:.4g} V inside its range; coefficients ascend, the constant comes first."
        )
    return _rising(curve, path)


def _middle(known: tuple[float, float]) -> tuple[float, float]:
    margin = 0.2 * (known[1] - known[0])
    return known[0] + margin, known[1] - margin


def _rising(curve: OpenCircuit, path: str) -> OpenCircuit:
    low, high = voltage_at(curve.pieces, np.array(_middle(curve.soc_range)))
    if high <= low:
        raise ProblemError(
            path,
            f"the voltage does not rise with the state of charge ({low:.4g} V, then {high:.4g} V): nothing could be "
            "told from it.",
        )
    return curve
