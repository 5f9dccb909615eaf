"""``./ponthy drive``: a drive problem solved, with its certificate."""

from __future__ import annotations

import json
from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from app.cli.drive_front import drive_front
from app.cli.options import AsJson
from app.cli.output import say, table

if TYPE_CHECKING:
    from app.science.fields import Fields


def drive(
    problem_file: Annotated[Path, typer.Argument(metavar="PROBLEM.json", exists=True, dir_okay=False)],
    front: Annotated[
        str | None, typer.Option(metavar="EMISSION", help="Pareto front against an emission with a map, or time.")
    ] = None,
    points: Annotated[int, typer.Option(min=2, max=100, help="Drives of the front.")] = 9,
    against: Annotated[str, typer.Option(metavar="EMISSION", help="The front's other axis.")] = "fuel",
    method: Annotated[
        list[str] | None, typer.Option("--method", help="Solve by this method; with --compare one of those compared.")
    ] = None,
    compare: Annotated[
        bool, typer.Option("--compare", help="Solve by all methods and show them side by side.")
    ] = False,
    penalty: Annotated[
        float | None, typer.Option("--penalty", min=0.0, help="First weight of a penalty in the place of state limits.")
    ] = None,
    as_json: AsJson = False,
) -> None:
    """Find how to drive on the least fuel, and how one knows.

    The problem's names stand in docs/driving.md. An engine can be a map's: {"map": "map.json"}, its path as seen from
    the problem's folder.
    """
    from app.cli.drive_methods import compared, rows_in_words, solved
    from app.science.optimal.reading import read_problem

    def look_up(engine: Fields) -> Mapping[str, Any]:
        return map_engine(engine, problem_file.parent)

    posed = read_document(problem_file)
    if front is not None:
        drive_front(posed, front, points, against, look_up, as_json)
        return
    problem = read_problem(posed, look_up)
    if compare:
        table_of = compared(problem, method)
        say(table_of, as_json, rows_in_words(table_of))
        return
    document = solved(problem, method, penalty)
    say(document, as_json, words(document))


def map_engine(engine: Fields, folder: Path) -> Mapping[str, Any]:
    """Return the engine of a map's file."""
    from app.science.fields import ProblemError, shown
    from app.science.optimal.from_map import engine_of_map

    name = engine.get("map")
    if not isinstance(name, str) or not (folder / name).is_file():
        raise ProblemError(engine.path("map"), f"{shown(name)} is not the path of a map.json.")
    return engine_of_map(read_document(folder / name), engine)


def read_document(path: Path) -> Any:
    """Read a file of JSON; one that is none is an error of the call."""
    try:
        return json.loads(path.read_text(encoding="utf-8"))
    except (json.JSONDecodeError, UnicodeDecodeError) as error:
        raise typer.BadParameter(f"{path} is not JSON: {error}") from error


def words(document: Mapping[str, Any]) -> str:
    """Return an answer as a short table, advice and warnings."""
    certificate = document.get("certificate") or {}
    rows = [["", "", ""]]
    for name, unit in UNITS.items():
        value = document.get(name)
        if isinstance(value, float):
            rows.append([name.rsplit("_", 1)[0].replace("_", " "), f"{value:.7g}", unit])
    rows += [["first", str(document["first"]), ""]] if document.get("first") else []
    gears, speeds = document.get("gears") or [], document.get("switch_speeds_mps") or []
    rows += [["gears", short([str(gear) for gear in gears]), ""]] if gears else []
    rows += [[name, f"{grams:.6g}", "g"] for name, grams in document.get("emissions_g", {}).items()]
    rows += [["changes at", short([f"{v:.4g}" for v in speeds]), "m/s"]] if speeds else []
    lines = [table(rows[1:]), *(f"- {line}" for line in document.get("advice", []))]
    if certificate:
        other = certificate["independent"]
        gap = f"; gap {other['relative_gap']:.1e} to {other['method']}" if other else ""
        lines.append(
            f"{certificate['verdict']}: H drifts by {certificate['hamiltonian_drift_w']:.2g} W, the best other control "
            f"is at {certificate['max_h_minus_mu_w']:.2g} W{gap}"
        )
        lines += certificate.get("notes", [])
    return "\n".join([*lines, *(f"warning: {line}" for line in document.get("warnings", []))])


def short(items: list[str]) -> str:
    """Return a list as it fits on a line: of a long one its beginning and how many it has."""
    if len(items) <= MOST_SHOWN:
        return ", ".join(items)
    return f"{', '.join(items[:MOST_SHOWN])}, … ({len(items)} in all)"


MOST_SHOWN = 12
UNITS = {"fuel_energy_j": "J", "time_s": "s", "switch_time_s": "s", "distance_m": "m", "multiplier_w": "W"}
