"""The map as the JSON document others read, and back."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import asdict, fields
from math import isfinite
from typing import Any

import numpy as np

from app.science.arrays import FloatArray
from app.science.engine.efficiency_map import CellGrid, EfficiencyMap, Idle
from app.science.engine.operating_line import optimal_operating_line
from app.science.engine.reading import peak
from app.science.errors import ScienceError


def map_document(efficiency_map: EfficiencyMap, provenance: Mapping[str, Any]) -> dict[str, Any]:
    """Return ``map.json`` as a JSON-able dict: NaN becomes None, numbers keep their full precision.

    Parameters
    ----------
    efficiency_map : EfficiencyMap
    provenance : mapping
        What the map was made from; passed through.
    """
    m = efficiency_map
    columns = zip(
        m.rpm.tolist(),
        m.nm.tolist(),
        m.n.tolist(),
        m.efficiency.tolist(),
        m.sd.tolist(),
        m.bsfc_gpkwh.tolist(),
        strict=True,
    )
    best = peak(m)
    return {
        "cell": {
            "rpm": m.grid.rpm,
            "nm": m.grid.nm,
            "min_count": m.grid.min_count,
            "max_sd": m.grid.max_sd,
            "independent": m.grid.independent,
        },
        "cells": [
            {
                "rpm": rpm,
                "nm": nm,
                "n": n,
                "efficiency": _number(efficiency),
                "sd": _number(sd),
                "bsfc_gpkwh": _number(bsfc),
            }
            for rpm, nm, n, efficiency, sd, bsfc in columns
        ],
        "full_load": np.column_stack((m.full_load_rpm, m.full_load_nm)).tolist(),
        "full_load_sd": None if m.full_load_sd is None else [_number(sd) for sd in m.full_load_sd.tolist()],
        "full_load_reached": None if m.full_load_reached is None else m.full_load_reached.tolist(),
        "idle": m.idle and asdict(m.idle),
        "warnings": list(m.warnings),
        "best": best and asdict(best),
        "operating_line": _operating_line(m),
        "provenance": dict(provenance),
    }


def _operating_line(m: EfficiencyMap) -> list[dict[str, float]]:
    line = optimal_operating_line(m)
    bsfc = np.nanmedian(m.bsfc_gpkwh * m.efficiency) / line.efficiency if len(line.power_w) else line.efficiency
    names = ("power_w", "rpm", "nm", "efficiency", "bsfc_gpkwh")
    rows = np.column_stack((line.power_w, line.rpm, line.nm, line.efficiency, bsfc)).tolist()
    return [dict(zip(names, row, strict=True)) for row in rows]


def read_map_document(document: Mapping[str, Any]) -> EfficiencyMap:
    """Read a document of `map_document` back.

    Only ``cell.rpm``, ``cell.nm``, and of each cell ``rpm``, ``nm`` and ``efficiency`` are needed; what a document
    made elsewhere lacks becomes NaN, or 0 points.

    Raises
    ------
    ScienceError
        When a needed entry is missing or not a number.
    """
    defaults = CellGrid()
    try:
        cell, cells = document["cell"], document["cells"]
        grid = CellGrid(
            rpm=float(cell["rpm"]),
            nm=float(cell["nm"]),
            min_count=int(cell.get("min_count", defaults.min_count)),
            max_sd=float(cell.get("max_sd", defaults.max_sd)),
            independent=bool(cell.get("independent", defaults.independent)),
        )

        def column(name: str) -> FloatArray:
            return np.array([np.nan if c.get(name) is None else float(c[name]) for c in cells], dtype=np.float64)

        line = np.array(document.get("full_load", []), dtype=np.float64).reshape(-1, 2)
        rpm, nm = (np.array([float(c[name]) for c in cells], dtype=np.float64) for name in ("rpm", "nm"))
        n = np.nan_to_num(column("n")).astype(np.int64)
        efficiency, sd, bsfc = column("efficiency"), column("sd"), column("bsfc_gpkwh")
        line_sd, reached, idle = (document.get(name) for name in ("full_load_sd", "full_load_reached", "idle"))
        line_sd = None if line_sd is None else np.array(line_sd, dtype=np.float64)
        reached = None if reached is None else np.array(reached, dtype=np.bool_)
        idle = _idle(idle) if idle else None
        warnings = tuple(str(warning) for warning in document.get("warnings", ()))
    except (KeyError, TypeError, ValueError, AttributeError) as error:
        raise ScienceError(
            f"map document: {error!r}; it needs cell.rpm, cell.nm and a list cells with rpm, nm and efficiency"
        ) from error
    return EfficiencyMap(
        grid=grid,
        rpm=rpm,
        nm=nm,
        n=n,
        efficiency=efficiency,
        sd=sd,
        bsfc_gpkwh=bsfc,
        full_load_rpm=line[:, 0].copy(),
        full_load_nm=line[:, 1].copy(),
        full_load_sd=line_sd,
        full_load_reached=reached,
        idle=idle,
        warnings=warnings,
    )


def _idle(document: Mapping[str, Any]) -> Idle:
    """Read idle; only its engine speed and its fuel power are needed."""
    needed = {"rpm": float(document["rpm"]), "fuel_power_w": float(document["fuel_power_w"])}
    rest = {field.name: float(document.get(field.name) or 0.0) for field in fields(Idle) if field.name not in needed}
    return Idle(**needed, **rest)


def _number(value: float) -> float | None:
    """None where JSON has no number."""
    return value if isfinite(value) else None
