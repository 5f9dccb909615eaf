"""Formulas through a car's map over REST: coefficients, figures, files."""

from __future__ import annotations

from typing import Annotated, Any

from fastapi import APIRouter, Depends, Query, Request, Response

from app.answers import attachment, large_json
from app.cars import service as cars
from app.edge import OpenResources, ReadSession
from app.maps.fitting import MEDIA_TYPES, FitFigureName, FitFormatName, described, draw_fit, export_fits
from app.maps.routes import TheMap, ThemeName
from app.schemas import Id
from app.science.engine.fitting.cells import Target
from app.science.engine.fitting.family import FitRequest, Remedy

router = APIRouter(prefix="/cars/{car_id}/maps/{version}/fits", tags=["maps"])


def asked_for(
    target: Annotated[Target, Query(description="Efficiency, its inverse, or fuel power in watts.")] = "eta",
    degree: Annotated[int | None, Query(ge=2, le=4, description="Highest power of one variable; else all.")] = None,
    terms: Annotated[str, Query(max_length=300, description="Own terms instead, such as 1,w,T,w2T.")] = "",
    remedy: Annotated[
        Remedy, Query(description="A border of no efficiency (eta only), cut off where η rises, or where to drive.")
    ] = "none",
    weighted: Annotated[bool, Query(description="Count a cell by how well its mean is known.")] = False,
) -> FitRequest:
    """Return which formulas are asked for."""
    words = tuple(word.strip() for word in terms.split(",")) if terms.strip() else ()
    return FitRequest(target, None if words else degree, words, remedy, weighted)


Asked = Annotated[FitRequest, Depends(asked_for)]
FormulaName = Annotated[str, Query(max_length=80, description="Name of a formula, or `proposed`.")]


@router.get("", response_model=dict[str, Any])
def show_fits(request: Request, opened: OpenResources, found: TheMap, asked: Asked) -> Response:
    """Give polynomials, and for fuel power a Willans model, through the map: coefficients, errors, best point, gaps."""
    return large_json(request, described(opened.blobs, found, asked))


@router.get("/figures/{name}", response_model=dict[str, Any])
def draw_fits(
    request: Request,
    opened: OpenResources,
    found: TheMap,
    name: FitFigureName,
    asked: Asked,
    formula: FormulaName = "proposed",
    theme: ThemeName = "light",
) -> Response:
    """Give a figure of one formula as Plotly draws it: contours, residuals, or fuel power over torque."""
    return large_json(request, draw_fit(opened.blobs, found, asked, name, formula, theme))


@router.get("/export", response_class=Response)
def save_fits(
    session: ReadSession,
    opened: OpenResources,
    car_id: Id,
    found: TheMap,
    asked: Asked,
    form: Annotated[FitFormatName, Query(alias="format")] = "json",
) -> Response:
    """Give the formulas as a file to save; `engine` is the engine of a drive problem, φ in Table 4.1's order."""
    title = f"{cars.get(session, car_id).name}, map {found.version}, {'engine' if form == 'engine' else asked.target}"
    data = export_fits(opened.blobs, found, asked, form)
    return attachment(data, f"{title}.{'csv' if form == 'csv' else 'json'}", MEDIA_TYPES[form])
