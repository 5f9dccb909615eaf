"""Maps as files to save."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Literal

from app.exports.map_image import map_image
from app.exports.map_table import map_csv
from app.maps.documents import efficiency_map
from app.maps.models import MapVersion
from app.storage.blobs import Blobs

FormatName = Literal["json", "csv", "png", "svg"]

MEDIA_TYPES: Mapping[FormatName, str] = {
    "json": "application/json",
    "csv": "text/csv; charset=utf-8",
    "png": "image/png",
    "svg": "image/svg+xml",
}


def export(blobs: Blobs, found: MapVersion, form: FormatName, title: str) -> bytes:
    """Return a map as a file; raises `TooLittleData` when there is nothing to draw."""
    match form:
        case "json":
            return blobs.get(found.document_key)
        case "csv":
            return map_csv(efficiency_map(blobs, found))
        case "png" | "svg":
            return map_image(efficiency_map(blobs, found), title=title, form=form)
