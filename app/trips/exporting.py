"""Trips as files to save, made on request from their stored results."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Literal

from app.answers import FileFormat
from app.exports.csv import states_csv
from app.exports.geojson import trip_geojson
from app.exports.kmz import trip_kmz
from app.exports.mat import trip_mat_zip
from app.storage.blobs import Blobs
from app.trips.keys import STATES, result_file
from app.trips.models import Trip
from app.trips.states import observe_key
from app.trips.stored import observation_of, recording_of

FormatName = Literal["kmz", "csv", "parquet", "mat", "geojson"]


FORMATS: Mapping[FormatName, FileFormat] = {
    "kmz": FileFormat("kmz", "application/vnd.google-earth.kmz"),
    "csv": FileFormat("csv", "text/csv; charset=utf-8"),
    "parquet": FileFormat("parquet", "application/vnd.apache.parquet"),
    "mat": FileFormat("mat.zip", "application/zip"),
    "geojson": FileFormat("geojson", "application/geo+json"),
}


def export(blobs: Blobs, trip: Trip, form: FormatName) -> bytes:
    """Return a trip as a file.

    Raises
    ------
    PonthyError
        When the trip has no result yet.
    TooLittleData
        When the file is to show positions and none is known.
    """
    if form == "parquet":
        return blobs.get(result_file(trip, observe_key(trip), STATES))
    observation = observation_of(blobs, trip)
    started_at_utc_s = None if trip.started_at is None else trip.started_at.timestamp()
    match form:
        case "csv":
            return states_csv(observation)
        case "kmz":
            return trip_kmz(observation, name=trip.name, started_at_utc_s=started_at_utc_s)
        case "geojson":
            return trip_geojson(observation, name=trip.name, started_at_utc_s=started_at_utc_s)
        case "mat":
            return trip_mat_zip(observation, recording_of(blobs, trip), name=trip.name)
