"""SQL of the batteries."""

from __future__ import annotations

from collections.abc import Collection, Sequence
from datetime import datetime

from sqlalchemy import ColumnElement, and_, func, or_, select
from sqlalchemy.orm import Session, aliased

from app.batteries.models import Battery, BatteryEstimate, BatteryFile, BatteryRun, BatteryTest, Work
from app.storage.locks import row_lock
from app.storage.paging import Page, newest_first


def battery(session: Session, battery_id: str, *, lock: bool = False) -> Battery | None:
    """Return a battery; with ``lock`` nobody else changes it until the transaction ends."""
    return session.get(Battery, battery_id, with_for_update=row_lock(lock), populate_existing=lock)


def of_cars(session: Session, car_ids: Collection[str]) -> Sequence[Battery]:
    """Return the batteries of cars, in no order."""
    return session.scalars(select(Battery).where(Battery.car_id.in_(car_ids))).all()


def page(session: Session, car_id: str | None, cursor: str | None, limit: int) -> Page[Battery]:
    """Return one page of the batteries, newest first."""
    query = select(Battery)
    if car_id is not None:
        query = query.where(Battery.car_id == car_id)
    return newest_first(session, query, Battery.created_at, Battery.id, cursor, limit)


def known_ids(session: Session, battery_ids: Collection[str]) -> set[str]:
    """Return those of some identifiers that are batteries."""
    return set(session.scalars(select(Battery.id).where(Battery.id.in_(battery_ids))))


def files(session: Session, battery_id: str, cursor: str | None, limit: int) -> Page[BatteryFile]:
    """Return one page of the files that were sent for a battery, newest first."""
    query = select(BatteryFile).where(BatteryFile.battery_id == battery_id)
    return newest_first(session, query, BatteryFile.created_at, BatteryFile.id, cursor, limit)


def file(session: Session, file_id: str) -> BatteryFile | None:
    """Return a file."""
    return session.get(BatteryFile, file_id)


def known_files(session: Session, file_ids: Collection[str]) -> set[str]:
    """Return those of some identifiers that are files."""
    return set(session.scalars(select(BatteryFile.id).where(BatteryFile.id.in_(file_ids))))


def files_for(session: Session, battery_id: str, work: Work) -> Sequence[BatteryFile]:
    """Return all files that were sent for one kind of work, oldest first."""
    mine = (BatteryFile.battery_id == battery_id, BatteryFile.work == work)
    return session.scalars(select(BatteryFile).where(*mine).order_by(BatteryFile.created_at, BatteryFile.id)).all()


def same_file(session: Session, battery_id: str, work: Work, sha256: str) -> BatteryFile | None:
    """Return the file that has the very same bytes."""
    same = (BatteryFile.battery_id == battery_id, BatteryFile.work == work, BatteryFile.sha256 == sha256)
    return session.scalars(select(BatteryFile).where(*same)).first()


def estimate(session: Session, estimate_id: str) -> BatteryEstimate | None:
    """Return an estimate."""
    return session.get(BatteryEstimate, estimate_id)


def of_trip(session: Session, battery_id: str, trip_id: str) -> BatteryEstimate | None:
    """Return what a trip says of a battery."""
    mine = (BatteryEstimate.battery_id == battery_id, BatteryEstimate.trip_id == trip_id)
    return session.scalars(select(BatteryEstimate).where(*mine)).first()


def of_trips(session: Session, trip_ids: Collection[str]) -> Sequence[BatteryEstimate]:
    """Return what trips say of their cars' batteries."""
    return session.scalars(select(BatteryEstimate).where(BatteryEstimate.trip_id.in_(trip_ids))).all()


def of_file(session: Session, file_id: str) -> BatteryEstimate | None:
    """Return what a file says of its battery."""
    return session.scalars(select(BatteryEstimate).where(BatteryEstimate.file_id == file_id)).first()


def of_files(session: Session, file_ids: Collection[str]) -> Sequence[BatteryEstimate]:
    """Return what files say of their batteries."""
    return session.scalars(select(BatteryEstimate).where(BatteryEstimate.file_id.in_(file_ids))).all()


def has_key(session: Session, battery_id: str, key: str) -> bool:
    """Whether the very same was estimated before."""
    same = (BatteryEstimate.battery_id == battery_id, BatteryEstimate.key == key)
    return session.scalars(select(BatteryEstimate.id).where(*same).limit(1)).first() is not None


def history(session: Session, battery_id: str) -> Sequence[BatteryEstimate]:
    """Return all estimates of a battery that came to something, in the order of time."""
    mine = (BatteryEstimate.battery_id == battery_id, BatteryEstimate.document_key.is_not(None))
    ordered = select(BatteryEstimate).where(*mine).order_by(BatteryEstimate.began_at, _source())
    return session.scalars(ordered).all()


