"""Where the results of trips lie among the files."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from app.trips.models import Trip

STATES = "states.parquet"
POINTS = "operating_points.parquet"
ROAD_LOAD = "road_load.parquet"
ROAD_LOAD_EVIDENCE = "road_load.json"
INNOVATIONS = "innovations.parquet"
EVIDENCE = "calibration.json"
OBSERVABILITY = "observability.json"
TORQUES = "torques.json"
IDLE = "idle"
"""Under this name a trip's summary keeps what it adds to the engine's idle."""


def decoded_root(fleet_id: str) -> str:
    """Return where the decoded uploads of a fleet lie, one folder each."""
    return f"fleets/{fleet_id}/decoded"


def results_root(fleet_id: str) -> str:
    """Return where the results of a fleet's trips lie, one folder each."""
    return f"fleets/{fleet_id}/trips"


def decoded_folder(trip: Trip, key: str) -> str:
    """Return where the segments of a decoded upload lie; all its trips share them."""
    return f"{decoded_root(trip.fleet_id)}/{trip.upload_id}/{key}"


def shown_folders(trip: Trip) -> set[str]:
    """Return where the finished work lies that a trip refers to."""
    decoded = {decoded_folder(trip, trip.decode_key)} if trip.decode_key else set()
    return decoded | ({f"{results_folder(trip)}/{trip.observe_key}"} if trip.observe_key else set())


def recording_file(trip: Trip, key: str, segment: int) -> str:
    """Return where the measurements of a segment lie."""
    return f"{decoded_folder(trip, key)}/{segment}.parquet"


def report_file(trip: Trip, key: str) -> str:
    """Return where the decode report of an upload lies; it is written last, so a folder that has it is complete."""
    return f"{decoded_folder(trip, key)}/report.json"


def results_folder(trip: Trip) -> str:
    """Return where all results of a trip lie."""
    return f"{results_root(trip.fleet_id)}/{trip.id}"


def result_file(trip: Trip, key: str, name: str) -> str:
    """Return where one file of a run of the observer lies."""
    return f"{results_folder(trip)}/{key}/{name}"


def options_of(options: Mapping[str, Any]) -> dict[str, Any]:
    """Return how a trip is to be observed, with every choice said."""
    return {
        "filter": options.get("filter", "ekf"),
        "tuning": options.get("tuning", "default"),
        "smooth": options.get("smooth", True),
        "without": sorted(options.get("without", ())),
        "carry_over": options.get("carry_over", True),
    }
