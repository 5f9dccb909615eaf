"""An hour's image from disk to the stored map, in a process of its own on one core."""

from __future__ import annotations

import json
import os
import subprocess
import sys
from pathlib import Path
from tempfile import TemporaryDirectory

from app.cli.bench.figure import Figure
from app.cli.bench.memory import peak_memory_mb
from app.cli.bench.virtual_hour import HOUR_S, virtual_hour_files


def measure() -> list[Figure]:
    """Return the time of the pipeline's stages together and the process's peak memory, kernels warm."""
    folder = virtual_hour_files()
    command = [sys.executable, "-P", "-m", "app.cli.bench.whole_pipeline", str(folder)]
    for _ in range(2):  # the first run fills the kernel cache
        done = subprocess.run(command, check=True, capture_output=True)  # noqa: S603 - our own interpreter and module
    result = json.loads(done.stdout)
    image_mb = (folder / "trip.dat").stat().st_size / 1e6
    return [
        Figure("an hour's image to its map", result["seconds"], "s", HOUR_S, "the drive itself", goal="at most 6 s"),
        Figure("peak memory of that", result["peak_mb"], "MB", image_mb, "the image's size", goal="at most 600 MB"),
    ]


def process_alone(folder: Path) -> dict[str, float]:
    """Process the hour on a single core, where the system lets us choose, and return time and peak memory."""
    from app.cli.pipeline import Choices, run

    if hasattr(os, "sched_setaffinity"):
        os.sched_setaffinity(0, {min(os.sched_getaffinity(0))})
    choices = Choices(car=folder / "car.xml", elevation=folder / "elevation.csv")
    with TemporaryDirectory(prefix="ponthy-bench-") as out:
        summary = run([folder / "trip.dat"], choices, Path(out))
    return {"seconds": summary["timing_s"]["total"], "peak_mb": peak_memory_mb()}


if __name__ == "__main__":
    print(json.dumps(process_alone(Path(sys.argv[1]))))
