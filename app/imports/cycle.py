"""A driving cycle as a table: time, speed, and what a fuel meter said, if there was one."""

from __future__ import annotations

import csv
import io

import numpy as np

from app.imports.csvtext import open_csv
from app.science.arrays import FloatArray
from app.science.engine.wheel_power import DrivingCycle
from app.science.errors import SignalsError
from app.science.vehicle.fuels import Fuel

TIME_NAMES = ("t_s", "time_s", "time", "cycsecs")
SPEED_NAMES = {"speed_mps": 1.0, "speed_ms": 1.0, "cycmps": 1.0, "speed_kmh": 1 / 3.6, "speed_mph": 0.44704}
MASS_FLOW_NAMES = ("fuel_g_s", "fuel_gps")
VOLUME_FLOW_NAMES = {"fuel_cc_s": 1e-3, "fuel_ml_s": 1e-3, "fuel_rate_lph": 1 / 3600.0}
"""Columns in litres per second, with their factor."""
LONGEST_GAP_S = 5.0
FASTEST_MPS = 100.0


def read_cycle(data: bytes, name: str, fuel: Fuel) -> DrivingCycle:
    """Read a table of `t_s`, `speed_mps` (or `speed_ms`, `speed_kmh`, `speed_mph`) and perhaps a fuel flow.

    The flow may be `fuel_g_s`, `fuel_cc_s` or `fuel_rate_lph`; of several, grams are taken, which need no density.
    The cycle is brought to one row a second.

    Raises
    ------
    SignalsError
        With row and column of what can't be.
    """
    text = open_csv(data)
    names = [column.strip().lower() for column in text.names]
    wanted = [names.index(_only(names, TIME_NAMES, "time")), names.index(_only(names, SPEED_NAMES, "speed"))]
    flow = next((column for column in (*MASS_FLOW_NAMES, *VOLUME_FLOW_NAMES) if column in names), None)
    if flow is not None:
        wanted.append(names.index(flow))
    decimal = "," if text.decimal_comma else "."
    rows = csv.reader(io.StringIO(text.body.decode()), delimiter=text.delimiter)
    values = [
        [_number(row, column, number, text.names[column], decimal) for column in wanted]
        for number, row in enumerate(rows, start=text.header_row + 1)
        if any(cell.strip() for cell in row)
    ]
    if len(values) < 2:
        raise SignalsError("The table has no two rows; one row a second is expected.")
    table = np.array(values)
    _check(table, text.header_row)
    speed = table[:, 1] * SPEED_NAMES[names[wanted[1]]]
    if speed.min() < -1.0 or speed.max() > FASTEST_MPS:
        column = text.names[wanted[1]]
        raise SignalsError(
            f"{column}: from {speed.min():.0f} to {speed.max():.0f} m/s is no car's speed; is the unit right?"
        )
    seconds = np.arange(table[0, 0], table[-1, 0] + 1e-9, 1.0)
    power = None if flow is None else np.interp(seconds, table[:, 0], table[:, 2] * _joules_per(flow, fuel))
    return DrivingCycle(name, np.maximum(np.interp(seconds, table[:, 0], speed), 0.0), power)


def _joules_per(flow: str, fuel: Fuel) -> float:
    """Return the joules of what a flow of one stands for."""
    if flow in MASS_FLOW_NAMES:
        return fuel.energy_j_per_l / (1000.0 * fuel.density_kg_per_l)
    return VOLUME_FLOW_NAMES[flow] * fuel.energy_j_per_l


def _only(names: list[str], known: tuple[str, ...] | dict[str, float], what: str) -> str:
    found = [name for name in known if name in names]
    if not found:
        raise SignalsError(f"No column for the {what}: one of {', '.join(known)} is needed.", field=next(iter(known)))
    return found[0]


def _number(row: list[str], column: int, number: int, name: str, decimal: str) -> float:
    cell = row[column].strip().replace(decimal, ".") if column < len(row) else ""
    try:
        value = float(cell)
    except ValueError:
        value = np.nan
    if not np.isfinite(value):
        raise SignalsError(
            f"Row {number}, {name}: {cell!r} is not a number; fill it in or leave the row out.", number, name
        )
    return value


def _check(table: FloatArray, header_row: int) -> None:
    gaps = np.diff(table[:, 0])
    bad = int(np.argmax((gaps <= 0.0) | (gaps > LONGEST_GAP_S)))
    if gaps[bad] <= 0.0 or gaps[bad] > LONGEST_GAP_S:
        row = header_row + bad + 2
        message = (
            f"Row {row}: {gaps[bad]:g} s after the row before; times have to rise, by {LONGEST_GAP_S:g} s at most."
        )
        raise SignalsError(message, row, "t_s")
    if table.shape[1] > 2 and table[:, 2].min() < 0.0:
        row = header_row + int(table[:, 2].argmin()) + 1
        raise SignalsError(f"Row {row}: the fuel flow is below zero.", row, "fuel_g_s")
