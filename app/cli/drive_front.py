"""``./ponthy drive --front``: what is traded for fuel, as a table."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import TYPE_CHECKING, Any

from app.cli.output import note, say, table

if TYPE_CHECKING:
    from app.science.fields import Fields

MOST_GEARS = 8
UNITS = {"fuel_energy_j": ("fuel", "kJ", 1e-3), "weighted_energy_j": ("cost", "kJ", 1e-3), "time_s": ("time", "s", 1.0)}


def drive_front(
    document: object,
    emission: str,
    points: int,
    against: str,
    resolve_map: Callable[[Fields], Mapping[str, Any]],
    as_json: bool,
) -> None:
    """Print a Pareto front."""
    from app.science.optimal.costs.front import pareto

    told = 0

    def tell(share: float) -> None:
        nonlocal told
        if int(share * points) > told:
            told = int(share * points)
            note(f"{told} of {points} drives")

    found = pareto(document, emission, points, tell, against=against, resolve_map=resolve_map).document()
    say(found, as_json, words(found))


def words(front: Mapping[str, Any]) -> str:
    """Return a front as a table with its warnings."""
    timed = front["y_axis"] != "time_s"
    head = [_axis(front[axis]) for axis in ("x_axis", "y_axis")]
    rows = [[*head, *(["time s"] if timed else []), "gears", "verdict"]]
    for point in front["points"]:
        values = (_shown(front[f"{axis}_axis"], point[axis]) for axis in ("x", "y"))
        time = [f"{point['time_s']:.2f}"] if timed else []
        rows.append([*values, *time, short(point["gears"]), point["verdict"]])
    return "\n".join([table(rows), *(f"warning: {line}" for line in front["warnings"])])


def short(gears: list[int]) -> str:
    """Return gears in a row; of many changes their number."""
    if len(gears) > MOST_GEARS:
        return f"{len(gears)} phases"
    return " ".join(str(gear) for gear in gears) or "-"


def _axis(name: str) -> str:
    title, unit, _ = UNITS.get(name, (name.removesuffix("_g"), "g", 1.0))
    return f"{title} {unit}"


def _shown(name: str, value: float) -> str:
    return f"{value * UNITS.get(name, ('', '', 1.0))[2]:.6g}"
