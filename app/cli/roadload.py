"""``./ponthy roadload``: mass, air drag and rolling resistance of a car from how it drove."""

from __future__ import annotations

from dataclasses import asdict
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from app.cli.inputs import InputFormat, recordings
from app.cli.options import AsJson
from app.cli.output import note, say, table

if TYPE_CHECKING:
    from app.science.logger.recording import Recording
    from app.science.roadload.evidence import RoadLoadEvidence
    from app.science.roadload.identify import RoadLoad
    from app.science.roads.elevation import RoadElevation
    from app.science.vehicle.model import Vehicle


def roadload(
    files: Annotated[list[Path], typer.Argument(exists=True, dir_okay=False, help="Logger images or signals tables.")],
    car: Annotated[Path, typer.Option(exists=True, dir_okay=False, help="XML of the car.")],
    elevation: Annotated[
        Path | None, typer.Option(exists=True, dir_okay=False, help="Table of altitudes along roads (CSV).")
    ] = None,
    load_kg: Annotated[float, typer.Option(min=0.0, help="Driver and things, kg.")] = 75.0,
    form: Annotated[InputFormat, typer.Option("--format", help="What the files hold.")] = InputFormat.AUTO,
    mapping: Annotated[
        Path | None, typer.Option(exists=True, dir_okay=False, help="Names and scales of foreign columns (JSON).")
    ] = None,
    as_json: AsJson = False,
) -> None:
    """Tell mass, C_d·A and C_rr from steady driving and coasting, and the efficiency before and after.

    The car's file is the prior and stays as it is.
    """
    from app.imports.elevation import read_elevation
    from app.science.errors import ScienceError
    from app.science.roadload.identify import identify
    from app.science.vehicle.xml import read_vehicle

    vehicle = read_vehicle(car.read_bytes(), load_kg=load_kg)
    roads = None if elevation is None else read_elevation(elevation.read_bytes())
    evidences: list[RoadLoadEvidence] = []
    for trip in recordings(files, form, mapping):
        try:
            evidences += trip_evidences(trip.recording, vehicle, roads)
            note(f"{trip.name}: {trip.recording.duration_s / 60.0:.0f} min")
        except ScienceError as error:
            note(f"{trip.name}: left out: {error}")
    found = identify(evidences, vehicle)
    say(asdict(found), as_json, text_of(found))


def trip_evidences(recording: Recording, vehicle: Vehicle, roads: RoadElevation | None) -> list[RoadLoadEvidence]:
    """Return what a trip says, by each model of the engine it has the measurements for."""
    from typing import get_args

    from app.science.observer.observe import observe
    from app.science.roadload.evidence import Model, trip_evidence
    from app.science.roadload.windows import windows

    steady = windows(observe(recording, vehicle, elevation=roads), vehicle, recording)
    found = [trip_evidence(steady, vehicle, model) for model in get_args(Model)]
    return [one for one in found if one is not None]


def text_of(found: RoadLoad) -> str:
    """Say what was found to people."""
    rows = [["", "file", "driving", "sd", "unit", "told by driving"]]
    for label, one, unit in (
        ("mass", found.mass_kg, "kg"),
        ("C_d·A", found.cd_area_m2, "m²"),
        ("C_rr", found.crr, ""),
    ):
        known = "yes" if one.identified else "no"
        rows.append([label, f"{one.file:.5g}", f"{one.value:.5g}", f"{one.sd:.2g}", unit, known])
    lines = [table(rows)]
    if found.model is not None:
        lines += [
            f"{found.hours:.1f} h of steady driving, {found.driving_windows} windows in gear, "
            f"{found.coasting_windows} coasting; engine's force from {found.model}",
            f"C_d·A for the mass given: ± {found.cd_area_sd_given_mass_m2:.2g} m²; "
            f"correlation with C_rr {found.correlation:.2f}",
            table(
                [
                    ["rests on", *(share.source for share in found.crr.shares)],
                    ["  C_d·A", *(f"{share.share:.0%}" for share in found.cd_area_m2.shares)],
                    ["  C_rr", *(f"{share.share:.0%}" for share in found.crr.shares)],
                ]
            ),
        ]
    if found.levels is not None:
        lines.append(f"efficiency of all driving: {found.levels.before:.1%} before, {found.levels.after:.1%} after")
        if (best := found.levels.best) is not None:
            lines.append(f"best point, near {best.rpm:.0f} rpm: {best.before:.1%} before, {best.after:.1%} after")
    return "\n".join([*lines, *found.reasons, *found.warnings])
