"""Scores as the API shows them."""

from __future__ import annotations

from typing import Any

from sqlalchemy.orm import Session

from app.cars import service as cars
from app.eco import repository, service
from app.eco.models import TripScoreRow
from app.eco.schemas import CarScore, RankBy, Ranked, ScoredTrip
from app.maps import service as maps
from app.schemas import Listing
from app.storage.blobs import Blobs
from app.trips import service as trips

NOTHING_YET = (
    "None of this car's trips has been scored yet. A trip is scored at the end of its job; older trips are scored when "
    "somebody asks for it."
)
NONE_OF_THEM = "None of this car's trips could be scored; each of them says why."


def trip(session: Session, blobs: Blobs, trip_id: str) -> dict[str, Any]:
    """Return a trip's whole score with what it was made from; raises `PonthyError` where there is none."""
    row = service.kept(session, trip_id)
    newest = maps.latest_of_cars(session, [row.car_id]).get(row.car_id)
    about = {name: getattr(row, name) for name in ("trip_id", "car_id", "map_version", "provenance", "code_version")}
    about |= {"fuel_l": row.fuel_l, "scored_at": row.scored_at.isoformat().replace("+00:00", "Z")}
    return service.document(blobs, row) | about | {"newest_map_version": None if newest is None else newest.version}


def car(session: Session, car_id: str) -> CarScore:
    """Return what all trips of a car say of its driving; raises `NotFound` when there is no such car."""
    cars.get(session, car_id)
    rows = {row.trip_id: row for row in repository.of_car(session, car_id)}
    observed = sorted(trips.observed_trips(session, car_id), key=lambda one: (one.began, one.trip_id))
    parts = [_part(one, rows.get(one.trip_id)) for one in observed]
    latest = next((part for part in reversed(parts) if part.score is not None), None)
    sums = repository.sums_of_car(session, car_id)
    newest = maps.latest_of_cars(session, [car_id]).get(car_id)
    numbers = ("score", "score_sd", "fuel_l", "saved_l", "saved_sd_l", "distance_m")
    return CarScore(
        car_id=car_id,
        **{name: None if sums is None else getattr(sums, name) for name in numbers},
        reason="" if sums is not None else NONE_OF_THEM if rows else NOTHING_YET,
        advice=[] if latest is None else rows[latest.trip_id].advice,
        advice_trip_id=None if latest is None else latest.trip_id,
        newest_map_version=None if newest is None else newest.version,
        trips=parts,
    )


def ranking(session: Session, by: RankBy, cursor: str | None, limit: int) -> Listing[Ranked]:
    """Return one page of the fleet's cars or trips, the best driven first."""
    page = repository.ranking(session, by, cursor, limit)
    ids = [sums.of for sums in page.items]
    car_of = {one: one for one in ids}
    trip_names: dict[str, str] = {}
    if by == "trip":
        car_of = {row.trip_id: row.car_id for row in repository.of_trips(session, ids)}
        trip_names = trips.names(session, ids)
    car_names = cars.names(session, list(set(car_of.values())))
    items = [
        Ranked(
            car_id=car_of[sums.of],
            car_name=car_names[car_of[sums.of]],
            trip_id=sums.of if by == "trip" else None,
            trip_name=trip_names.get(sums.of),
            trips=sums.trips,
            score=sums.score,
            score_sd=sums.score_sd,
            fuel_l=sums.fuel_l,
            saved_l=sums.saved_l,
            saved_sd_l=sums.saved_sd_l,
            distance_m=sums.distance_m,
        )
        for sums in page.items
    ]
    return Listing[Ranked](items=items, next_cursor=page.next_cursor)


def _part(trip: trips.ObservedTrip, row: TripScoreRow | None) -> ScoredTrip:
    kept = (name for name in ScoredTrip.model_fields if name not in ("trip_id", "name", "started_at", "reason"))
    told = {name: None if row is None else getattr(row, name) for name in kept}
    reason = service.NOT_YET if row is None else row.reason
    return ScoredTrip(trip_id=trip.trip_id, name=trip.name, started_at=trip.started_at, reason=reason, **told)
