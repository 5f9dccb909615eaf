"""SQL of the trips."""

from __future__ import annotations

from collections.abc import Collection, Sequence
from datetime import datetime

from sqlalchemy import ColumnElement, delete, func, select
from sqlalchemy.orm import Session, load_only

from app.storage.locks import row_lock
from app.storage.paging import Page, newest_first
from app.trips.models import Trip


def trip(session: Session, trip_id: str, *, lock: bool = False) -> Trip | None:
    """Return a trip; with ``lock`` nobody else changes it until the transaction ends."""
    return session.get(Trip, trip_id, with_for_update=row_lock(lock), populate_existing=lock)


def page(session: Session, car_id: str | None, cursor: str | None, limit: int) -> Page[Trip]:
    """Return one page of the trips, newest first."""
    query = select(Trip)
    if car_id is not None:
        query = query.where(Trip.car_id == car_id)
    return newest_first(session, query, Trip.created_at, Trip.id, cursor, limit)


def of_car(session: Session, car_id: str) -> Sequence[Trip]:
    """Return all trips of a car, in the order they came."""
    return session.scalars(select(Trip).where(Trip.car_id == car_id).order_by(Trip.created_at, Trip.id)).all()


def healthy_before(session: Session, trip: Trip, limit: int) -> Sequence[Trip]:
    """Return healthy trips of the same car that began before this one did, the latest first."""
    began, others = _began(), (Trip.car_id == trip.car_id, Trip.id != trip.id)
    fine = (Trip.observe_key.is_not(None), Trip.verdict == "healthy", began < (trip.started_at or trip.created_at))
    return session.scalars(select(Trip).where(*others, *fine).order_by(began.desc(), Trip.id).limit(limit)).all()


def latest_of_car(session: Session, car_id: str, limit: int) -> Sequence[Trip]:
    """Return the latest trips of a car, in the order they were driven."""
    latest = select(Trip).where(Trip.car_id == car_id).order_by(_began().desc(), Trip.id.desc()).limit(limit)
    return session.scalars(latest).all()[::-1]


def _began() -> ColumnElement[datetime]:
    """When a trip began; one without a clock counts from when it came."""
    return func.coalesce(Trip.started_at, Trip.created_at, type_=Trip.created_at.type)


def of_car_locked(session: Session, car_id: str) -> Sequence[Trip]:
    """Return all trips of a car; until the transaction ends nobody changes them or makes a job for one of them."""
    return session.scalars(select(Trip).where(Trip.car_id == car_id).order_by(Trip.id).with_for_update()).all()


def everything(session: Session) -> Sequence[Trip]:
    """Return all trips, read no further than to know where their files lie."""
    where = load_only(Trip.fleet_id, Trip.car_id, Trip.upload_id, Trip.decode_key, Trip.observe_key)
    return session.scalars(select(Trip).options(where).order_by(Trip.id)).all()


def with_ids(session: Session, trip_ids: Collection[str]) -> Sequence[Trip]:
    """Return those of some trips that are there, in no order."""
    return session.scalars(select(Trip).where(Trip.id.in_(trip_ids))).all()


def of_upload(session: Session, upload_id: str) -> Sequence[Trip]:
    """Return all trips of an upload, in the order of its segments."""
    return session.scalars(select(Trip).where(Trip.upload_id == upload_id).order_by(Trip.segment)).all()


def known_ids(session: Session, trip_ids: Collection[str]) -> set[str]:
    """Return those of some identifiers that are trips."""
    return set(session.scalars(select(Trip.id).where(Trip.id.in_(trip_ids))))


def known_uploads(session: Session, upload_ids: Collection[str]) -> set[str]:
    """Return those of some uploads that have a trip."""
    return set(session.scalars(select(Trip.upload_id).where(Trip.upload_id.in_(upload_ids)).distinct()))


def delete_of_car(session: Session, car_id: str) -> None:
    """Remove all trips of a car."""
    session.execute(delete(Trip).where(Trip.car_id == car_id))


def sums_of_cars(session: Session, car_ids: Collection[str]) -> dict[str, tuple[int, float, float, float]]:
    """Return, by car: number of trips, metres, litres, and the metres of the trips whose litres are known."""
    with_fuel = func.sum(Trip.distance_m).filter(Trip.fuel_l.is_not(None))
    rows = session.execute(
        select(Trip.car_id, func.count(), func.sum(Trip.distance_m), func.sum(Trip.fuel_l), with_fuel)
        .where(Trip.car_id.in_(car_ids))
        .group_by(Trip.car_id)
    )
    return {car: (count, metres or 0.0, litres or 0.0, fuelled or 0.0) for car, count, metres, litres, fuelled in rows}
