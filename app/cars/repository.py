"""SQL of the cars."""

from __future__ import annotations

from collections.abc import Sequence

from sqlalchemy import select
from sqlalchemy.orm import Session, undefer

from app.cars.models import Car, CarConfigRevision
from app.storage.locks import row_lock
from app.storage.paging import Page, newest_first


def car(session: Session, car_id: str, *, lock: bool = False) -> Car | None:
    """Return a car; with ``lock`` nobody else changes it until the transaction ends."""
    return session.get(Car, car_id, with_for_update=row_lock(lock), populate_existing=lock)


def cars(session: Session, cursor: str | None, limit: int) -> Page[Car]:
    """Return cars, newest first."""
    return newest_first(session, select(Car), Car.created_at, Car.id, cursor, limit)


def cars_with_ids(session: Session, car_ids: Sequence[str]) -> Sequence[Car]:
    """Return the cars with these identifiers, in no order."""
    return session.scalars(select(Car).where(Car.id.in_(car_ids))).all()


def configs_in_force(session: Session, car_ids: Sequence[str]) -> dict[str, bytes]:
    """Return the XML in force of each car."""
    rows = session.execute(
        select(CarConfigRevision.car_id, CarConfigRevision.xml)
        .join(Car, (Car.id == CarConfigRevision.car_id) & (Car.revision == CarConfigRevision.number))
        .where(Car.id.in_(car_ids))
    )
    return {row.car_id: row.xml for row in rows}


def revision(session: Session, car_id: str, number: int) -> CarConfigRevision | None:
    """Return one version of a car's XML."""
    of_number = (CarConfigRevision.car_id == car_id, CarConfigRevision.number == number)
    return session.scalars(select(CarConfigRevision).where(*of_number).options(undefer(CarConfigRevision.xml))).first()


def revisions(session: Session, car_id: str, cursor: str | None, limit: int) -> Page[CarConfigRevision]:
    """Return all versions of a car's XML, newest first."""
    statement = select(CarConfigRevision).where(CarConfigRevision.car_id == car_id)
    return newest_first(session, statement, CarConfigRevision.created_at, CarConfigRevision.id, cursor, limit)
