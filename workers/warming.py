"""Filling the kernel cache, so that the first trip of a person doesn't wait for a compiler."""

from __future__ import annotations

import os
from pathlib import Path

from app.exports.parquet import states_parquet
from app.imports.elevation import read_elevation
from app.science.engine.cells import accumulate, build_map
from app.science.engine.efficiency_map import CellGrid
from app.science.engine.operating import operating_points
from app.science.fingerprint import science_fingerprint
from app.science.logger.decode import ImageDecoder
from app.science.observer.observe import observe
from app.science.virtualcar.simulate import simulate
from app.science.virtualcar.specification import Simulation

CHUNK_BYTES = 1 << 20


def warm() -> int:
    """Take a short virtual trip through everything a real one goes through, once per version of the science."""
    folder = os.environ.get("NUMBA_CACHE_DIR")
    mark = None if folder is None else Path(folder) / science_fingerprint() / "warm"
    if mark is not None and mark.exists():
        return 0
    trip = simulate(Simulation(duration_s=90.0, seed=7))
    pieces = (trip.image[at : at + CHUNK_BYTES] for at in range(0, len(trip.image), CHUNK_BYTES))
    for recording in ImageDecoder().trips(pieces):
        observation = observe(recording, trip.vehicle, elevation=read_elevation(trip.elevation_csv))
        points = operating_points(observation, recording, trip.vehicle)
        build_map(accumulate(points, CellGrid()), CellGrid(), trip.vehicle)
        states_parquet(observation)
    if mark is not None:
        mark.parent.mkdir(parents=True, exist_ok=True)
        mark.touch()
    return 0
