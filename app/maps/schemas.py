"""Shapes of the maps as the API shows them."""

from __future__ import annotations

from datetime import UTC, datetime
from typing import Annotated, Any

from pydantic import AfterValidator, ConfigDict, Field

from app.maps.rules import TorqueSource, Verdicts
from app.schemas import Document, Moment

MAP_EXAMPLE: dict[str, Any] = {
    "car_id": "6f1c2f0b8d8e4a0f9a52f1b6c0de0003",
    "version": 14,
    "cells": 912,
    "trusted_cells": 636,
    "points": 1204511,
    "trips": 14,
    "best": {
        "efficiency": 0.38,
        "rpm": 3850.0,
        "nm": 93.0,
        "sd": 0.012,
        "bsfc_gpkwh": 221.0,
        "rpm_low": 3525.0,
        "rpm_high": 4125.0,
        "nm_low": 87.0,
        "nm_high": 97.0,
    },
    "provenance": {"code_version": "0.1.0+3f9d2b61c0aa"},
    "changes": {"since": 13, "added": [{"trip_id": "6f1c2f0b8d8e4a0f9a52f1b6c0de0002", "name": "27 October"}]},
    "created_at": "2026-03-01T08:12:00Z",
}

RULES_EXAMPLE: dict[str, Any] = {
    "verdicts": "healthy",
    "smoothed_only": True,
    "torque_source": "both",
    "since": "2026-03-01T00:00:00Z",
    "until": None,
}


class MapView(Document):
    """One immutable version of a car's efficiency map, in short. ``best`` is its most efficient well supported cell.

    The cells from ``rpm_low`` to ``rpm_high`` and ``nm_low`` to ``nm_high`` are as good within 0.2 points.
    """

    model_config = ConfigDict(from_attributes=True, json_schema_extra={"example": MAP_EXAMPLE})

    car_id: str
    version: int
    cells: int
    trusted_cells: int
    points: int
    trips: int
    best: dict[str, float | None] | None
    provenance: dict[str, Any]
    changes: dict[str, Any] | None = Field(
        description="Since the version before: trips `added`, `removed` and `observed_anew`, the `level` as a factor "
        "with `level_sd`, and `changed_cells` of `common_cells`; null for the first."
    )
    created_at: Moment


def _in_utc(moment: datetime) -> datetime:
    return moment.replace(tzinfo=UTC) if moment.tzinfo is None else moment.astimezone(UTC)


Time = Annotated[datetime, AfterValidator(_in_utc)]
"""A moment; without a time zone it is in UTC."""


class RulesView(Document):
    """Which trips count in a car's map, besides those left out by hand."""

    model_config = ConfigDict(from_attributes=True, json_schema_extra={"example": RULES_EXAMPLE})

    verdicts: Verdicts = Field(description="`healthy` trips only, healthy and `doubtful` ones, or `all`.")
    smoothed_only: bool
    torque_source: TorqueSource = Field(description="Where the torque of a trip's points must come from.")
    since: Moment | None = Field(description="A trip must not have begun before.")
    until: Moment | None = Field(description="It must have begun before.")


class RulesChange(Document):
    """What is to be changed of the rules; what is left out stays."""

    model_config = ConfigDict(
        extra="forbid", json_schema_extra={"example": {"verdicts": "healthy", "since": "2026-03-01T00:00:00Z"}}
    )

    verdicts: Verdicts = "all"
    smoothed_only: bool = False
    torque_source: TorqueSource = "both"
    since: Time | None = None
    until: Time | None = None
