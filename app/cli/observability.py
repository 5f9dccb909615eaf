"""``./ponthy observability``: what a car's sensors tell, and what is lost with each of them."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from app.cli.options import AsJson
from app.cli.output import say

if TYPE_CHECKING:
    from app.science.observer.observability.losses import Told
    from app.science.observer.observability.table import Case

LEGEND = (
    "● told, ◐ told only while speed, direction and slope change, ○ not told;\n"
    "the first sign is for the moving car, the second for the standing one."
)


def observability(
    car: Annotated[
        Path | None, typer.Option("--car", exists=True, dir_okay=False, help="The car's XML; else a small car.")
    ] = None,
    as_json: AsJson = False,
) -> None:
    """Say which states each set of sensors tells.

    The rank test on Lie derivatives (Sebesta 2010, A.1.2.1) for the 17 states, at speed and at standstill.
    """
    from app.science.observer.observability.car_system import car_in_gear
    from app.science.observer.observability.losses import USUAL_GEAR, SensorTest
    from app.science.observer.observability.table import loss_table, table_text
    from app.science.observer.states import STATE_COLUMNS
    from app.science.vehicle.model import Vehicle
    from app.science.vehicle.xml import read_vehicle

    vehicle = Vehicle() if car is None else read_vehicle(car.read_bytes())
    rows = loss_table(SensorTest(car_in_gear(vehicle, USUAL_GEAR)))
    document = {"states": list(STATE_COLUMNS), "cases": [_as_dict(case, told) for case, told in rows]}
    say(document, as_json, f"{table_text(rows)}\n\n{LEGEND}")


def _as_dict(case: Case, told: Told) -> dict[str, object]:
    return {
        "sensors": case.name,
        "moving": list(told.moving),
        "standing": [bool(value) for value in told.standing],
        "gap": told.gap,
    }
