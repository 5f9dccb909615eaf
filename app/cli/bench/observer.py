"""Filter and smoother per event, against the same filter written with filterpy and dense NumPy matrices."""

from __future__ import annotations

import json
import subprocess
import sys

import numpy as np

from app.cli.bench.dense_observer import run_dense
from app.cli.bench.figure import Figure, best_seconds, timed
from app.cli.bench.virtual_hour import virtual_hour, virtual_hour_files
from app.imports.elevation import read_elevation
from app.science.logger.decode import decode_image
from app.science.observer.events import motion_events
from app.science.observer.motion import motion_model, observe_motion, start_state
from app.science.observer.observe import observe
from app.science.observer.timeline import build_timeline
from app.science.observer.tuning import DEFAULT
from app.science.roads.projection import LocalPlane

DENSE_EVENTS = 6000
DENSE_FROM = 20000
STEP_BYTES = 8 * 13 * 13


def measure() -> list[Figure]:
    """Return microseconds per measurement event of the whole observer and of its filter alone."""
    trip = virtual_hour()
    recording = decode_image(trip.image).recordings[0]
    elevation = read_elevation(trip.elevation_csv)
    count = observe(recording, trip.vehicle, elevation=elevation).events
    whole = best_seconds(lambda: observe(recording, trip.vehicle, elevation=elevation)) / count
    filtered = best_seconds(lambda: observe(recording, trip.vehicle, elevation=elevation, smooth=False)) / count

    timeline = build_timeline(recording, trip.vehicle)
    plane = LocalPlane(float(recording["lat_deg"].value[0]), float(recording["lon_deg"].value[0]))
    events = motion_events(recording, trip.vehicle, timeline, DEFAULT, plane, elevation)
    x0, variance0 = start_state(recording, trip.vehicle, timeline, plane)
    model = motion_model(trip.vehicle, DEFAULT)
    piece = events.between(DENSE_FROM, DENSE_FROM + DENSE_EVENTS)
    dense = timed(lambda: run_dense(piece, model, x0, variance0)) / len(np.unique(piece.t_s))
    nodes = int((events.kind == 0).sum())
    kernels = best_seconds(lambda: observe_motion(events, model, x0, variance0, nodes, smooth=True)) / count
    return [
        Figure(
            "observer with smoother, recording to states, per event",
            1e6 * whole, "µs", 1e6 * dense, "filterpy and dense NumPy, its motion states alone",
            goal="at most 2.2 µs, at least 25 times faster",
        ),
        Figure(
            "observer without smoother, per event", 1e6 * filtered, "µs", 1e6 * dense, "the same", goal="at most 1.2 µs"
        ),
        Figure("compiled motion filter and smoother alone, per event", 1e6 * kernels, "µs", 1e6 * dense, "the same"),
        Figure(
            "memory of the smoother beyond the filter's, an hour",
            _smoother_mb(), "MB", 1e-6 * count * STEP_BYTES, "one covariance kept per event", goal="at most 50 MB",
        ),
    ]  # fmt: skip


def _smoother_mb() -> float:
    command = [sys.executable, "-P", "-m", "app.cli.bench.smoother_alone", str(virtual_hour_files())]
    done = subprocess.run(command, check=True, capture_output=True)  # noqa: S603 - our own interpreter and module
    return float(json.loads(done.stdout))
