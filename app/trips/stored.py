"""The stored results of a trip as the science knows them."""

from __future__ import annotations

import json
from dataclasses import fields
from math import nan
from typing import Any, get_args

from app.errors import PonthyError
from app.imports.results import read_innovations, read_operating_points
from app.imports.signals import read_signals
from app.science.engine.points import OperatingPoints
from app.science.logger.recording import Recording
from app.science.observer.result import Innovations, Observation, Refusal, SensorConsistency, Verdict
from app.storage.blobs import Blobs
from app.trips.keys import INNOVATIONS, OBSERVABILITY, POINTS, TORQUES, recording_file, report_file, result_file
from app.trips.models import Trip
from app.trips.states import StatesTable, observe_key

SENSOR_FIELDS = {field.name for field in fields(SensorConsistency)}


def observation_of(blobs: Blobs, trip: Trip) -> Observation:
    """Return the stored result of a trip as the observer gave it."""
    with StatesTable(blobs, trip) as table:
        columns = table.columns(table.names)
    return Observation(
        columns=columns,
        innovations=innovations_of(blobs, trip),
        sensors=sensors_of(trip),
        verdict=_verdict(trip.verdict),
        reasons=tuple(trip.reasons),
        warnings=tuple(trip.warnings),
        events=int(trip.summary["events"]),
        duration_s=_number(trip.duration_s),
        distance_m=_number(trip.distance_m),
        fuel_energy_j=_number(trip.fuel_energy_j),
        fuel_l=_number(trip.fuel_l),
        filter=trip.filter or "",
        tuning=trip.tuning or "",
        smoothed=bool(trip.smoothed),
    )


def innovations_of(blobs: Blobs, trip: Trip) -> Innovations:
    """Return the stored innovations of a trip."""
    return read_innovations(blobs.get(result_file(trip, observe_key(trip), INNOVATIONS)))


def observability_of(blobs: Blobs, trip: Trip) -> dict[str, Any]:
    """Return what the sensors of a trip tell; raises `PonthyError` when an earlier version observed it."""
    try:
        document: dict[str, Any] = json.loads(blobs.get(result_file(trip, observe_key(trip), OBSERVABILITY)))
    except FileNotFoundError:
        text = "An earlier version observed this trip and did not ask what its sensors tell; run it again."
        raise PonthyError("not-told", text, 409) from None
    return document


def torques_of(blobs: Blobs, trip: Trip) -> dict[str, Any]:
    """Return the reported torque beside the car's motion; raises `PonthyError` where they were not compared."""
    try:
        document: dict[str, Any] = json.loads(blobs.get(result_file(trip, observe_key(trip), TORQUES)))
    except FileNotFoundError:
        text = (
            "The engine of this trip reports no torque while it drives the car, or an earlier version observed it. Run "
            "the trip again if it does."
        )
        raise PonthyError("no-reported-torque", text, 409) from None
    return document


def points_of(blobs: Blobs, trip: Trip) -> OperatingPoints:
    """Return the stored operating points of a trip."""
    return read_operating_points(blobs.get(result_file(trip, observe_key(trip), POINTS)))


def report_of(blobs: Blobs, trip: Trip) -> dict[str, Any]:
    """Return the decode report of a trip's upload; raises `PonthyError` when it isn't decoded yet."""
    if trip.decode_key is None:
        raise PonthyError("not-decoded", "This trip has not been decoded yet; its job tells how far it is.", 409)
    document: dict[str, Any] = json.loads(blobs.get(report_file(trip, trip.decode_key)))
    return document


def sensors_of(trip: Trip) -> tuple[SensorConsistency, ...]:
    """Return how well each sensor of a trip agreed."""
    return tuple(_sensor(row) for row in trip.consistency)


def _sensor(row: dict[str, Any]) -> SensorConsistency:
    """Return a sensor's row as the science knows it; an earlier version's rows say less."""
    known: dict[str, Any] = {
        name: nan if value is None else value for name, value in row.items() if name in SENSOR_FIELDS
    }
    known["episodes"] = tuple(Refusal(**episode) for episode in row.get("episodes", ()))
    return SensorConsistency(**known)


def recording_of(blobs: Blobs, trip: Trip) -> Recording:
    """Return the stored measurements of a trip that was decoded."""
    if trip.decode_key is None:
        raise ValueError("a trip that was observed has been decoded")
    return read_signals(blobs.get(recording_file(trip, trip.decode_key, trip.segment)), filename="recording.parquet")


def _number(value: float | None) -> float:
    return nan if value is None else value


def _verdict(name: str | None) -> Verdict:
    return next(verdict for verdict in get_args(Verdict) if verdict == name)
