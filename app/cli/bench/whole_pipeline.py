"""An hour's image from disk to the stored map, in a process of its own on one core."""

from __future__ import annotations

import json
import os
import resource
import subprocess
import sys
from tempfile import TemporaryDirectory

from app.cli.bench.figure import Figure
from app.cli.bench.virtual_hour import HOUR_S, virtual_hour_files

BYTES_PER_KIB = 1024


def measure() -> list[Figure]:
    """Return the time of the pipeline's stages together and the process's peak memory, kernels warm."""
    folder = virtual_hour_files()
    with TemporaryDirectory(prefix="ponthy-bench-") as out:
        arguments = ["process", str(folder / "trip.dat"), "--car", str(folder / "car.xml"), "--out", out, "--json"]
        command = [sys.executable, "-P", "-m", "app.cli", *arguments]
        for _ in range(2):  # the first run fills the kernel cache
            done = subprocess.run(  # noqa: S603 - our own interpreter and module
                command, check=True, stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, preexec_fn=keep_to_one_core
            )
    peak_mb = resource.getrusage(resource.RUSAGE_CHILDREN).ru_maxrss * BYTES_PER_KIB / 1e6
    seconds = json.loads(done.stdout)["timing_s"]["total"]
    image_mb = (folder / "trip.dat").stat().st_size / 1e6
    return [
        Figure("an hour's image to its map", seconds, "s", HOUR_S, "the drive itself", goal="at most 6 s"),
        Figure("peak memory of that", peak_mb, "MB", image_mb, "the image's size", goal="at most 600 MB"),
    ]


def keep_to_one_core() -> None:
    """Run on a single core from here on, where the system lets us choose."""
    if hasattr(os, "sched_setaffinity"):
        os.sched_setaffinity(0, {min(os.sched_getaffinity(0))})
