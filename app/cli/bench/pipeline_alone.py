"""The pipeline in a process that holds nothing else, as a worker's does: no simulator, none of the other benchmarks."""

from __future__ import annotations

import json
import os
import sys
from pathlib import Path
from tempfile import TemporaryDirectory

from app.cli.bench.memory import peak_memory_mb
from app.cli.pipeline import Choices, run


def process_alone(folder: Path) -> dict[str, float]:
    """Process the hour on a single core, where the system lets us choose, and return time and peak memory."""
    if hasattr(os, "sched_setaffinity"):
        os.sched_setaffinity(0, {min(os.sched_getaffinity(0))})
    choices = Choices(car=folder / "car.xml", elevation=folder / "elevation.csv")
    with TemporaryDirectory(prefix="ponthy-bench-") as out:
        summary = run([folder / "trip.dat"], choices, Path(out))
    return {"seconds": summary["timing_s"]["total"], "peak_mb": peak_memory_mb()}


if __name__ == "__main__":
    print(json.dumps(process_alone(Path(sys.argv[1]))))
