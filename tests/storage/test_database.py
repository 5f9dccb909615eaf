"""Transactions: what is sent is committed, what fails leaves nothing, and writers wait for each other."""

from __future__ import annotations

from concurrent.futures import ThreadPoolExecutor
from datetime import UTC, datetime, timedelta, timezone

import pytest
from sqlalchemy import func, select
from sqlalchemy.exc import IntegrityError, StatementError

from app.accounts.models import DEFAULT_FLEET_ID, ApiToken, Fleet
from app.cars.models import Car
from app.settings import Settings
from app.storage.database import Database, afterwards, enqueue
from app.storage.outbox import Message
from app.storage.resources import Resources


def new_car(name: str = "car") -> Car:
    return Car(name=name, title=name, revision=1, config_sha256="", load_kg=75.0)


def test_messages_are_sent_after_the_commit(settings: Settings) -> None:
    seen: list[tuple[Message, int]] = []

    def send(message: Message) -> None:
        with other.system_transaction(read_only=True) as session:
            seen.append((message, session.scalar(select(func.count(Car.id))) or 0))

    other, database = Database(settings.database), Database(settings.database, send)
    with database.transaction(DEFAULT_FLEET_ID) as session:
        session.add(new_car())
        enqueue(session, "ponthy.something", number=1)
        session.flush()
        assert seen == []
    assert seen == [(Message("ponthy.something", {"number": 1}), 1)]
    database.close()
    other.close()


def test_what_fails_sends_and_leaves_nothing(settings: Settings) -> None:
    sent: list[Message] = []
    done: list[str] = []
    database = Database(settings.database, sent.append)

    def fail() -> None:
        with database.transaction(DEFAULT_FLEET_ID) as session:
            session.add(new_car())
            enqueue(session, "ponthy.something")
            afterwards(session, lambda: done.append("x"))
            session.flush()
            raise ZeroDivisionError

    with pytest.raises(ZeroDivisionError):
        fail()
    with database.system_transaction() as session:
        assert session.scalar(select(func.count(Car.id))) == 0
    assert (sent, done) == ([], [])
    database.close()


def test_a_queue_that_refuses_does_not_undo_the_commit(settings: Settings) -> None:
    def refuse(_: Message) -> None:
        raise ConnectionError("the broker is down")

    done: list[str] = []
    database = Database(settings.database, refuse)
    with database.transaction(DEFAULT_FLEET_ID) as session:
        session.add(new_car())
        enqueue(session, "ponthy.something")
        afterwards(session, lambda: done.append("x"))
    with database.system_transaction() as session:
        assert session.scalar(select(func.count(Car.id))) == 1
    assert done == ["x"]
    database.close()


def test_many_writers_wait_for_each_other(resources: Resources) -> None:
    with resources.database.transaction(DEFAULT_FLEET_ID) as session:
        car = new_car("0")
        session.add(car)

    def count_up(_: int) -> None:
        with resources.database.transaction(DEFAULT_FLEET_ID) as session:
            row = session.get(Car, car.id, with_for_update=True)
            assert row is not None
            row.name = str(int(row.name) + 1)

    with ThreadPoolExecutor(12) as threads:
        list(threads.map(count_up, range(60)))
    with resources.database.transaction(DEFAULT_FLEET_ID, read_only=True) as session:
        assert session.scalars(select(Car.name)).one() == "60"


def test_readers_do_not_wait_for_a_writer(resources: Resources) -> None:
    with resources.database.transaction(DEFAULT_FLEET_ID) as writing:
        writing.add(new_car())
        writing.flush()
        with resources.database.transaction(DEFAULT_FLEET_ID, read_only=True) as reading:
            assert reading.scalar(select(func.count(Car.id))) == 0


def test_times_come_back_aware_and_in_utc(resources: Resources) -> None:
    moment = datetime(2009, 10, 27, 7, 41, 0, 123456, tzinfo=timezone(timedelta(hours=2)))
    with resources.database.system_transaction() as session:
        session.add(Fleet(id="f" * 32, name="f", created_at=moment))
    with resources.database.system_transaction() as session:
        kept = session.get_one(Fleet, "f" * 32).created_at
    assert kept == moment
    assert kept.tzinfo is UTC


def test_a_time_without_a_zone_is_refused(resources: Resources) -> None:
    naive = datetime(2009, 10, 27)  # noqa: DTZ001 - the fault under test
    token = ApiToken(name="x", prefix="x", secret_hash="x", scope="read", created_at=naive)  # noqa: S106 - no secret
    with (
        pytest.raises(StatementError, match="has no time zone"),
        resources.database.transaction(DEFAULT_FLEET_ID) as session,
    ):
        session.add(token)


def test_foreign_keys_hold(resources: Resources) -> None:
    car = new_car()
    car.fleet_id = "e" * 32
    with pytest.raises(IntegrityError, match=r"(?i)foreign key"), resources.database.system_transaction() as session:
        session.add(car)
