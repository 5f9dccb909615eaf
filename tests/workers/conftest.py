"""An embedded Ponthy whose stages the test writes, with or without real worker processes."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
import time
from collections.abc import Callable, Iterator
from dataclasses import dataclass, field
from pathlib import Path

import pytest

from app.accounts.models import DEFAULT_FLEET_ID
from app.cars import service as cars
from app.jobs import service as jobs
from app.settings import Settings
from app.storage.migrate import migrate
from app.storage.resources import Resources
from app.trips.models import Trip
from app.uploads.models import Upload
from workers.supervisor import environment_of

FLEET = DEFAULT_FLEET_ID
CREW = Path(__file__).with_name("crew.py")


@dataclass
class Yard:
    """Resources, a trip to work on, and the processes that were started."""

    resources: Resources
    trip_id: str
    car_id: str
    folder: Path
    processes: list[subprocess.Popen[bytes]] = field(default_factory=list)

    def new_job(self) -> str:
        with self.resources.database.transaction(FLEET) as session:
            return jobs.create_trip_job(session, trip_id=self.trip_id, car_id=self.car_id, title="trip.dat").id

    def job(self, job_id: str) -> jobs.JobView:
        with self.resources.database.transaction(FLEET, read_only=True) as session:
            return jobs.get(session, job_id)

    def notes(self) -> str:
        """What the stages wrote; see crew.py."""
        with self.resources.database.transaction(FLEET, read_only=True) as session:
            trip = session.get(Trip, self.trip_id)
            assert trip is not None
            return trip.notes

    def start_worker(self) -> subprocess.Popen[bytes]:
        """Start a worker process whose stages wait as long as the folder has a file ``hold-<stage>``."""
        environment = {**os.environ, **environment_of(self.resources.settings), "PONTHY_TEST_FOLDER": str(self.folder)}
        command = [sys.executable, "-W", "error", str(CREW)]
        log = (self.folder / f"worker-{len(self.processes)}.log").open("wb")
        process = subprocess.Popen(command, env=environment, stderr=log, stdout=log, start_new_session=True)
        log.close()
        self.processes.append(process)
        return process

    def hold(self, stage: str) -> Path:
        path = self.folder / f"hold-{stage}"
        path.touch()
        return path

    def until(self, condition: Callable[[], bool], seconds: float = 30.0) -> None:
        """Wait for something to become true; fail with the workers' logs when it doesn't."""
        end = time.monotonic() + seconds
        while not condition():
            if time.monotonic() > end or (self.processes and all(p.poll() is not None for p in self.processes)):
                logs = "\n".join(p.read_text()[-3000:] for p in sorted(self.folder.glob("worker-*.log")))
                pytest.fail(f"it did not happen within {seconds} s or all workers are dead; they say:\n{logs}")
            time.sleep(0.05)


@pytest.fixture
def yard(tmp_path: Path) -> Iterator[Yard]:
    settings = Settings(data_dir=tmp_path / "data", lease_s=1.0, attempts=3, redeliver_s=0.3, log_level="debug")
    resources = Resources.open(settings)
    migrate(settings)
    with resources.database.transaction(FLEET) as session:
        car = cars.create(session, name="car")
        upload = Upload(car_id=car.id, kind="trip", filename="trip.dat", size=3, sha256="0" * 64, blob_key="x")
        session.add(upload)
        session.flush()
        trip = Trip(
            car_id=car.id,
            upload_id=upload.id,
            input_key="x",
            input_sha256="0" * 64,
            input_bytes=3,
            name="trip",
            filename="trip.dat",
            options={},
        )
        session.add(trip)
        session.flush()
        yard = Yard(resources, trip.id, car.id, tmp_path)
    yield yard
    for process in yard.processes:
        process.send_signal(signal.SIGCONT)
        process.kill()
        process.wait()
    resources.close()
