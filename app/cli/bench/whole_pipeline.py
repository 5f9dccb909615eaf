"""An hour's image from disk to the stored map, in a process of its own on one core."""

from __future__ import annotations

import json
import subprocess
import sys

from app.cli.bench.figure import Figure
from app.cli.bench.virtual_hour import HOUR_S, virtual_hour_files


def measure() -> list[Figure]:
    """Return the time of the pipeline's stages together and the process's peak memory, kernels warm."""
    folder = virtual_hour_files()
    command = [sys.executable, "-P", "-m", "app.cli.bench.pipeline_alone", str(folder)]
    for _ in range(2):  # the first run fills the kernel cache
        done = subprocess.run(command, check=True, capture_output=True)  # noqa: S603 - our own interpreter and module
    result = json.loads(done.stdout)
    image_mb = (folder / "trip.dat").stat().st_size / 1e6
    return [
        Figure("an hour's image to its map", result["seconds"], "s", HOUR_S, "the drive itself", goal="at most 6 s"),
        Figure("peak memory of that", result["peak_mb"], "MB", image_mb, "the image's size", goal="at most 600 MB"),
    ]
