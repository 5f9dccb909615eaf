"""``./ponthy battery-track``: a cell's capacity from discharge to discharge, most of them partial."""

from __future__ import annotations

from itertools import chain
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from app.cli.options import AsJson
from app.cli.output import say, table

if TYPE_CHECKING:
    from app.science.battery.record import BatteryRecord
    from app.science.battery.tracking import Tracked


def battery_track(
    data: Annotated[
        list[Path], typer.Argument(metavar="DATA…", exists=True, dir_okay=False, help="One discharge a file, in order.")
    ],
    limits: Annotated[
        tuple[float, float], typer.Option("--limits", metavar="EMPTY FULL", help="One cell's end voltages.")
    ],
    resistance_ohm: Annotated[
        float, typer.Option("--resistance-ohm", min=1e-6, help="In series: its step of voltage over that of current.")
    ],
    relaxation_ohm: Annotated[float, typer.Option("--relaxation-ohm", min=1e-6, help="Of the relaxation.")],
    time_constant_s: Annotated[float, typer.Option("--time-constant-s", min=0.1, help="Of the relaxation.")],
    by: Annotated[
        str | None, typer.Option(metavar="COLUMN", help="The files hold many discharges, told apart by this column.")
    ] = None,
    logged: Annotated[
        bool, typer.Option("--logged", help="A row's current is the one that flowed up to it, as cyclers write it.")
    ] = False,
    as_json: AsJson = False,
) -> None:
    """Follow an ageing cell that is charged full each time and emptied now and then: the first discharges are full."""
    from app.science.battery.circuit import Circuit
    from app.science.battery.laboratory import held_from_logged
    from app.science.battery.tracking import Tracking, track

    named = records_of(data, by)
    records = [held_from_logged(record) if logged else record for record in named.values()]
    circuit = Circuit(1.0, resistance_ohm, time_constant_s / relaxation_ohm, relaxation_ohm)
    found = dict(zip(named, track(records, Tracking(circuit, limits)), strict=True))
    document = [
        {
            "discharge": name,
            "capacity_ah": one.capacity_ah,
            "capacity_ah_sd": one.sd_ah,
            "measured": one.measured,
            "resistance_ohm": one.circuit.resistance_ohm,
        }
        for name, one in found.items()
    ]
    say({"discharges": document}, as_json, words(found))


def records_of(data: list[Path], by: str | None) -> dict[str, BatteryRecord]:
    """Return the discharges of all files by name, in order."""
    from app.imports.battery import read_battery, read_discharges

    if by is None:
        return {path.name: read_battery(path) for path in data}
    return dict(chain.from_iterable(read_discharges(path.read_bytes(), by).items() for path in data))


def words(found: dict[str, Tracked]) -> str:
    """Return the capacities as a table."""
    rows = [["discharge", "capacity, Ah", "±", "", "resistance, mΩ"]]
    for name, one in found.items():
        how = "full" if one.measured else "estimated"
        ohm = f"{1e3 * one.circuit.resistance_ohm:.2f}"
        rows.append([name, f"{one.capacity_ah:.4f}", f"{one.sd_ah:.4f}", how, ohm])
    return table(rows)
