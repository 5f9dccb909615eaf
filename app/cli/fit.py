"""``./ponthy fit``: formulas through a map."""

from __future__ import annotations

import json
from enum import StrEnum
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from app.cli.options import AsJson
from app.cli.output import say, table

if TYPE_CHECKING:
    from app.science.engine.efficiency_map import EfficiencyMap
    from app.science.engine.fitting.polynomial import PolynomialFit


class Target(StrEnum):
    """What a formula describes."""

    ETA = "eta"
    PHI = "phi"
    P_IN = "p_in"


def fit(
    map_file: Annotated[Path, typer.Argument(metavar="MAP.json", exists=True, dir_okay=False)],
    target: Annotated[Target, typer.Option(help="Efficiency, its inverse, or fuel power in watts.")] = Target.ETA,
    degree: Annotated[int, typer.Option(min=2, max=4, help="Highest power of one variable.")] = 2,
    terms: Annotated[str | None, typer.Option(help="Own terms instead of a class, such as 1,w,T,w2T.")] = None,
    weighted: Annotated[bool, typer.Option("--weighted", help="Count a cell by how well its mean is known.")] = False,
    as_json: AsJson = False,
) -> None:
    """Fit the thesis' formulas through an efficiency map and propose the simplest that is good enough.

    Engine speed is in rad/s, torque in Nm, fuel power in watts.
    """
    from app.science.engine.fitting.polynomial import best_of, fit_chosen, fit_classes, trusted_cells

    efficiency_map = read_map(map_file)
    cells = trusted_cells(efficiency_map, weighted=weighted)
    if terms is None:
        fits = fit_classes(cells, target.value, degree)
    else:
        fits = (fit_chosen(cells, target.value, tuple(terms.split(","))),)
    best = best_of(fits)
    answer: dict[str, Any] = {"target": target.value, "cells": len(cells), "best": best.terms.name}
    answer["fits"] = [described(one, efficiency_map) for one in fits]
    say(answer, as_json, table([HEADS, *(line(one, one is best) for one in fits)]))


def read_map(path: Path) -> EfficiencyMap:
    """Read a ``map.json``; a file that is none is an error of the call."""
    from app.science.engine.document import read_map_document

    try:
        return read_map_document(json.loads(path.read_text(encoding="utf-8")))
    except json.JSONDecodeError as error:
        raise typer.BadParameter(f"{path} is not JSON: {error}") from error


HEADS = ["formula", "terms", "R²", "error left out, η", "coefficients (ω rad/s, T Nm, P W)", ""]


def line(one: PolynomialFit, is_best: bool) -> list[str]:
    """Return a formula as a line of the table."""
    parts = [f"{c:.5g}·{word}" for c, word in zip(one.coefficients, one.terms.words(), strict=True)]
    return [
        one.terms.name,
        str(len(one.terms.terms)),
        f"{one.r_squared:.4f}",
        f"{one.cross_validated_eta:.4f}",
        " + ".join(parts),
        "proposed" if is_best else "",
    ]


def described(one: PolynomialFit, efficiency_map: EfficiencyMap) -> dict[str, Any]:
    """Return a formula with all its numbers."""
    from dataclasses import asdict

    from app.science.engine.fitting.surface import peak_island

    return {
        "name": one.terms.name,
        "degree": one.terms.degree,
        "terms": [list(term) for term in one.terms.terms],
        "words": list(one.terms.words()),
        "coefficients": one.coefficients.tolist(),
        "sd": one.sd.tolist(),
        "r_squared": one.r_squared,
        "rmse": one.rmse,
        "cross_validated": one.cross_validated,
        "cross_validated_eta": one.cross_validated_eta,
        "peak": asdict(peak_island(one, efficiency_map)),
    }
