"""Formulas through a stored map, made on request and remembered for a while."""

from __future__ import annotations

import json
from collections.abc import Mapping
from functools import lru_cache
from typing import Any, Literal

from app.exports.formulas import engine_block, fits_csv, fits_document
from app.figures.fit_contour import fit_contour_figure
from app.figures.fit_frame import fit_frame
from app.figures.fit_load import fit_load_figure
from app.figures.fit_residuals import fit_residuals_figure
from app.figures.theme import Json, theme_named
from app.maps.models import MapVersion
from app.science.engine.document import read_map_document
from app.science.engine.fitting.family import FitRequest, MapFits, fit_map
from app.storage.blobs import Blobs

FitFigureName = Literal["contour", "residuals", "load"]
FitFormatName = Literal["json", "csv", "engine"]
REMEMBERED = 16

MEDIA_TYPES: Mapping[FitFormatName, str] = {
    "json": "application/json",
    "csv": "text/csv; charset=utf-8",
    "engine": "application/json",
}


def fits_of(blobs: Blobs, found: MapVersion, request: FitRequest) -> MapFits:
    """Return the formulas through a map; raises `FitError` when it doesn't carry them."""
    return _fits(blobs, found.document_key, request)


@lru_cache(maxsize=REMEMBERED)
def _fits(blobs: Blobs, document_key: str, request: FitRequest) -> MapFits:
    """Fit a stored document, which never changes."""
    return fit_map(read_map_document(json.loads(blobs.get(document_key))), request)


def described(blobs: Blobs, found: MapVersion, request: FitRequest) -> dict[str, Any]:
    """Return the formulas with all their numbers."""
    about = {"car_id": found.car_id, "version": found.version}
    return about | fits_document(fits_of(blobs, found, request))


def draw_fit(
    blobs: Blobs, found: MapVersion, request: FitRequest, name: FitFigureName, formula: str, theme: str
) -> Json:
    """Return a figure of one of the formulas, in the axes and colours that all of them share."""
    fits = fits_of(blobs, found, request)
    one, look = fits.named(formula), theme_named(theme)
    match name:
        case "contour":
            return fit_contour_figure(fits, one, fit_frame(fits), look)
        case "residuals":
            return fit_residuals_figure(fits, one, fit_frame(fits), look)
        case "load":
            return fit_load_figure(fits, one, look)


def export_fits(blobs: Blobs, found: MapVersion, request: FitRequest, form: FitFormatName) -> bytes:
    """Return the formulas as a file, or the engine of a drive problem by φ with Table 4.1's terms."""
    if form == "csv":
        return fits_csv(fits_of(blobs, found, request))
    if form == "json":
        document = described(blobs, found, request)
    else:
        weighted = request.weighted
        phi, fuel = (fits_of(blobs, found, FitRequest(t, 2, weighted=weighted)) for t in ("phi", "p_in"))
        document = engine_block(phi, fuel)
    return json.dumps(document, indent=2, ensure_ascii=False, allow_nan=False).encode()
