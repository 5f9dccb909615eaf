"""``./ponthy compare``: a map beside another one, or beside a table of a dynamometer or a manufacturer."""

from __future__ import annotations

from dataclasses import asdict
from enum import StrEnum
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from app.cli.fit import read_map
from app.cli.options import AsJson
from app.cli.output import say, table
from app.science.errors import ScienceError

if TYPE_CHECKING:
    from app.science.engine.efficiency_map import EfficiencyMap


class FuelName(StrEnum):
    """Fuels whose heating value is known."""

    PETROL = "petrol"
    DIESEL = "diesel"
    E10 = "e10"
    E85 = "e85"
    LPG = "lpg"


def compare(
    map_file: Annotated[Path, typer.Argument(metavar="MAP.json", exists=True, dir_okay=False)],
    other: Annotated[Path, typer.Argument(metavar="MAP.json|TABLE.csv", exists=True, dir_okay=False)],
    fuel: Annotated[FuelName, typer.Option(help="Fuel of a table that tells grams.")] = FuelName.PETROL,
    as_json: AsJson = False,
) -> None:
    """Compare a map with another map, cell by cell, or with a table of rpm, Nm and efficiency, g/s or g/kWh.

    A cell counts as changed where chance explains at most one in twenty of the cells so called.
    """
    efficiency_map = read_map(map_file)
    if other.suffix.lower() == ".json":
        answer, lines = beside_map(efficiency_map, read_map(other))
    else:
        answer, lines = beside_table(efficiency_map, other.read_bytes(), fuel.value)
    say(answer, as_json, table(lines))


def beside_map(first: EfficiencyMap, second: EfficiencyMap) -> tuple[dict[str, Any], list[list[str]]]:
    """Compare two maps; returns the document and the lines to print."""
    from app.science.engine.compare import compare_maps

    found = compare_maps(first, second)
    cells = [
        {"rpm": rpm, "nm": nm, "difference": difference, "sd": sd, "significant": bool(told)}
        for rpm, nm, difference, sd, told in zip(
            found.rpm.tolist(), found.nm.tolist(), found.difference.tolist(), found.sd.tolist(), found.significant,
            strict=True,
        )
    ]  # fmt: skip
    answer = {
        "level": found.level,
        "level_sd": found.level_sd,
        "common_cells": len(cells),
        "only_first": found.only_first,
        "only_second": found.only_second,
        "changed_cells": int(found.significant.sum()),
        "cells": cells,
    }
    lines = [
        ["second over first", f"{found.level:.4f} ± {found.level_sd:.4f}"],
        ["cells in both", str(len(cells))],
        ["changed beyond chance", str(answer["changed_cells"])],
        ["in the first alone", str(found.only_first)],
        ["in the second alone", str(found.only_second)],
    ]
    return answer, lines


def beside_table(efficiency_map: EfficiencyMap, data: bytes, fuel: str) -> tuple[dict[str, Any], list[list[str]]]:
    """Compare a map with a table; returns the document and the lines to print."""
    from app.science.engine.agreement import agreement
    from app.science.engine.reference import read_reference
    from app.science.vehicle.fuels import FUELS

    chosen = FUELS[fuel]
    heating_value_jpg = chosen.energy_j_per_l / (1000.0 * chosen.density_kg_per_l)
    found = agreement(efficiency_map, read_reference(data, heating_value_jpg))
    if found is None:
        raise ScienceError("The map and the table hardly overlap; compare them where both have points.")
    lines = [
        ["cells inside the table", str(found.cells)],
        ["map over table", f"{found.scale:.4f} ± {found.scale_sd:.4f}"],
        ["correlation of the shapes", f"{found.correlation:.4f}"],
        ["best point, map less table", f"{found.peak_rpm:+.0f} rpm, {found.peak_nm:+.0f} Nm"],
        ["difference of η, RMS", f"{found.rmse:.4f}"],
        ["the same without the scale", f"{found.rmse_scaled:.4f}"],
    ]
    return asdict(found), lines
