"""The observe stage: from a trip's measurements to states with their uncertainty, operating points and a verdict."""

from __future__ import annotations

import platform
import time
from collections.abc import Callable
from dataclasses import asdict, dataclass, replace
from importlib.metadata import version
from math import isfinite
from typing import Any

import numpy as np
from sqlalchemy.orm import Session

from app.cars import service as cars
from app.errors import PonthyError
from app.exports.observability import observability_json
from app.exports.parquet import innovations_parquet, operating_points_parquet, road_load_parquet, states_parquet
from app.exports.summary import observation_summary
from app.imports.signals import read_signals
from app.jobs import service as jobs
from app.roads import service as roads
from app.science.engine.doubts import engine_doubts
from app.science.engine.idle import idling
from app.science.engine.operating import operating_points
from app.science.logger.recording import Recording
from app.science.observer.observability.report import observability_of
from app.science.observer.observe import observe as run_observer
from app.science.observer.result import Observation
from app.science.observer.tuning import tuning_to_dict
from app.science.roadload.windows import windows
from app.storage.blobs import Blobs
from app.storage.keys import stage_key
from app.storage.resources import Resources
from app.trips import repository
from app.trips.calibrating import gather
from app.trips.carrying import SUMMARY, CarriedOver, bias_summary, carried_over
from app.trips.keys import (
    EVIDENCE,
    IDLE,
    INNOVATIONS,
    OBSERVABILITY,
    POINTS,
    ROAD_LOAD,
    ROAD_LOAD_EVIDENCE,
    STATES,
    TORQUES,
    options_of,
    recording_file,
    result_file,
    results_folder,
)
from app.trips.models import LEFT_OUT, Trip
from app.trips.road_loads import road_load_json
from app.trips.torques import torque_document
from app.trips.tunings import tuning_of

READ, OBSERVED = 0.05, 0.75
"""Share of the stage that is done when the measurements are read, and when the observer is through."""

LIBRARIES = ("numpy", "scipy", "numba", "pyarrow", "pyproj")


@dataclass(frozen=True, slots=True)
class Inputs:
    """Everything an observer run depends on."""

    trip: Trip
    recording: Recording
    car: cars.CarConfig
    elevation: roads.Elevation
    options: dict[str, Any]
    carried: CarriedOver
    key: str


def observe(resources: Resources, fleet_id: str, trip_id: str, progress: jobs.Progress) -> jobs.Store:
    """Observe a trip, unless the very same was done before.

    Raises
    ------
    ScienceError
        When the measurements don't tell enough, or the filter fails.
    """
    inputs = _inputs(resources, fleet_id, trip_id)
    if inputs.trip.observe_key == inputs.key:
        return lambda session: None
    material = f"{inputs.recording.sample_count} samples of {len(inputs.recording.signals)} signals"
    progress(READ, material)
    began = time.perf_counter()
    options = inputs.options
    observation = _run(inputs, inputs.recording, lambda share: progress(READ + (OBSERVED - READ) * share, material))
    observed = time.perf_counter()
    progress(OBSERVED, f"{observation.events} events, the observer is {observation.verdict}")
    points = operating_points(observation, inputs.recording, inputs.car.vehicle)
    steady = windows(observation, inputs.car.vehicle, inputs.recording)
    told = observability_of(observation, inputs.car.vehicle, tuning_of(options["tuning"]))
    _clear_leftovers(resources.blobs, inputs.trip)
    for name, data in (
        (STATES, states_parquet(observation)),
        (POINTS, operating_points_parquet(points)),
        (ROAD_LOAD, road_load_parquet(steady)),
        (ROAD_LOAD_EVIDENCE, road_load_json(steady, inputs.car.vehicle)),
        (INNOVATIONS, innovations_parquet(observation)),
        (OBSERVABILITY, observability_json(told)),
    ):
        resources.blobs.put(result_file(inputs.trip, inputs.key, name), data)
        progress(0.9, f"{observation.events} events, {len(points)} operating points, observer {observation.verdict}")
    torques = torque_document(inputs.recording, inputs.car.vehicle, lambda recording: _run(inputs, recording))
    if torques is not None:
        resources.blobs.put(result_file(inputs.trip, inputs.key, TORQUES), torques)
    evidence, warnings = gather(inputs.recording, inputs.car, observation)
    if evidence is not None:
        resources.blobs.put(result_file(inputs.trip, inputs.key, EVIDENCE), evidence)
    doubts = engine_doubts(observation, points, inputs.recording, inputs.car.vehicle)
    observation = replace(observation, warnings=(*observation.warnings, *doubts, *warnings))
    summary = observation_summary(observation, points=len(points))
    summary[IDLE] = idling(observation, inputs.recording, inputs.car.vehicle).to_dict()
    summary["torques_compared"] = torques is not None
    summary[SUMMARY] = bias_summary(observation, options["without"])
    summary["timing_s"] = {"observe": observed - began, "write": time.perf_counter() - observed}
    provenance = _provenance(inputs, resources.settings.code_version)
    return lambda session: _store(session, inputs, observation, summary, provenance)


