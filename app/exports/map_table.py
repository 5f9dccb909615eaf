"""An efficiency map as JSON or CSV."""

from __future__ import annotations

import csv
import json
from collections.abc import Mapping
from io import StringIO
from typing import Any

from app.science.engine.document import map_document
from app.science.engine.efficiency_map import EfficiencyMap

COLUMNS = ("rpm", "nm", "n", "efficiency", "sd", "bsfc_gpkwh")


def map_json(efficiency_map: EfficiencyMap, provenance: Mapping[str, Any]) -> bytes:
    """Write ``map.json``."""
    return json.dumps(map_document(efficiency_map, provenance), allow_nan=False).encode()


def map_csv(efficiency_map: EfficiencyMap) -> bytes:
    """Write a line per occupied cell: its centre, points, efficiency, deviation and consumption.

    Efficiency and consumption are empty where the cell is not trusted.
    """
    text = StringIO(newline="")
    writer = csv.DictWriter(text, COLUMNS, lineterminator="\n")
    writer.writeheader()
    writer.writerows(map_document(efficiency_map, {})["cells"])
    return text.getvalue().encode()
