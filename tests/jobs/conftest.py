"""A fleet with a car and a trip, and jobs whose stages do what the test says."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
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

FLEET = DEFAULT_FLEET_ID


@dataclass
class Yard:
    """An embedded Ponthy without processes: the test plays the workers."""

    resources: Resources
    car_id: str
    trip_id: str

    def new_job(self) -> jobs.JobView:
        with self.resources.database.transaction(FLEET) as session:
            return jobs.create_trip_job(session, trip_id=self.trip_id, car_id=self.car_id, title="trip.dat")

    def job(self, job_id: str) -> jobs.JobView:
        with self.resources.database.transaction(FLEET, read_only=True) as session:
            return jobs.get(session, job_id)

    def claim(self, job_id: str, lease_s: float = 30.0) -> jobs.Claim | None:
        with self.resources.database.transaction(FLEET) as session:
            return jobs.claim(session, job_id, lease_s)


def settings_for(folder: Path) -> Settings:
    return Settings(data_dir=folder, lease_s=1.0, attempts=3, redeliver_s=0.2)


@pytest.fixture
def yard(tmp_path: Path) -> Iterator[Yard]:
    migrate(settings_for(tmp_path))
    settings = settings_for(tmp_path)
    resources = Resources.open(settings)
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
        yard = Yard(resources, car.id, trip.id)
    yield yard
    resources.close()
