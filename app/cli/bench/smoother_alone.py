"""The memory that the smoother needs beyond the filter, in a process that holds nothing else."""

from __future__ import annotations

import json
import sys
from pathlib import Path

from app.cli.bench.memory import peak_memory_mb
from app.imports.elevation import read_elevation
from app.science.logger.decode import decode_image
from app.science.observer.observe import observe
from app.science.vehicle.xml import read_vehicle


def extra_memory_mb(folder: Path) -> float:
    """Return how much higher the process's peak is after smoothing the hour than after filtering it, MB."""
    recording = decode_image((folder / "trip.dat").read_bytes()).recordings[0]
    vehicle = read_vehicle((folder / "car.xml").read_bytes())
    elevation = read_elevation((folder / "elevation.csv").read_bytes())
    observe(recording, vehicle, elevation=elevation, smooth=False)
    filtered = peak_memory_mb()
    observe(recording, vehicle, elevation=elevation)
    return peak_memory_mb() - filtered


if __name__ == "__main__":
    print(json.dumps(extra_memory_mb(Path(sys.argv[1]))))
