"""``./ponthy simulate``: a virtual drive with known truth."""

from __future__ import annotations

from enum import StrEnum
from pathlib import Path
from typing import Annotated

import typer

from app.cli.options import AsJson
from app.cli.output import note, say, write_json

SECONDS_PER_MINUTE = 60.0


class Route(StrEnum):
    """Roads of the virtual car."""

    MIXED = "mixed"
    MOTORWAY = "motorway"
    TOWN = "town"
    FULL_LOAD = "full-load"
    TUNNEL = "tunnel"


def simulate(
    out: Annotated[Path, typer.Argument(file_okay=False, help="Folder to write to; made when it is missing.")],
    minutes: Annotated[float, typer.Option(min=1.0, max=1440.0, help="Length of the drive.")] = 60.0,
    seed: Annotated[int, typer.Option(min=0, help="The same seed gives the same files, byte for byte.")] = 1,
    route: Annotated[Route, typer.Option(help="Kind of road and driver.")] = Route.MIXED,
    car: Annotated[Path | None, typer.Option(exists=True, dir_okay=False, help="XML of the car to drive.")] = None,
    as_json: AsJson = False,
) -> None:
    """Drive a virtual car whose truth is known.

    Writes trip.dat (logger image), car.xml, elevation.csv, truth.parquet and truth.json. A car that was given is
    driven as it is, so its XML is written as it came.
    """
    from app.cli.tables import write_columns
    from app.science.vehicle.xml import read_vehicle
    from app.science.virtualcar.simulate import simulate as drive
    from app.science.virtualcar.specification import Simulation

    given = None if car is None else car.read_bytes()
    vehicle = None if given is None else read_vehicle(given)
    note(f"driving {minutes:g} minutes of {route.value} road with seed {seed}")
    trip = drive(Simulation(duration_s=minutes * SECONDS_PER_MINUTE, seed=seed, route=route.value, vehicle=vehicle))
    out.mkdir(parents=True, exist_ok=True)
    (out / "trip.dat").write_bytes(trip.image)
    (out / "car.xml").write_bytes(given or trip.car_xml)
    (out / "elevation.csv").write_bytes(trip.elevation_csv)
    write_columns(out / "truth.parquet", trip.truth)
    write_json(out / "truth.json", trip.summary)
    kilometres, litres = trip.summary["distance_m"] / 1000.0, trip.summary["fuel_l"]
    say(trip.summary, as_json, f"{out}: {kilometres:.1f} km in {minutes:g} minutes with {litres:.2f} l of fuel")
