"""A session of one fleet sees and writes that fleet's rows, whatever the statement looks like."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import pytest
from sqlalchemy import delete, exists, func, insert, select, text, true, union_all, update
from sqlalchemy.orm import Session, aliased

from app.accounts import service as accounts
from app.accounts.models import Fleet
from app.cars.models import Car, CarConfigRevision
from app.storage.resources import Resources
from app.storage.tenancy import TenancyError


@pytest.fixture
def fleets(resources: Resources) -> tuple[str, str]:
    """Return two fleets, each with one car named after it."""
    with resources.database.system_transaction() as session:
        ours, theirs = accounts.add_fleet(session, "ours").id, accounts.add_fleet(session, "theirs").id
    for fleet_id, name in ((ours, "ours"), (theirs, "theirs")):
        with resources.database.transaction(fleet_id) as session:
            session.add(Car(name=name, title=name, revision=1, config_sha256="", load_kg=75.0))
    return ours, theirs


other = aliased(Car)
names = select(Car.name).cte()

READINGS: list[Callable[[Session], Any]] = [
    lambda s: s.scalars(select(Car.name)).all(),
    lambda s: s.execute(select(Car.name, func.count()).group_by(Car.name)).scalars().all(),
    lambda s: s.scalars(select(other.name)).all(),
    lambda s: s.scalars(select(select(Car.name).subquery().c.name)).all(),
    lambda s: s.scalars(select(names.c.name)).all(),
    lambda s: s.execute(select(names.c.name).select_from(Fleet).join(names, true())).scalars().unique().all(),
    lambda s: s.scalars(union_all(select(Car.name), select(Car.title))).unique().all(),
    lambda s: s.scalars(select(Car.name).where(Car.id.in_(select(other.id)))).all(),
    lambda s: [s.scalar(select(Car.name).order_by(Car.name.desc()).limit(1))],
]


@pytest.mark.parametrize("reading", READINGS)
def test_every_kind_of_select_sees_own_rows_only(
    resources: Resources, fleets: tuple[str, str], reading: Callable[[Session], Any]
) -> None:
    for fleet_id, name in zip(fleets, ("ours", "theirs"), strict=True):
        with resources.database.transaction(fleet_id, read_only=True) as session:
            assert list(reading(session)) == [name]


def test_existence_and_counts_are_of_own_rows(resources: Resources, fleets: tuple[str, str]) -> None:
    with resources.database.transaction(fleets[0]) as session:
        assert session.scalar(select(func.count()).select_from(Car)) == 1
        assert session.scalar(select(func.count(Car.id))) == 1
        owners = select(Fleet.name).where(exists().where(Car.fleet_id == Fleet.id))
        assert session.scalars(owners).all() == ["ours"]


def test_a_foreign_row_is_not_found_by_its_key(resources: Resources, fleets: tuple[str, str]) -> None:
    with resources.database.transaction(fleets[1]) as session:
        foreign = session.scalars(select(Car.id)).one()
    with resources.database.transaction(fleets[0]) as session:
        assert session.get(Car, foreign) is None


def test_updates_and_deletes_touch_own_rows_only(resources: Resources, fleets: tuple[str, str]) -> None:
    with resources.database.transaction(fleets[0]) as session:
        session.execute(update(Car).values(title="changed"))
        session.execute(delete(Car).where(Car.name == "theirs"))
    with resources.database.system_transaction() as session:
        titles = {row.name: row.title for row in session.execute(select(Car.name, Car.title))}
    assert titles == {"ours": "changed", "theirs": "theirs"}


def test_a_new_row_is_stamped_with_the_sessions_fleet(resources: Resources, fleets: tuple[str, str]) -> None:
    with resources.database.transaction(fleets[0]) as session:
        car = session.scalars(select(Car)).one()
        revision = CarConfigRevision(car_id=car.id, number=1, sha256="", xml=b"")
        session.add(revision)
        session.flush()
        assert revision.fleet_id == fleets[0]


def test_a_foreign_row_is_refused(resources: Resources, fleets: tuple[str, str]) -> None:
    stolen = Car(name="x", title="x", revision=1, config_sha256="", load_kg=75.0, fleet_id=fleets[1])
    with pytest.raises(TenancyError, match="can't write"), resources.database.transaction(fleets[0]) as session:
        session.add(stolen)


@pytest.mark.parametrize(
    "statement",
    [
        text("SELECT name FROM cars"),
        select(Car.__table__),
        insert(Car).values(name="x"),
        select(exists().where(true())),
    ],
)
def test_what_can_not_be_filtered_is_refused(resources: Resources, fleets: tuple[str, str], statement: Any) -> None:
    with pytest.raises(TenancyError), resources.database.transaction(fleets[0]) as session:
        session.execute(statement)


def test_a_reading_session_does_not_write(resources: Resources, fleets: tuple[str, str]) -> None:
    with (
        pytest.raises(TenancyError, match="only reads"),
        resources.database.transaction(fleets[0], read_only=True) as session,
    ):
        session.execute(update(Car).values(name="x"))
    with (
        pytest.raises(TenancyError, match="only reads"),
        resources.database.transaction(fleets[0], read_only=True) as session,
    ):
        session.scalars(select(Car)).one().name = "x"


def test_a_session_without_a_fleet_is_no_fleets_session(resources: Resources) -> None:
    with resources.database.system_transaction() as session, pytest.raises(TenancyError, match="has no fleet"):
        accounts.own_fleet(session)
