"""A trip as the thesis' set of MATLAB files (Sebesta 2010, App. C.1.3)."""

from __future__ import annotations

from collections.abc import Mapping
from contextlib import suppress
from io import BytesIO
from typing import Any

from app.exports.archive import file_stem, zip_bytes
from app.exports.kmz import trip_kmz
from app.science.errors import TooLittleData
from app.science.logger.recording import SIGNAL_UNITS, Recording
from app.science.observer.result import Observation

RECEIVER = ("lat_deg", "lon_deg", "alt_m", "hdop", "satellites", "utc_s", "heading_deg", "gnss_speed_mps")
ROAD = ("road_alt_m", "road_heading_deg")
HEADER_TEXT = b"MATLAB 5.0 MAT-file, written by Ponthy"
HEADER_BYTES = 116


def trip_mat_zip(observation: Observation, recording: Recording, *, name: str) -> bytes:
    """Pack the file set of one trip.

    ``<name>,data.mat`` holds every sensor but the receiver, ``<name>,extract.mat`` what the receiver said,
    ``<name>,results.mat`` the states, ``<name>,gps.txt`` the NMEA sentences and ``<name>,spd.kmz`` the trip for
    Google Earth. ``<name>,DEM.mat`` with altitude and heading of the road is there when the trip was matched to a
    road, the sentences and the KMZ when there are sentences and positions. A signal is a structure of ``t_s``,
    ``value`` and ``unit``.

    Parameters
    ----------
    observation : Observation
    recording : Recording
    name : str
        Of the trip.
    """
    stem = file_stem(name)
    sensors = [signal for signal in recording if signal not in RECEIVER and signal not in ROAD]
    files = {
        f"{stem},data.mat": mat_bytes(_signals(recording, sensors)),
        f"{stem},extract.mat": mat_bytes(_signals(recording, RECEIVER)),
        f"{stem},results.mat": mat_bytes(_results(observation)),
    }
    road = _signals(recording, ROAD)
    if road:
        files[f"{stem},DEM.mat"] = mat_bytes(road)
    if "nmea" in recording.texts:
        files[f"{stem},gps.txt"] = recording.texts["nmea"].encode(errors="replace")
    with suppress(TooLittleData):
        files[f"{stem},spd.kmz"] = trip_kmz(observation, name=name, started_at_utc_s=recording.started_at_utc_s)
    return zip_bytes(files)


def mat_bytes(variables: Mapping[str, Any]) -> bytes:
    """Write variables as a MAT file (version 5) whose bytes depend on nothing but them."""
    from scipy.io import savemat  # slow to load, and seldom needed by a server

    sink = BytesIO()
    savemat(sink, dict(variables), oned_as="column")  # the zip around it compresses
    content = sink.getvalue()  # the header begins with the date and the platform
    return HEADER_TEXT.ljust(HEADER_BYTES) + content[HEADER_BYTES:]


def _signals(recording: Recording, names: tuple[str, ...] | list[str]) -> dict[str, Any]:
    return {
        name: {"t_s": recording[name].t_s, "value": recording[name].value, "unit": SIGNAL_UNITS[name]}
        for name in names
        if name in recording
    }


def _results(observation: Observation) -> dict[str, Any]:
    """Return every column, and the totals in one structure."""
    o = observation
    totals = {
        "events": o.events,
        "duration_s": o.duration_s,
        "distance_m": o.distance_m,
        "fuel_energy_j": o.fuel_energy_j,
        "fuel_l": o.fuel_l,
        "filter": o.filter,
        "tuning": o.tuning,
        "smoothed": o.smoothed,
        "verdict": o.verdict,
    }
    return {**o.columns, "trip": totals}
