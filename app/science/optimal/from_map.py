"""A car's map as the engine of a drive problem."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from app.science.engine.document import read_map_document
from app.science.engine.fitting.family import FitRequest, fit_map
from app.science.engine.fitting.willans import WILLANS
from app.science.fields import Fields
from app.science.optimal.problem import TABLE_4_1

FITS = ("willans", "phi")


def engine_of_map(document: Mapping[str, Any], fields: Fields) -> dict[str, Any]:
    """Return an engine object that says what a map's engine burns, where it was driven.

    Parameters
    ----------
    document : mapping
        ``map.json``.
    fields : Fields
        The engine object that names the map. Its ``fit`` chooses the formula: ``willans`` (unless said otherwise), fuel
        power that is convex in torque and goes through idle, or ``phi``, Table 4.1's terms.

    Raises
    ------
    FitError
        When the map can't carry the formula.
    """
    fit = fields.word("fit", FITS) if fields.has("fit") else FITS[0]
    fields.has("map")
    fields.close()
    efficiency_map = read_map_document(document)
    p_in = fit_map(efficiency_map, FitRequest(target="p_in"))
    willans = p_in.named(WILLANS.name)
    idle = p_in.idle
    line = zip(efficiency_map.full_load_rpm.tolist(), efficiency_map.full_load_nm.tolist(), strict=True)
    engine: dict[str, Any] = {
        "speed_rpm": [float(p_in.area.rpm[0]), float(p_in.area.rpm[-1])],
        "torque_nm": [float(p_in.area.nm[0]), float(p_in.area.nm[-1])],
        "full_load": [list(point) for point in line] or None,
        "idle_fuel_power_w": idle.fuel_power_w if idle is not None else max(willans.idle_fuel_power_w or 0.0, 0.0),
    }
    if fit == "phi":
        table = fit_map(efficiency_map, FitRequest(target="phi", degree=2)).named("table 4.1").formula
        found = dict(zip(table.terms.terms, table.coefficients.tolist(), strict=True))
        return {"phi": [found[term] for term in TABLE_4_1], **engine}
    words = [word(*term) for term in willans.formula.terms.terms]
    return {"p_in": willans.formula.coefficients.tolist(), "terms": words, **engine}


def word(i: int, j: int) -> str:
    """Return a term as it is written in a document."""
    return ("" if i == 0 else f"w{i}") + ("" if j == 0 else f"T{j}") or "1"
