"""``./ponthy score``: a trip beside the best drive over its own road."""

from __future__ import annotations

import json
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from app.cli.options import AsJson
from app.cli.output import note, say, table

if TYPE_CHECKING:
    from app.science.eco.result import Acceleration, TripScore
    from app.science.progress import Progress

KMH = 3.6
TELL_EVERY = 0.1


def score(
    folder: Annotated[Path, typer.Argument(metavar="DIR", exists=True, file_okay=False, help="What process wrote.")],
    car: Annotated[Path, typer.Option(exists=True, dir_okay=False, help="XML of the car.")],
    map_file: Annotated[
        Path | None, typer.Option("--map", exists=True, dir_okay=False, help="The car's map; else DIR/map.json.")
    ] = None,
    trip: Annotated[int, typer.Option(min=1, help="Which of the folder's trips.")] = 1,
    along: Annotated[
        Path | None, typer.Option(dir_okay=False, help="Write driven and best drive along the road here (Parquet).")
    ] = None,
    load_kg: Annotated[float, typer.Option(min=0.0, max=5000.0, help="Driver and things, kg.")] = 75.0,
    as_json: AsJson = False,
) -> None:
    """Say how much less a trip could have taken over its own road, limits, stops and times.

    Where it was lost, what to do, and each acceleration beside Pontryagin's.
    """
    from app.cli.tables import write_columns
    from app.imports.results import read_states
    from app.science.eco.score import score_trip
    from app.science.vehicle.xml import read_vehicle

    states = folder / ("states.parquet" if trip == 1 else f"states-{trip}.parquet")
    if not states.is_file():
        raise typer.BadParameter(f"{states} is missing; ./ponthy process writes it")
    document = read_map(map_file or folder / "map.json")
    vehicle = read_vehicle(car.read_bytes(), load_kg=load_kg)
    found = score_trip(read_states(states.read_bytes()), vehicle, document, progress=telling())
    if along is not None:
        write_columns(along, found.along.columns())
    say(found.document(), as_json, text_of(found))


def read_map(path: Path) -> Any:
    """Read ``map.json``; a file that is none is an error of the call."""
    try:
        return json.loads(path.read_text(encoding="utf-8"))
    except (OSError, json.JSONDecodeError, UnicodeDecodeError) as error:
        raise typer.BadParameter(f"{path} is no map.json: {error}") from error


def telling() -> Progress:
    """Return a progress that writes a line for every tenth."""
    told = 0.0

    def tell(share: float) -> None:
        nonlocal told
        if share >= told + TELL_EVERY or share >= 1.0 > told:
            told = share
            note(f"{100.0 * share:.0f} %")

    return tell


def text_of(found: TripScore) -> str:
    """Return a score as people read it."""
    parts = [["where it was lost", "litres", "%"]]
    parts += [[TITLES[part.name], f"{part.litres:.3f}", f"{part.percent:.1f}"] for part in found.parts]
    rows = [["driving style", "energy used, kJ", "difference"]]
    rows += [[row.style, f"{row.energy_kj:.1f}", _percent(row.percent)] for row in found.table]
    lines = [
        f"score {found.score.value:.0f} ± {found.score.sd:.0f}: {found.scored_m / 1000.0:.1f} km could have taken "
        f"{found.saved_l.value:.3f} ± {found.saved_l.sd:.3f} l less "
        f"({found.saved_percent.value:.1f} ± {found.saved_percent.sd:.1f} %)" + _whose(found),
        table(parts),
        "\n".join(f"- {line}" for line in found.advice),
        table(rows) if found.table else "",
        table([HEADS, *(_row(one) for one in found.accelerations)]) if found.accelerations else "",
        *(f"warning: {line}" for line in found.warnings),
    ]
    return "\n\n".join(line for line in lines if line)


def _whose(found: TripScore) -> str:
    """Say whose litres these are where none were measured."""
    if found.fuel_measured:
        return ""
    return (
        "; litres by the car's map" if found.engine == "map" else "; litres by an ordinary engine, none were measured"
    )


TITLES = {
    "braking": "braked away",
    "air": "faster through the air",
    "working_points": "engine off its best working points",
    "rolling_idle": "idling while the car rolled",
    "rest": "not explained",
}
HEADS = ["at, s", "km/h", "driven", "style", "kJ", "any time, kJ", "", "same time, kJ", ""]


def _row(one: Acceleration) -> list[str]:
    return [
        f"{one.from_s:.0f}",
        f"{KMH * one.from_mps:.0f} to {KMH * one.to_mps:.0f}",
        f"{one.time_s:.1f} s, {one.distance_m:.0f} m",
        one.style,
        f"{one.driven_j / 1000.0:.0f}",
        "-" if one.free_j is None else f"{one.free_j / 1000.0:.0f}",
        _percent(one.free_percent),
        "-" if one.same_time_j is None else f"{one.same_time_j / 1000.0:.0f}",
        _percent(one.same_time_percent),
    ]


def _percent(value: float | None) -> str:
    return "-" if value is None else f"{value:+.1f} %".replace("-", "−")
