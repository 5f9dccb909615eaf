"""A dynamometer's or a manufacturer's table as the engine of a problem."""

from __future__ import annotations

from typing import Any

import numpy as np

from app.science.engine.efficiency_map import CellGrid
from app.science.engine.reference import RADPS_PER_RPM, ReferenceMap
from app.science.optimal.costs.formula import fit_points
from app.science.optimal.from_map import word
from app.science.optimal.posing.errors import PoseError

FEWEST_CELLS = 30
LOOKS = 61
MEASUREMENTS, SCATTER = 400, 0.01
"""What each cell of a table counts for: as one that was well driven."""


def map_of_table(table: ReferenceMap) -> dict[str, Any]:
    """Return a ``map.json`` with the table's efficiency in every cell that it reaches.

    Parameters
    ----------
    table : ReferenceMap
        Linear between its points.

    Raises
    ------
    PoseError
        When it reaches hardly any cell.
    """
    grid = CellGrid()
    rpm, nm = (
        (np.arange(np.floor(x.min() / size), np.ceil(x.max() / size)) + 0.5) * size
        for x, size in ((table.rpm, grid.rpm), (table.nm, grid.nm))
    )
    speed, torque = (one.ravel() for one in np.meshgrid(rpm, nm, indexing="ij"))
    efficiency = table.at(speed, torque)
    known = np.isfinite(efficiency) & (efficiency > 0.0)
    if known.sum() < FEWEST_CELLS:
        raise PoseError(f"The table reaches {known.sum()} cells of a map only; {FEWEST_CELLS} at least are needed.")
    cells = [
        {"rpm": w, "nm": t, "n": MEASUREMENTS, "efficiency": e, "sd": SCATTER, "bsfc_gpkwh": None}
        for w, t, e in zip(speed[known].tolist(), torque[known].tolist(), efficiency[known].tolist(), strict=True)
    ]
    speeds = np.unique(table.rpm)
    line = [[float(w), float(table.nm[table.rpm == w].max())] for w in speeds]
    return {"cell": {"rpm": grid.rpm, "nm": grid.nm}, "cells": cells, "full_load": line}


def engine_of_table(table: ReferenceMap, idle_fuel_power_w: float = 0.0) -> dict[str, Any]:
    """Return the engine of a problem whose fuel power follows a table as nearly as a polynomial can.

    Powers up to the fifth of engine speed and of torque, by least squares of relative misses. Such a formula is convex
    no more than the table is, and it holds inside the table only, which limits the engine.

    Parameters
    ----------
    table : ReferenceMap
    idle_fuel_power_w : float
        Which a table seldom tells.

    Raises
    ------
    PoseError
        When no torque is known at all of its speeds.
    """
    document = map_of_table(table)
    line = np.array(document["full_load"])
    rpm = np.linspace(line[0, 0], line[-1, 0], LOOKS)
    top = np.interp(rpm, line[:, 0], line[:, 1])
    lowest = max(float(table.nm[table.rpm == w].min()) for w in line[:, 0])
    if lowest >= line[:, 1].min():
        raise PoseError(
            f"No torque is known at all of the table's speeds: at one it begins at {lowest:g} Nm, at another it ends "
            f"at {line[:, 1].min():g} Nm. Leave such a speed out."
        )
    speed = np.repeat(rpm[:, None], LOOKS, axis=1)
    torque = lowest + np.linspace(0.0, 1.0, LOOKS) * (top - lowest)[:, None]
    efficiency = table.at(speed, torque)
    known = np.isfinite(efficiency)
    omega, torque = (speed * RADPS_PER_RPM)[known], torque[known]
    fuel = omega * torque / efficiency[known]
    found = fit_points(omega, torque, fuel, fuel)
    return {
        "p_in": list(found.coefficients),
        "terms": [word(*term) for term in found.terms],
        "speed_rpm": [float(rpm[0]), float(rpm[-1])],
        "torque_nm": [lowest, float(line[:, 1].max())],
        "full_load": line.tolist(),
        "idle_fuel_power_w": idle_fuel_power_w,
    }
