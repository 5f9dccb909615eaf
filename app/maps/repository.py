"""SQL of the maps."""

from __future__ import annotations

from collections.abc import Collection, Sequence

from sqlalchemy import delete, func, select
from sqlalchemy.orm import Session, undefer

from app.maps.models import MapReference, MapRules, MapVersion, TripCells
from app.storage.paging import Page, newest_first


def cell_keys(session: Session, car_id: str) -> dict[str, str]:
    """Return which observer run the kept cells of each trip of a car are from."""
    rows = session.execute(select(TripCells.trip_id, TripCells.key).where(TripCells.car_id == car_id))
    return {row.trip_id: row.key for row in rows}


def cells_of(session: Session, trip_ids: Collection[str]) -> Sequence[TripCells]:
    """Return the cells of trips with their sums, in no order."""
    return session.scalars(
        select(TripCells).where(TripCells.trip_id.in_(trip_ids)).options(undefer(TripCells.sums))
    ).all()


def put_cells(session: Session, cells: TripCells) -> None:
    """Keep the cells of a trip instead of those kept before."""
    session.execute(delete(TripCells).where(TripCells.trip_id == cells.trip_id))
    session.add(cells)
    session.flush()


def version(session: Session, car_id: str, number: int | None) -> MapVersion | None:
    """Return a version of a car's map, the newest for None."""
    query = select(MapVersion).where(MapVersion.car_id == car_id).order_by(MapVersion.version.desc()).limit(1)
    return session.scalars(query if number is None else query.where(MapVersion.version == number)).first()


def page(session: Session, car_id: str, cursor: str | None, limit: int) -> Page[MapVersion]:
    """Return one page of a car's maps, newest first."""
    query = select(MapVersion).where(MapVersion.car_id == car_id)
    return newest_first(session, query, MapVersion.created_at, MapVersion.id, cursor, limit)


def newest_of_cars(session: Session, car_ids: Collection[str]) -> Sequence[MapVersion]:
    """Return the newest map of each car that has one."""
    newest = (
        select(MapVersion.car_id, func.max(MapVersion.version).label("version"))
        .where(MapVersion.car_id.in_(car_ids))
        .group_by(MapVersion.car_id)
        .subquery()
    )
    of_newest = (MapVersion.car_id == newest.c.car_id) & (MapVersion.version == newest.c.version)
    return session.scalars(select(MapVersion).join(newest, of_newest)).all()


def delete_of_car(session: Session, car_id: str) -> None:
    """Remove all maps of a car, the cells they are made from, its rules and its tables."""
    session.execute(delete(MapVersion).where(MapVersion.car_id == car_id))
    session.execute(delete(TripCells).where(TripCells.car_id == car_id))
    session.execute(delete(MapRules).where(MapRules.car_id == car_id))
    session.execute(delete(MapReference).where(MapReference.car_id == car_id))


def rules(session: Session, car_id: str) -> MapRules | None:
    """Return which trips count in a car's map, if somebody said so."""
    return session.get(MapRules, car_id)


def put_rules(session: Session, rules: MapRules) -> None:
    """Keep a car's rules instead of those kept before."""
    session.merge(rules)
    session.flush()


def references(session: Session, car_id: str, cursor: str | None, limit: int) -> Page[MapReference]:
    """Return one page of the tables laid over a car's maps, newest first."""
    query = select(MapReference).where(MapReference.car_id == car_id)
    return newest_first(session, query, MapReference.created_at, MapReference.id, cursor, limit)


def reference(session: Session, car_id: str, reference_id: str) -> MapReference | None:
    """Return a table of a car with its bytes."""
    of_car = select(MapReference).where(MapReference.id == reference_id, MapReference.car_id == car_id)
    return session.scalars(of_car.options(undefer(MapReference.data))).first()


def reference_with(session: Session, car_id: str, sha256: str, fuel: str) -> MapReference | None:
    """Return the table of a car that has these bytes and this fuel."""
    same = (MapReference.car_id == car_id, MapReference.sha256 == sha256, MapReference.fuel == fuel)
    return session.scalars(select(MapReference).where(*same)).first()
