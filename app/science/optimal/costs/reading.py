"""The ``cost`` of a problem document: weights, and maps of emissions over engine speed and torque."""

from __future__ import annotations

import re
from collections.abc import Mapping

import numpy as np

from app.science.fields import Fields, ProblemError, checked, nearest, shown
from app.science.optimal.costs.carbon import CARBON, co2_g_per_mj
from app.science.optimal.costs.formula import fit_table
from app.science.optimal.costs.weighted import CO2, FUEL, TIME, Cost, Emission, WeightedDrive, WeightedEngine, weighted
from app.science.optimal.fuel_checks import full_load_nm
from app.science.optimal.problem import Engine, PolynomialEngine, WillansDrive

NAME = re.compile(r"[a-z][a-z0-9_]{0,31}")
HEAVIEST = 1e12
MOST_GPS = 1e4
MOST_NODES, MOST_EMISSIONS = 10_000, 12
SLACK = 1e-9


def read_cost(fields: Fields, engine: Engine) -> WeightedEngine | WeightedDrive:
    """Read a ``cost`` and return the engine that burns it.

    Raises
    ------
    ProblemError
        For a weight below zero or of something unknown, and for a map whose grid doesn't grow, whose shape is another,
        that goes below zero or leaves part of the engine's field without a value.
    """
    co2 = _co2(fields)
    emissions = _emissions(fields, engine)
    weights = _weights(fields, [emission.name for emission in emissions])
    fields.close()
    cost = Cost(weights, co2, emissions)
    if cost.of_fuel == 0.0 and not any(cost.weight(one.name) > 0.0 and one.peak_gps > 0.0 for one in emissions):
        raise ProblemError(
            fields.path("weights"), "nothing has a weight above zero, so every drive would cost nothing."
        )
    return weighted(engine, cost)


def _co2(fields: Fields) -> float:
    """Return the CO2 of the fuel, g/MJ."""
    name = fields.word("fuel", tuple(CARBON)) if fields.has("fuel") else "petrol"
    return fields.number("co2_g_per_mj", 0.0, 1000.0, co2_g_per_mj(name))


def _weights(fields: Fields, emissions: list[str]) -> tuple[tuple[str, float], ...]:
    if not fields.has("weights"):
        return ((FUEL, 1.0),)
    found = fields.inner("weights")
    given = fields.get("weights")
    known = (FUEL, CO2, *emissions)
    for name in given:
        if name == TIME:
            raise ProblemError(found.path(TIME), "time is not weighed; give the drive its time instead.")
        if name not in known:
            raise ProblemError(
                found.path(str(name)), f"there is no map of {name} among cost.emissions{nearest(name, known)}"
            )
    weights = {name: found.number(name, 0.0, HEAVIEST) for name in given}
    return tuple(({FUEL: 1.0} | weights).items())


def _emissions(fields: Fields, engine: Engine) -> tuple[Emission, ...]:
    if not fields.has("emissions"):
        return ()
    maps = fields.inner("emissions")
    given: Mapping[str, object] = fields.get("emissions")
    if given and isinstance(engine, WillansDrive):
        raise ProblemError(
            fields.path("emissions"),
            "a Willans drive has no engine speed to look a map up with; weigh fuel and co2, or give phi or p_in.",
        )
    if len(given) > MOST_EMISSIONS:
        raise ProblemError(fields.path("emissions"), f"has {len(given)} maps; {MOST_EMISSIONS} are allowed.")
    for name in given:
        if not NAME.fullmatch(str(name)) or name in (FUEL, CO2, TIME):
            raise ProblemError(
                maps.path(str(name)), "can't be the name of an emission; use small letters, such as nox, hc, co, pm."
            )
    return tuple(
        _emission(str(name), maps.inner(name), engine) for name in given if isinstance(engine, PolynomialEngine)
    )


def _emission(name: str, fields: Fields, engine: PolynomialEngine) -> Emission:
    rpm = _grid(fields, "rpm", 0.0, 50_000.0)
    nm = _grid(fields, "nm", -5_000.0, 50_000.0)
    table = _table(fields, len(rpm), len(nm))
    idle = fields.number("idle_gps", 0.0, MOST_GPS, 0.0)
    fields.close()
    _covers(fields, rpm, nm, engine)
    formula = fit_table(rpm, nm, np.array(table), engine)
    return Emission(name, rpm, nm, table, idle, formula.terms, formula.coefficients, formula.rms, formula.largest)


def _grid(fields: Fields, name: str, low: float, high: float) -> tuple[float, ...]:
    values = fields.numbers(name, low, high)
    if len(values) < 2:
        raise ProblemError(fields.path(name), f"has {len(values)} values; two at least are needed.")
    for k in range(1, len(values)):
        if values[k] <= values[k - 1]:
            raise ProblemError(
                fields.path(f"{name}[{k}]"), f"{values[k]:g} is not above {values[k - 1]:g} before it; the grid grows."
            )
    return values


def _table(fields: Fields, rows: int, columns: int) -> tuple[tuple[float, ...], ...]:
    path, given = fields.path("gps"), fields.get("gps")
    if not isinstance(given, list | tuple):
        raise ProblemError(path, "is not a list of rows of g/s, one row for each engine speed.")
    if rows * columns > MOST_NODES:
        raise ProblemError(path, f"has {rows * columns} values; {MOST_NODES} are allowed.")
    if len(given) != rows:
        turned = len(given) == columns and all(isinstance(row, list | tuple) and len(row) == rows for row in given)
        hint = " It has one row for each torque; turn it round." if turned else ""
        raise ProblemError(path, f"has {len(given)} rows; {rows} are needed, one for each of rpm.{hint}")
    for i, row in enumerate(given):
        if not isinstance(row, list | tuple) or len(row) != columns:
            have = f"{len(row)} values" if isinstance(row, list | tuple) else shown(row)
            raise ProblemError(f"{path}[{i}]", f"has {have}; {columns} are needed, one for each of nm.")
    return tuple(
        tuple(checked(value, f"{path}[{i}][{k}]", 0.0, MOST_GPS) for k, value in enumerate(row))
        for i, row in enumerate(given)
    )


def _covers(fields: Fields, rpm: tuple[float, ...], nm: tuple[float, ...], engine: PolynomialEngine) -> None:
    """Refuse a map that doesn't reach as far as the engine can go."""
    speeds = np.array([*np.linspace(*engine.speed_rpm, 61), *(p[0] for p in engine.full_load)])
    speeds = speeds[(speeds >= engine.speed_rpm[0]) & (speeds <= engine.speed_rpm[1])]
    top = float(full_load_nm(engine, speeds).max())
    needed = {"rpm": (rpm, engine.speed_rpm, "rpm"), "nm": (nm, (engine.torque_nm[0], top), "Nm")}
    for name, (grid, (low, high), unit) in needed.items():
        size = SLACK * max(abs(low), abs(high))
        if grid[0] > low + size:
            raise ProblemError(
                fields.path(name),
                f"begins at {grid[0]:g} {unit}, the engine at {low:g}: {low:g} to {grid[0]:g} is missing.",
            )
        if grid[-1] < high - size:
            raise ProblemError(
                fields.path(name),
                f"ends at {grid[-1]:g} {unit}, the engine at {high:g}: {grid[-1]:g} to {high:g} is missing.",
            )
