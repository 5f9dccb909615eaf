"""The document of a map, which holds all of it."""

from __future__ import annotations

import json
from typing import Any

from app.maps.models import MapVersion
from app.science.engine.document import read_map_document
from app.science.engine.efficiency_map import EfficiencyMap
from app.storage.blobs import Blobs


def document(blobs: Blobs, found: MapVersion) -> dict[str, Any]:
    """Return a map as the document others read."""
    content: dict[str, Any] = json.loads(blobs.get(found.document_key))
    return content


def efficiency_map(blobs: Blobs, found: MapVersion) -> EfficiencyMap:
    """Return a map as the science knows it."""
    return read_map_document(document(blobs, found))
