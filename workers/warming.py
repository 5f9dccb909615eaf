"""Filling the kernel cache, so that the first trip of a person doesn't wait for a compiler."""

from __future__ import annotations

import os
from collections.abc import Callable, Iterator
from dataclasses import replace
from pathlib import Path

from app.exports.parquet import states_parquet
from app.imports.elevation import read_elevation
from app.science.engine.cells import accumulate, build_map
from app.science.engine.efficiency_map import CellGrid
from app.science.engine.operating import operating_points
from app.science.fingerprint import science_fingerprint
from app.science.logger.decode import ImageDecoder
from app.science.logger.recording import Recording
from app.science.observer.observe import observe
from app.science.observer.tuning import DEFAULT
from app.science.virtualcar.simulate import SimulatedTrip, simulate
from app.science.virtualcar.specification import Simulation

CHUNK_BYTES = 1 << 20
LOWEST_PRIORITY = 19


def warm() -> int:
    """Take a short virtual trip through everything a real one goes through, once per version of the science."""
    return _once("warm", _take_a_trip)


def warm_filters() -> int:
    """Do the same for the filters that only somebody who asks for them gets; it gives way to all other work."""
    os.nice(LOWEST_PRIORITY)
    return _once("warm-filters", _try_filters)


def _once(name: str, work: Callable[[], None]) -> int:
    folder = os.environ.get("NUMBA_CACHE_DIR")
    mark = None if folder is None else Path(folder) / science_fingerprint() / name
    if mark is not None and mark.exists():
        return 0
    work()
    if mark is not None:
        mark.parent.mkdir(parents=True, exist_ok=True)
        mark.touch()
    return 0


def _take_a_trip() -> None:
    trip = simulate(Simulation(duration_s=90.0, seed=7))
    for recording in _recordings(trip):
        observation = observe(recording, trip.vehicle, elevation=read_elevation(trip.elevation_csv))
        points = operating_points(observation, recording, trip.vehicle)
        build_map(accumulate(points, CellGrid()), CellGrid(), trip.vehicle)
        states_parquet(observation)


def _try_filters() -> None:
    trip = simulate(Simulation(duration_s=60.0, seed=7))
    richer = replace(DEFAULT, thrust_order=2, fuel_power_order=2, engine_speed_order=2)
    for recording in _recordings(trip):
        observe(recording, trip.vehicle, filter="sr-ekf", tuning=richer)


def _recordings(trip: SimulatedTrip) -> Iterator[Recording]:
    return ImageDecoder().trips(trip.image[at : at + CHUNK_BYTES] for at in range(0, len(trip.image), CHUNK_BYTES))
