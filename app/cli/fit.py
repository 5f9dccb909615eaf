"""``./ponthy fit``: formulas through a map."""

from __future__ import annotations

import json
from enum import StrEnum
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from app.cli.options import AsJson
from app.cli.output import note, say, table

if TYPE_CHECKING:
    from app.science.engine.efficiency_map import EfficiencyMap
    from app.science.engine.fitting.family import Fitted, MapFits


class Target(StrEnum):
    """What a formula describes."""

    ETA = "eta"
    PHI = "phi"
    P_IN = "p_in"


class Remedy(StrEnum):
    """What is done about regions without data."""

    NONE = "none"
    BORDER = "border"
    CUT = "cut"
    DRIVE = "drive"


def fit(
    map_file: Annotated[Path, typer.Argument(metavar="MAP.json", exists=True, dir_okay=False)],
    target: Annotated[Target, typer.Option(help="Efficiency, its inverse, or fuel power in watts.")] = Target.ETA,
    degree: Annotated[
        int | None, typer.Option(min=2, max=4, help="Highest power of one variable; else all three.")
    ] = None,
    terms: Annotated[str | None, typer.Option(help="Own terms instead of a class, such as 1,w,T,w2T.")] = None,
    remedy: Annotated[
        Remedy, typer.Option(help="For empty regions: a border of no efficiency (eta only), or cut off where η rises.")
    ] = Remedy.NONE,
    weighted: Annotated[bool, typer.Option("--weighted", help="Count a cell by how well its mean is known.")] = False,
    as_json: AsJson = False,
) -> None:
    """Fit the thesis' formulas through an efficiency map and propose the simplest that is good enough.

    Engine speed is in rad/s, torque in Nm, fuel power in watts. A fit of the fuel power goes through the measured idle,
    where the map knows it, and has a Willans model beside it that is monotone and convex in torque.
    """
    from app.exports.formulas import fits_document
    from app.science.engine.fitting.family import FitRequest, fit_map

    words = tuple(terms.split(",")) if terms is not None else ()
    request = FitRequest(target.value, degree, words, remedy.value, weighted)
    fits = fit_map(read_map(map_file), request)
    answer: dict[str, Any] = fits_document(fits)
    for gap in fits.gaps:
        note(gap.words())
    for warning in fits.proposed.warnings:
        note(f"{fits.proposed.formula.terms.name}: {warning}")
    say(answer, as_json, f"{table([HEADS, *(line(one, fits) for one in fits.fits)])}\n\n{fits.why()}")


def read_map(path: Path) -> EfficiencyMap:
    """Read a ``map.json``; a file that is none is an error of the call."""
    from app.science.engine.document import read_map_document

    try:
        return read_map_document(json.loads(path.read_text(encoding="utf-8")))
    except json.JSONDecodeError as error:
        raise typer.BadParameter(f"{path} is not JSON: {error}") from error


HEADS = ["formula", "terms", "R²", "error left out, η", "best", "coefficients (ω rad/s, T Nm, P W)", ""]


def line(one: Fitted, fits: MapFits) -> list[str]:
    """Return a formula as a line of the table."""
    formula = one.formula
    parts = [f"{c:.5g}·{word}" for c, word in zip(formula.coefficients, formula.terms.words(), strict=True)]
    best = "-" if one.peak is None else f"{one.peak.efficiency:.3f} at {one.peak.rpm:.0f} rpm, {one.peak.nm:.0f} Nm"
    return [
        formula.terms.name,
        str(len(formula.terms.terms)),
        f"{formula.r_squared:.4f}",
        f"{formula.cross_validated_eta:.4f}",
        best,
        " + ".join(parts),
        "proposed" if one is fits.proposed else "",
    ]