def _run(inputs: Inputs, recording: Recording, progress: Callable[[float], None] = lambda share: None) -> Observation:
    options = inputs.options
    return run_observer(
        recording,
        inputs.car.vehicle,
        elevation=inputs.elevation.roads,
        tuning=tuning_of(options["tuning"]),
        filter=options["filter"],
        smooth=options["smooth"],
        without=frozenset(options["without"]),
        bias_prior=inputs.carried.prior,
        progress=progress,
    )


def _inputs(resources: Resources, fleet_id: str, trip_id: str) -> Inputs:
    with resources.database.transaction(fleet_id, read_only=True) as session:
        trip = repository.trip(session, trip_id)
        if trip is None:
            raise jobs.JobCancelled
        car = cars.config(session, trip.car_id)
    if trip.decode_key is None:
        raise PonthyError("not-decoded", "The trip has to be decoded before it can be observed; retry the job.", 409)
    data = resources.blobs.get(recording_file(trip, trip.decode_key, trip.segment))
    recording = read_signals(data, filename="recording.parquet")
    options = options_of(trip.options)
    with resources.database.transaction(fleet_id, read_only=True) as session:
        elevation = roads.elevation_for(session, resources.blobs, _bounds(recording))
        carried = carried_over(session, trip, car, options)
    key = stage_key(
        "observe",
        decoded=trip.decode_key,
        segment=trip.segment,
        car=car.key,
        elevation=list(elevation.sha256s),
        options=options,
        carried=carried.numbers(),
        code=resources.settings.code_version,
    )
    return Inputs(trip, recording, car, elevation, options, carried, key)


def _bounds(recording: Recording) -> roads.Bounds | None:
    lat, lon = recording.get("lat_deg"), recording.get("lon_deg")
    if lat is None or lon is None:
        return None
    return roads.Bounds(*(float(f(s.value)) for f, s in ((np.min, lat), (np.min, lon), (np.max, lat), (np.max, lon))))


def _clear_leftovers(blobs: Blobs, trip: Trip) -> None:
    """Remove what runs left that a newer one replaced or that never ended; the results now shown stay."""
    kept = f"{results_folder(trip)}/{trip.observe_key}/"
    blobs.delete(*(key for key in blobs.keys(results_folder(trip)) if not key.startswith(kept)))


def _provenance(inputs: Inputs, code_version: str) -> dict[str, Any]:
    options = inputs.options
    return {
        "input_sha256": inputs.trip.input_sha256,
        "segment": inputs.trip.segment,
        "config_sha256": inputs.car.sha256,
        "config_revision": inputs.car.revision,
        "load_kg": inputs.car.vehicle.load_kg,
        "elevation_sha256s": list(inputs.elevation.sha256s),
        "filter": options["filter"],
        "tuning": tuning_to_dict(tuning_of(options["tuning"])),
        "smooth": options["smooth"],
        "without": options["without"],
        "bias_prior": inputs.carried.provenance(),
        "observe_key": inputs.key,
        "code_version": code_version,
        "libraries": {name: version(name) for name in LIBRARIES} | {"python": platform.python_version()},
    }


def _store(
    session: Session,
    inputs: Inputs,
    observation: Observation,
    summary: dict[str, Any],
    provenance: dict[str, Any],
) -> None:
    trip = repository.trip(session, inputs.trip.id, lock=True)
    if trip is None:
        return
    warnings = list(observation.warnings)
    if observation.verdict == "failed" and (trip.is_left_out_by_itself or (trip.verdict != "failed" and trip.in_map)):
        trip.in_map = False
        warnings.append(LEFT_OUT)
    elif trip.is_left_out_by_itself:
        trip.in_map = True
    trip.observe_key = inputs.key
    trip.duration_s = observation.duration_s
    trip.distance_m = _known(observation.distance_m)
    trip.fuel_l = _known(observation.fuel_l)
    trip.fuel_energy_j = _known(observation.fuel_energy_j)
    trip.verdict = observation.verdict
    trip.reasons = list(observation.reasons)
    trip.warnings = warnings
    trip.consistency = [
        {name: _known(value) if isinstance(value, float) else value for name, value in asdict(sensor).items()}
        for sensor in observation.sensors
    ]
    trip.filter = observation.filter
    trip.tuning = observation.tuning
    trip.smoothed = observation.smoothed
    trip.code_version = provenance["code_version"]
    trip.provenance = provenance
    trip.summary = summary


def _known(value: float) -> float | None:
    return value if isfinite(value) else None
