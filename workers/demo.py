"""The demo: virtual cars that really drive, and whose trips come in by the same door as anybody's."""

from __future__ import annotations

import asyncio
from collections.abc import AsyncIterator, Callable, Mapping
from dataclasses import dataclass, replace
from functools import partial

from sqlalchemy.orm import Session

from app.cars import service as cars
from app.jobs import service as jobs
from app.science.vehicle.model import Mounting, Vehicle
from app.science.virtualcar.carfile import car_xml
from app.science.virtualcar.simulate import simulate
from app.science.virtualcar.specification import DEFAULT_CAR, RouteName, Simulation
from app.uploads import service as uploads
from workers.running import StageWork

ROADSTER = replace(DEFAULT_CAR, mounting=Mounting(0.03, -0.05, 1.62))
LOADED = replace(ROADSTER, color="red", cd=0.47, mass_wet_kg=ROADSTER.mass_wet_kg + 60.0)
CARS: Mapping[str, Vehicle] = {"Demo roadster": ROADSTER, "Demo roadster with a roof box": LOADED}
CHUNK_BYTES = 1 << 20
DAY_S = 86400.0


@dataclass(frozen=True, slots=True)
class DemoTrip:
    """A trip of the demo; each drives in another place, so that their roads don't cross."""

    name: str
    car: str
    minutes: float
    route: RouteName
    seed: int
    lat_deg: float
    lon_deg: float
    day: int


TRIPS: Mapping[str, DemoTrip] = {
    "short trip": DemoTrip("Round the block", "Demo roadster", 4, "town", 11, 49.60, 6.12, 0),
    "town": DemoTrip("Errands in town", "Demo roadster", 20, "town", 12, 48.58, 7.75, 1),
    "motorway": DemoTrip("To the south", "Demo roadster", 25, "motorway", 13, 47.32, 5.04, 2),
    "full load": DemoTrip("Test of full load", "Demo roadster", 15, "full-load", 14, 45.90, 6.13, 4),
    "roof box": DemoTrip("With skis", "Demo roadster with a roof box", 20, "mixed", 15, 46.20, 7.36, 5),
    "mixed hour": DemoTrip("An hour across the land", "Demo roadster", 60, "mixed", 16, 50.36, 7.59, 7),
}


def make_cars(work: StageWork) -> jobs.Store:
    """Make the demo's cars, unless they are there."""

    def store(session: Session) -> None:
        present = {car.name for car in cars.page(session, limit=200).items}
        for name, vehicle in CARS.items():
            if name not in present:
                cars.create(session, xml=car_xml(vehicle), name=name)

    return store


def drive(trip: DemoTrip, work: StageWork) -> jobs.Store:
    """Simulate a trip and upload it with the altitudes along its road."""
    work.progress(0.0, f"{trip.name}: driving {trip.minutes:.0f} minutes")
    simulated = simulate(
        Simulation(
            duration_s=trip.minutes * 60.0,
            seed=trip.seed,
            route=trip.route,
            vehicle=CARS[trip.car],
            start_lat_deg=trip.lat_deg,
            start_lon_deg=trip.lon_deg,
            started_at_utc_s=Simulation().started_at_utc_s + trip.day * DAY_S,
        )
    )
    work.progress(0.7, f"{trip.name}: uploading {len(simulated.image) / 1e6:.1f} MB")
    with work.resources.database.transaction(work.fleet_id, read_only=True) as session:
        car_ids = {car.name: car.id for car in cars.page(session, limit=200).items}
    upload(work, simulated.elevation_csv, {"kind": "elevation", "filename": f"{trip.name} road.csv"})
    upload(work, simulated.image, {"car_id": car_ids[trip.car], "filename": f"{trip.name}.dat"})
    return lambda session: None


def upload(work: StageWork, data: bytes, metadata: Mapping[str, str]) -> None:
    """Send bytes as an upload; the same bytes sent again make nothing new."""

    async def pieces() -> AsyncIterator[bytes]:
        for at in range(0, len(data), CHUNK_BYTES):
            yield data[at : at + CHUNK_BYTES]

    wish = uploads.make_wish(len(data), metadata)
    asyncio.run(uploads.receive_whole(work.resources, work.fleet_id, wish, pieces()))


DEMO: Mapping[str, Callable[[StageWork], jobs.Store]] = {
    "cars": make_cars,
    **{stage: partial(drive, trip) for stage, trip in TRIPS.items()},
}
"""Stages of a demo job by name; the short trip comes first, so that there is something to see soon."""
