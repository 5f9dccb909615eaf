"""Shapes of the maps as the API shows them."""

from __future__ import annotations

from typing import Any

from pydantic import ConfigDict

from app.schemas import Document, Moment

MAP_EXAMPLE: dict[str, Any] = {
    "car_id": "6f1c2f0b8d8e4a0f9a52f1b6c0de0003",
    "version": 14,
    "cells": 912,
    "trusted_cells": 636,
    "points": 1204511,
    "trips": 14,
    "best": {"efficiency": 0.38, "rpm": 3850.0, "nm": 93.0, "sd": 0.012, "bsfc_gpkwh": 221.0},
    "provenance": {"code_version": "0.1.0+3f9d2b61c0aa"},
    "created_at": "2026-03-01T08:12:00Z",
}


class MapView(Document):
    """One immutable version of a car's efficiency map, in short. ``best`` is its most efficient well supported cell."""

    model_config = ConfigDict(from_attributes=True, json_schema_extra={"example": MAP_EXAMPLE})

    car_id: str
    version: int
    cells: int
    trusted_cells: int
    points: int
    trips: int
    best: dict[str, float | None] | None
    provenance: dict[str, Any]
    created_at: Moment
