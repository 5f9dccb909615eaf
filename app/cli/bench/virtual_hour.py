"""An hour of the virtual car, simulated once per call of ``bench``."""

from __future__ import annotations

from functools import cache
from pathlib import Path
from tempfile import TemporaryDirectory

from app.cli.output import note
from app.science.virtualcar.simulate import SimulatedTrip, simulate
from app.science.virtualcar.specification import Simulation

SEED = 9001
HOUR_S = 3600.0


@cache
def virtual_hour() -> SimulatedTrip:
    """Return an hour of mixed roads."""
    note(f"simulating an hour with seed {SEED}")
    return simulate(Simulation(duration_s=HOUR_S, seed=SEED))


@cache
def _folder() -> TemporaryDirectory[str]:
    return TemporaryDirectory(prefix="ponthy-bench-")  # removed when the process ends


@cache
def virtual_hour_files() -> Path:
    """Return a folder with the hour's trip.dat, car.xml and elevation.csv."""
    folder, trip = Path(_folder().name), virtual_hour()
    (folder / "trip.dat").write_bytes(trip.image)
    (folder / "car.xml").write_bytes(trip.car_xml)
    (folder / "elevation.csv").write_bytes(trip.elevation_csv)
    return folder
