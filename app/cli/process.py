"""``./ponthy process``: files in, states and efficiency map out; no server, no database."""

from __future__ import annotations

from enum import StrEnum
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from app.cli.inputs import InputFormat
from app.cli.options import AsJson
from app.cli.output import say

if TYPE_CHECKING:
    from app.science.observer.tuning import Tuning

SENSORS = ("gps", "dem", "acc", "vss", "inj")


class Filter(StrEnum):
    """Filters of the observer."""

    EKF = "ekf"
    RK4_EKF = "rk4-ekf"
    DD_EKF = "dd-ekf"
    SR_EKF = "sr-ekf"
    UKF = "ukf"
    SR_UKF = "sr-ukf"
    AEKF = "aekf"


def left_out(text: str) -> str:
    """Check the sensors of ``--without``."""
    unknown = [name for name in text.split(",") if name and name not in SENSORS]
    if unknown:
        raise typer.BadParameter(f"{', '.join(unknown)}: sensors that can be left out are {', '.join(SENSORS)}")
    return text


def tuning_name(text: str) -> str:
    """Check that ``--tuning`` names a preset or a file."""
    from app.science.observer.tuning import PRESETS

    if text not in PRESETS and not Path(text).is_file():
        raise typer.BadParameter(f"{text!r} is neither a file nor one of {', '.join(PRESETS)}")
    return text


def process(
    files: Annotated[list[Path], typer.Argument(exists=True, dir_okay=False, help="Logger images or signals tables.")],
    car: Annotated[Path, typer.Option(exists=True, dir_okay=False, help="XML of the car.")],
    out: Annotated[Path, typer.Option(file_okay=False, help="Folder to write to; made when it is missing.")],
    filter_name: Annotated[Filter, typer.Option("--filter", help="Filter of the observer.")] = Filter.EKF,
    smooth: Annotated[bool, typer.Option("--smooth/--no-smooth", help="Run the fixed-interval smoother.")] = True,
    tuning: Annotated[
        str, typer.Option(callback=tuning_name, help="default, thesis-2010 or a tuning file (JSON).")
    ] = "default",
    without: Annotated[str, typer.Option(callback=left_out, help=f"Leave sensors out: {','.join(SENSORS)}.")] = "",
    form: Annotated[InputFormat, typer.Option("--format", help="What the files hold.")] = InputFormat.AUTO,
    elevation: Annotated[
        Path | None,
        typer.Option(exists=True, dir_okay=False, help="Elevation table; else elevation.csv beside the first file."),
    ] = None,
    mapping: Annotated[
        Path | None, typer.Option(exists=True, dir_okay=False, help="Names and scales of foreign columns (JSON).")
    ] = None,
    load_kg: Annotated[float, typer.Option(min=0.0, max=5000.0, help="Driver and things, kg.")] = 75.0,
    as_json: AsJson = False,
) -> None:
    """Turn measurements into states and a map.

    Needs no server and no database. Writes states.parquet (further trips: states-2.parquet and so on),
    operating_points.parquet, map.json and summary.json.
    """
    from app.cli.pipeline import Choices, run
    from app.cli.reports import process_text
    from app.science.observer.tuning import PRESETS

    chosen = PRESETS.get(tuning) or tuning_of_file(Path(tuning))
    choices = Choices(
        car=car,
        filter=filter_name.value,
        smooth=smooth,
        tuning=chosen,
        without=frozenset(name for name in without.split(",") if name),
        form=form,
        elevation=elevation or beside(files[0]),
        mapping=mapping,
        load_kg=load_kg,
    )
    summary = run(files, choices, out)
    say(summary, as_json, process_text(summary, out))


def tuning_of_file(path: Path) -> Tuning:
    """Read a tuning file; what is wrong with it is said with its name."""
    from app.science.errors import TuningError
    from app.science.observer.tuning import tuning_from_json

    try:
        return tuning_from_json(path.read_bytes(), path.stem)
    except TuningError as error:
        raise TuningError(f"{path.name}: {error}") from None


def beside(file: Path) -> Path | None:
    """Return the elevation table that lies beside a file, if one does."""
    table = file.parent / "elevation.csv"
    return table if table.is_file() else None
