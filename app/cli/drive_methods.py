"""Methods of ``./ponthy drive`` by name, and all of them side by side."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

import typer

from app.cli.output import note, table

if TYPE_CHECKING:
    from app.science.optimal.problem import Problem

PER_CENT = 100.0


def solved(problem: Problem, names: list[str] | None, penalty: float | None) -> dict[str, Any]:
    """Return the answer of the usual method, or of the one that is named."""
    if not names and penalty is None:
        from app.science.optimal.solve import solve

        return solve(problem).document()
    from app.science.optimal.methods.registry import solve_by
    from app.science.optimal.methods.running import Options

    if not names or len(names) > 1:
        raise typer.BadParameter("name one --method; several are for --compare.")
    return solve_by(problem, known(names)[0], Options(penalty)).document()


def compared(problem: Problem, names: list[str] | None) -> dict[str, Any]:
    """Return the comparison of all methods, or of those that are named."""
    from app.science.optimal.methods.comparing import compare

    shares: list[int] = []

    def tell(share: float) -> None:
        if not shares or int(10 * share) > shares[-1]:
            shares.append(int(10 * share))
            note(f"{PER_CENT * share:.0f} %")

    return compare(problem, known(names) if names else None, tell).document()


def known(names: list[str]) -> list[str]:
    """Refuse words that name no method."""
    from app.science.fields import nearest
    from app.science.optimal.methods.names import NAMES

    for name in names:
        if name not in NAMES:
            raise typer.BadParameter(
                f"{name!r} names no method{nearest(name, tuple(NAMES))} There are {', '.join(NAMES)}."
            )
    return names


def rows_in_words(document: Mapping[str, Any]) -> str:
    """Return a comparison as a table, and below it why some methods have no row."""
    rows = [["method", "fuel J", "time s", "error", "ms", "says"]]
    silent = []
    for row in document["rows"]:
        if row["reason"]:
            silent.append(f"{row['name']}: {row['reason']}")
            continue
        spent = "" if row["milliseconds"] is None else f"{row['milliseconds']:.4g}"
        rows.append(
            [
                row["name"],
                "" if row["fuel_energy_j"] is None else f"{row['fuel_energy_j']:.7g}",
                "" if row["time_s"] is None else f"{row['time_s']:.6g}",
                "" if row["relative_error"] is None else f"{row['relative_error']:.1e}",
                f"{spent} (first)" if row["first_call"] else spent,
                row["verdict"],
            ]
        )
    return "\n".join([table(rows), *silent])
