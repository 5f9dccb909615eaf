"""``./ponthy bench``: the benchmarks by name."""

from __future__ import annotations

from dataclasses import asdict
from importlib import import_module
from typing import TYPE_CHECKING, Annotated

import typer

from app.cli.options import AsJson
from app.cli.output import note, say, table

if TYPE_CHECKING:
    from app.cli.bench.figure import Figure

BENCHMARKS = {
    "decode": "app.cli.bench.decoding",
    "observer": "app.cli.bench.observer",
    "accuracy": "app.cli.bench.accuracy",
    "filters": "app.cli.bench.filters",
    "carry-over": "app.cli.bench.carry_over",
    "endurance": "app.cli.bench.endurance",
    "consistency": "app.cli.bench.nees",
    "degraded": "app.cli.bench.degraded",
    "observability": "app.cli.bench.telling",
    "roadload": "app.cli.bench.road_loads",
    "health": "app.cli.bench.car_health",
    "engines": "app.cli.bench.engines",
    "growing": "app.cli.bench.growing",
    "pipeline": "app.cli.bench.whole_pipeline",
    "fits": "app.cli.bench.fitting",
    "decimate": "app.cli.bench.decimation",
    "upload": "app.cli.bench.uploading",
    "drive": "app.cli.bench.driving",
    "battery": "app.cli.bench.battery",
    "battery-report": "app.cli.bench.battery_report",
}
"""Module of each benchmark; its ``measure()`` returns figures."""


def known(names: list[str]) -> list[str]:
    """Check the names of benchmarks."""
    unknown = [name for name in names if name not in BENCHMARKS]
    if unknown:
        raise typer.BadParameter(f"{', '.join(unknown)}: benchmarks are {', '.join(BENCHMARKS)}")
    return names


def bench(
    names: Annotated[
        list[str] | None,
        typer.Argument(callback=lambda names: known(names or []), help=f"{', '.join(BENCHMARKS)}; all."),
    ] = None,
    as_json: AsJson = False,
) -> None:
    """Measure how fast this machine is.

    Each figure stands beside a plain way to do the same, taken in the same run, and the ratio of both.
    """
    figures: dict[str, list[Figure]] = {}
    for name in names or BENCHMARKS:
        note(f"measuring {name}")
        figures[name] = import_module(BENCHMARKS[name]).measure()
    document = {name: [asdict(one) | {"ratio": one.ratio} for one in found] for name, found in figures.items()}
    say(document, as_json, "\n\n".join(table(rows) for rows in tables(figures)))


def tables(figures: dict[str, list[Figure]]) -> list[list[list[str]]]:
    """Return the tables to print: a benchmark's own layout where it has one, all others in one table."""
    plain = [["figure", "ours", "reference", "unit", "ratio", "goal"]]
    own = []
    for name, found in figures.items():
        layout = getattr(import_module(BENCHMARKS[name]), "layout", None)
        if layout is None:
            plain += [row(one) for one in found]
        else:
            own.append(layout(found))
    return own if len(plain) == 1 else [plain, *own]


def row(one: Figure) -> list[str]:
    """Return a figure as a line of the table."""
    numbers = [f"{number:.4g}" for number in (one.value, one.reference)]
    return [f"{one.name} (against {one.reference_name})", *numbers, one.unit, f"{one.ratio:.3g}", one.goal or "-"]
