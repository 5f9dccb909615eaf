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
from app.science.virtualcar.simulate import SimulatedTrip, simulate
from app.science.virtualcar.specification import DEFAULT_CAR, RouteName, Simulation
from app.uploads import service as uploads
from workers.running import StageWork

ROADSTER = replace(DEFAULT_CAR, mounting=Mounting(0.03, -0.05, 1.62))
LOADED = replace(ROADSTER, color="red", cd=0.47, mass_wet_kg=ROADSTER.mass_wet_kg + 60.0)
CARS: Mapping[str, Vehicle] = {
    "Demo roadster": ROADSTER,
    "Demo roadster with a roof box": LOADED,
    "Demo commuter": ROADSTER,
}
CHUNK_BYTES = 1 << 20
DAY_S = 86400.0


COMMUTES, SOFT_FROM, SOFTER = 14, 10, 1.35
"""The commuter's trips; from the eleventh on a tyre is soft, and the car rolls with 35 % more resistance."""
COMMUTER_BIAS_MPS2 = (0.05, -0.03, 0.02)


@dataclass(frozen=True, slots=True)
class DemoTrip:
    """A trip of the demo; each drives in another place, so that their roads don't cross.

    ``softer`` multiplies the rolling resistance of the car's file; ``bias_mps2`` is the accelerometer's, the same for
    all trips on which health is to be told; None draws it from the seed.
    """

    name: str
    car: str
    minutes: float
    route: RouteName
    seed: int
    lat_deg: float
    lon_deg: float
    day: int
    softer: float = 1.0
    bias_mps2: tuple[float, float, float] | None = None


TRIPS: Mapping[str, DemoTrip] = {
    "short trip": DemoTrip("Round the block", "Demo roadster", 4, "town", 11, 49.60, 6.12, 0),
    "town": DemoTrip("Errands in town", "Demo roadster", 20, "town", 12, 48.58, 7.75, 1),
    "motorway": DemoTrip("To the south", "Demo roadster", 25, "motorway", 13, 47.32, 5.04, 2),
    "full load": DemoTrip("Test of full load", "Demo roadster", 15, "full-load", 14, 45.90, 6.13, 4),
    "roof box": DemoTrip("With skis", "Demo roadster with a roof box", 20, "mixed", 15, 46.20, 7.36, 5),
    "mixed hour": DemoTrip("An hour across the land", "Demo roadster", 60, "mixed", 16, 50.36, 7.59, 7),
}


COMMUTER_TRIPS = tuple(
    DemoTrip(
        name=f"To work {number + 1}",
        car="Demo commuter",
        minutes=12,
        route="motorway" if number % 2 else "mixed",
        seed=101 + number,
        lat_deg=46.0 + 0.3 * number,
        lon_deg=7.0,
        day=number,
        softer=SOFTER if number >= SOFT_FROM else 1.0,
        bias_mps2=COMMUTER_BIAS_MPS2,
    )
    for number in range(COMMUTES)
)


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
    simulated = simulate_trip(trip, work)
    upload(work, simulated.elevation_csv, {"kind": "elevation", "filename": f"{trip.name} road.csv"})
    upload_trip(work, trip, simulated)
    return lambda session: None


def commute(work: StageWork) -> jobs.Store:
    """Drive the same car to work day after day, without altitudes, until a tyre gets soft."""
    for trip in COMMUTER_TRIPS:
        upload_trip(work, trip, simulate_trip(trip, work))
    return lambda session: None


def simulate_trip(trip: DemoTrip, work: StageWork) -> SimulatedTrip:
    """Drive a trip."""
    vehicle = CARS[trip.car]
    work.progress(0.0, f"{trip.name}: driving {trip.minutes:.0f} minutes")
    return simulate(
        Simulation(
            duration_s=trip.minutes * 60.0,
            seed=trip.seed,
            route=trip.route,
            vehicle=replace(vehicle, crr=trip.softer * vehicle.crr),
            start_lat_deg=trip.lat_deg,
            start_lon_deg=trip.lon_deg,
            started_at_utc_s=Simulation().started_at_utc_s + trip.day * DAY_S,
            bias_mps2=trip.bias_mps2,
        )
    )


def upload_trip(work: StageWork, trip: DemoTrip, simulated: SimulatedTrip) -> None:
    """Upload a trip to its car."""
    work.progress(0.7, f"{trip.name}: uploading {len(simulated.image) / 1e6:.1f} MB")
    with work.resources.database.transaction(work.fleet_id, read_only=True) as session:
        car_ids = {car.name: car.id for car in cars.page(session, limit=200).items}
    upload(work, simulated.image, {"car_id": car_ids[trip.car], "filename": f"{trip.name}.dat"})


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
    "commutes": commute,
}
"""Stages of a demo job by name; the short trip comes first, so that there is something to see soon."""
