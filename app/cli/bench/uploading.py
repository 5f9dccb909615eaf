"""Uploading to a web server of its own on this machine, against hashing and copying the same bytes."""

from __future__ import annotations

import hashlib
import os
import socket
import subprocess
import sys
import time
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np

from app.cli.bench.figure import Figure, timed
from app.cli.bench.memory import peak_memory_mb
from app.cli.tus import CHUNK_BYTES, Service
from app.science.virtualcar.simulate import simulate
from app.science.virtualcar.specification import Simulation

SIZE_BYTES = 256 * 1024**2
START_S = 60.0


def measure() -> list[Figure]:
    """Return the speed of an upload and the peak memory of the server that took it."""
    with TemporaryDirectory(prefix="ponthy-bench-") as name:
        folder = Path(name)
        file = folder / "upload.dat"
        file.write_bytes(np.random.default_rng(1).bytes(SIZE_BYTES))
        with web_server(folder / "data") as (service, process_id):
            car = service.insist("POST", "/api/v1/cars", body=car_xml(), headers={"Content-Type": "application/xml"})
            metadata = {"filename": file.name, "car_id": car.json()["id"], "kind": "trip"}
            seconds = timed(lambda: service.send(file, metadata))
            peak_mb = peak_memory_mb(process_id)
        plain = timed(lambda: copy_and_hash(file, folder / "copy"))
    speed = Figure(
        "uploading", SIZE_BYTES / seconds / 1e6, "MB/s", SIZE_BYTES / plain / 1e6, "copying and hashing", "higher"
    )
    memory = Figure("peak memory of the server", peak_mb, "MB", SIZE_BYTES / 1e6, "the file's size")
    return [speed, memory]


def car_xml() -> bytes:
    """Return the XML of a virtual car."""
    return simulate(Simulation(duration_s=60.0)).car_xml


@contextmanager
def web_server(data: Path) -> Iterator[tuple[Service, int]]:
    """Run a web server on a free port; give its address and process."""
    with socket.socket() as probe:
        probe.bind(("127.0.0.1", 0))
        port = probe.getsockname()[1]
    command = [sys.executable, "-P", "-m", "app.cli", "web", "--port", str(port), "--data", str(data)]
    process = subprocess.Popen(command, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)  # noqa: S603 - our own
    service = Service(f"http://127.0.0.1:{port}")
    try:
        until = time.monotonic() + START_S
        while time.monotonic() < until:
            with suppress(OSError):
                service.request("GET", "/health/live")
                break
            time.sleep(0.1)
        yield service, process.pid
    finally:
        process.terminate()
        process.wait()


def copy_and_hash(source: Path, target: Path) -> str:
    """Copy a file to the disk for good, hashing it on the way."""
    digest = hashlib.sha256()
    with source.open("rb") as reading, target.open("wb") as writing:
        while piece := reading.read(CHUNK_BYTES):
            digest.update(piece)
            writing.write(piece)
        writing.flush()
        os.fsync(writing.fileno())
    return digest.hexdigest()
