"""``./ponthy pose``: a drive for a car from its file, its map and a road."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from app.cli.drive import read_document
from app.cli.output import json_text, note, write_json
from app.cli.road import KMH, Output

if TYPE_CHECKING:
    from app.science.optimal.posing.car import CarKind
    from app.science.vehicle.model import Vehicle


def pose(
    car: Annotated[Path, typer.Argument(metavar="CAR.xml", exists=True, dir_okay=False)],
    map_file: Annotated[Path, typer.Argument(metavar="MAP", exists=True, dir_okay=False)],
    road_file: Annotated[
        Path | None, typer.Option("--road", exists=True, dir_okay=False, help="What ./ponthy road wrote.")
    ] = None,
    distance: Annotated[float | None, typer.Option(min=1.0, help="Instead of a road: a distance, m.")] = None,
    from_kmh: Annotated[float | None, typer.Option("--from", min=0.0, help="Speed at the start, km/h.")] = None,
    to_kmh: Annotated[float | None, typer.Option("--to", min=0.0, help="Speed at the end, km/h.")] = None,
    max_time: Annotated[float | None, typer.Option(min=0.1, help="At most, s; without a road: exactly.")] = None,
    neutral: Annotated[bool | None, typer.Option("--neutral/--in-gear", help="Whether it may roll in neutral.")] = None,
    shift_cost: Annotated[
        float | None, typer.Option(min=0.0, help="Charged for a change of gear, J; 2000 on a route, else nothing.")
    ] = None,
    fit: Annotated[str, typer.Option(help="Formula: willans or phi; table for a table.")] = "willans",
    out: Output = None,
) -> None:
    """Pose a drive for a car from its file, its map and a road; ./ponthy drive solves it.

    Instead of a map it may be a table of a dynamometer or a manufacturer: rpm, torque_nm, and eff or fuel_g_s.
    """
    from app.science.optimal.posing.car import Wishes, problem_of_car
    from app.science.vehicle.xml import read_vehicle

    road, driven = road_of(road_file)
    start, end = (
        given if kmh is None else kmh / KMH
        for kmh, given in ((from_kmh, driven["from_speed_mps"]), (to_kmh, driven["to_speed_mps"]))
    )
    seconds = driven["time_s"] if max_time is None else max_time
    kind: CarKind | None = None if distance is None else "distance"
    vehicle = read_vehicle(car.read_bytes())
    known, engine = map_or_table(map_file, vehicle, fit)
    wishes = Wishes(start, end, seconds, distance, neutral, shift_cost)
    posed = problem_of_car(vehicle, known, road, kind=kind, wishes=wishes, fit=fit, engine=engine)
    for line in posed.notes:
        note(line)
    if out is None:
        print(json_text(posed.problem))
    else:
        write_json(out, posed.problem)


def road_of(path: Path | None) -> tuple[Any, dict[str, float | None]]:
    """Return a road, and how it was driven where ``./ponthy road --json`` told that, too."""
    given = None if path is None else read_document(path)
    told = given if isinstance(given, dict) else {}
    driven = {name: told.get(name) for name in ("from_speed_mps", "to_speed_mps", "time_s")}
    return told.get("road", given), driven


def map_or_table(path: Path, vehicle: Vehicle, fit: str) -> tuple[dict[str, Any], dict[str, Any] | None]:
    """Return a map's document, and the engine that follows a table itself where that is wanted."""
    from app.science.engine.reference import read_reference
    from app.science.optimal.posing.table_engine import engine_of_table, map_of_table

    data = path.read_bytes()
    if data.lstrip().startswith(b"{"):
        if fit == "table":
            raise typer.BadParameter(f"--fit table: {path} is a map; take willans or phi")
        return read_document(path), None
    table = read_reference(data, vehicle.fuel_energy_j_per_l / (1000.0 * vehicle.fuel_density_kg_per_l))
    return map_of_table(table), engine_of_table(table) if fit == "table" else None
