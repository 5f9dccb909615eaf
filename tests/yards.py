"""A fleet with a car and trips, for tests of the jobs and what they do."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from datetime import UTC, datetime
from typing import TYPE_CHECKING

from app.accounts.models import DEFAULT_FLEET_ID as FLEET
from app.cars import service as cars
from app.exports.observability import observability_json
from app.exports.parquet import innovations_parquet, operating_points_parquet, states_parquet
from app.jobs import service as jobs
from app.science.engine.points import OperatingPoints
from app.science.observer.observability.report import observability_of
from app.science.observer.result import Observation
from app.science.observer.tuning import DEFAULT
from app.science.vehicle.model import Vehicle
from app.storage.keys import stage_key
from app.storage.resources import Resources
from app.trips import repository as trip_rows
from app.trips.keys import INNOVATIONS, OBSERVABILITY, POINTS, STATES, result_file
from app.trips.models import Trip
from app.uploads.models import Upload

if TYPE_CHECKING:
    from sqlalchemy.orm import Session


def silent(fraction: float, detail: str | None = None) -> None:
    """Progress that nobody hears."""


@dataclass
class Yard:
    """A Ponthy in which the test plays the workers."""

    resources: Resources
    car_id: str = field(init=False)
    trip_id: str = field(init=False)

    def __post_init__(self) -> None:
        with self.resources.database.transaction(FLEET) as session:
            self.car_id = cars.create(session, name="car").id
        self.trip_id = self.new_trip()

    def new_trip(self, name: str = "trip", data: bytes = b"xyz", filename: str = "trip.dat") -> str:
        """Make a trip with a complete upload of these bytes, but no job."""
        with self.resources.database.transaction(FLEET) as session:
            upload = Upload(car_id=self.car_id, kind="trip", filename=filename, size=len(data), state="complete")
            session.add(upload)
            session.flush()
            key = f"fleets/{FLEET}/uploads/{upload.id}"
            self.resources.blobs.put(key, data)
            trip = Trip(
                car_id=self.car_id,
                upload_id=upload.id,
                input_key=key,
                input_sha256=stage_key(name),
                input_bytes=len(data),
                name=name,
                filename=filename,
                options={},
            )
            session.add(trip)
            session.flush()
            return trip.id

    def observed(self, name: str, observation: Observation, points: OperatingPoints) -> str:
        """Make a trip whose result is there, as the observe stage would leave it."""
        trip_id = self.new_trip(name)

        def describe(session: Session) -> None:
            trip = trip_rows.trip(session, trip_id)
            assert trip is not None
            trip.observe_key = stage_key("observe", name=name)
            trip.started_at = datetime(2009, 10, 27, 7, 41, tzinfo=UTC)
            trip.duration_s, trip.distance_m = observation.duration_s, observation.distance_m
            trip.fuel_l, trip.fuel_energy_j = observation.fuel_l, observation.fuel_energy_j
            trip.verdict, trip.summary = observation.verdict, {"events": observation.events}
            trip.provenance = {"input_sha256": trip.input_sha256, "tuning": {"name": "default"}}
            blobs = self.resources.blobs
            blobs.put(result_file(trip, trip.observe_key, STATES), states_parquet(observation))
            blobs.put(result_file(trip, trip.observe_key, INNOVATIONS), innovations_parquet(observation))
            blobs.put(result_file(trip, trip.observe_key, POINTS), operating_points_parquet(points))
            told = observability_json(observability_of(observation, Vehicle(), DEFAULT))
            blobs.put(result_file(trip, trip.observe_key, OBSERVABILITY), told)

        self.write(describe)
        return trip_id

    def write(self, change: Callable[[Session], None]) -> None:
        """Do something in a transaction of the fleet."""
        with self.resources.database.transaction(FLEET) as session:
            change(session)

    def trip(self, trip_id: str | None = None) -> Trip:
        """Return the row of a trip, of the first one by default."""
        with self.resources.database.transaction(FLEET, read_only=True) as session:
            trip = trip_rows.trip(session, trip_id or self.trip_id)
        assert trip is not None
        return trip

    def new_job(self, trip_id: str | None = None) -> jobs.JobView:
        with self.resources.database.transaction(FLEET) as session:
            return jobs.create_trip_job(session, trip_id=trip_id or self.trip_id, car_id=self.car_id, title="trip.dat")

    def job(self, job_id: str) -> jobs.JobView:
        with self.resources.database.transaction(FLEET, read_only=True) as session:
            return jobs.get(session, job_id)

    def claim(self, job_id: str, lease_s: float = 30.0) -> jobs.Claim | None:
        with self.resources.database.transaction(FLEET) as session:
            return jobs.claim(session, job_id, lease_s)
