"""``./ponthy pose``: a drive for a car from its file, its map and a road."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from app.cli.drive import read_document
from app.cli.output import json_text, note, write_json
from app.cli.road import KMH, Output

if TYPE_CHECKING:
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

    wishes = Wishes(
        from_speed_mps=None if from_kmh is None else from_kmh / KMH,
        to_speed_mps=None if to_kmh is None else to_kmh / KMH,
        max_time_s=max_time,
        distance_m=distance,
        neutral=neutral,
        shift_cost_j=shift_cost,
    )
    given = None if road_file is None else read_document(road_file)
    if isinstance(given, dict) and "road" in given:
        given = given["road"]
    vehicle = read_vehicle(car.read_bytes())
    document, engine = map_or_table(map_file, vehicle, fit)
    posed = problem_of_car(
        vehicle,
        document,
        given,
        kind=None if distance is None else "distance",
        wishes=wishes,
        fit=fit,
        engine=engine,
    )
    for line in posed.notes:
        note(line)
    if out is None:
        print(json_text(posed.problem))
    else:
        write_json(out, posed.problem)


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