def _source() -> ColumnElement[str]:
    """What an estimate is about; it orders those that began at the same moment, however often they are made again."""
    return func.coalesce(BatteryEstimate.trip_id, BatteryEstimate.file_id)


def estimates(
    session: Session, battery_id: str, trip_id: str | None, cursor: str | None, limit: int
) -> Page[BatteryEstimate]:
    """Return one page of a battery's estimates, the latest first, of one trip or of all."""
    query = select(BatteryEstimate).where(BatteryEstimate.battery_id == battery_id)
    if trip_id is not None:
        query = query.where(BatteryEstimate.trip_id == trip_id)
    return newest_first(session, query, BatteryEstimate.began_at, BatteryEstimate.id, cursor, limit)


def before(session: Session, battery_id: str, moment: datetime, source_id: str) -> BatteryEstimate | None:
    """Return what stands before a source that began at a moment in the order of `history`; never of that source."""
    began, source = BatteryEstimate.began_at, _source()
    mine = (BatteryEstimate.battery_id == battery_id, BatteryEstimate.document_key.is_not(None), source != source_id)
    earlier = or_(began < moment, and_(began == moment, source < source_id))
    query = select(BatteryEstimate).where(*mine, earlier).order_by(began.desc(), source.desc())
    return session.scalars(query.limit(1)).first()


def newest(session: Session, battery_ids: Collection[str]) -> Sequence[BatteryEstimate]:
    """Return the latest estimate of each battery that has one."""
    place = func.row_number().over(
        partition_by=BatteryEstimate.battery_id,
        order_by=(BatteryEstimate.began_at.desc(), BatteryEstimate.id.desc()),
    )
    fit = (BatteryEstimate.battery_id.in_(battery_ids), BatteryEstimate.document_key.is_not(None))
    ranked = select(BatteryEstimate, place.label("place")).where(*fit).subquery()
    latest = aliased(BatteryEstimate, ranked)
    return session.scalars(select(latest).where(ranked.c.place == 1)).all()


def counts(session: Session, battery_ids: Collection[str]) -> dict[str, int]:
    """Return how many estimates of each battery came to something."""
    fit = (BatteryEstimate.battery_id.in_(battery_ids), BatteryEstimate.document_key.is_not(None))
    query = select(BatteryEstimate.battery_id, func.count()).where(*fit).group_by(BatteryEstimate.battery_id)
    return {row[0]: row[1] for row in session.execute(query)}


def tests(session: Session, battery_id: str, cursor: str | None, limit: int) -> Page[BatteryTest]:
    """Return one page of a battery's capacity tests, the latest first."""
    query = select(BatteryTest).where(BatteryTest.battery_id == battery_id)
    return newest_first(session, query, BatteryTest.at, BatteryTest.id, cursor, limit)


def all_tests(session: Session, battery_id: str) -> Sequence[BatteryTest]:
    """Return all capacity tests of a battery, in the order of time."""
    mine = select(BatteryTest).where(BatteryTest.battery_id == battery_id)
    return session.scalars(mine.order_by(BatteryTest.at, BatteryTest.id)).all()


def test(session: Session, battery_id: str, test_id: str) -> BatteryTest | None:
    """Return a capacity test of a battery."""
    mine = (BatteryTest.id == test_id, BatteryTest.battery_id == battery_id)
    return session.scalars(select(BatteryTest).where(*mine)).first()


def run(session: Session, job_id: str) -> BatteryRun | None:
    """Return what a job is about."""
    return session.get(BatteryRun, job_id)


def newest_run(
    session: Session, battery_id: str | None, work: Work, *, done: bool = False, file_id: str | None = None
) -> BatteryRun | None:
    """Return the newest run of a kind, of one file where that is said, with ``done`` the newest that has a result."""
    query = select(BatteryRun).where(BatteryRun.battery_id == battery_id, BatteryRun.work == work)
    if file_id is not None:
        query = query.where(BatteryRun.file_id == file_id)
    if done:
        query = query.where(BatteryRun.document_key.is_not(None))
    return session.scalars(query.order_by(BatteryRun.created_at.desc(), BatteryRun.job_id).limit(1)).first()


def runs_of_files(session: Session, file_ids: Collection[str]) -> Sequence[BatteryRun]:
    """Return what was asked about files, oldest first."""
    query = select(BatteryRun).where(BatteryRun.file_id.in_(file_ids))
    return session.scalars(query.order_by(BatteryRun.created_at, BatteryRun.job_id)).all()
