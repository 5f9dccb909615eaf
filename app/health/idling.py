"""What a car burns standing still on each of its trips, from what the observe stage kept."""

from __future__ import annotations

from sqlalchemy.orm import Session

from app.cars import service as cars
from app.figures.idle_trend import TripIdle
from app.science.engine.idle import idle_of
from app.trips import service as trips

LONGEST_LIST = 200


def idle_by_trip(session: Session, car_id: str) -> list[TripIdle]:
    """Return what the latest trips that count say of idling, in driving order; raises `NotFound` without such a car."""
    vehicle = cars.config(session, car_id).vehicle
    driven = sorted(trips.observed_trips(session, car_id), key=lambda trip: (trip.began, trip.trip_id))
    known = [(trip, idle_of([trip.idle], vehicle)) for trip in driven if trip.in_map]
    told = [TripIdle(trip.trip_id, trip.name, trip.began.timestamp(), idle) for trip, idle in known if idle is not None]
    return told[-LONGEST_LIST:]
