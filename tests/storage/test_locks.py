"""Two transactions that wait for each other: one is undone by the database, and done again."""

from __future__ import annotations

import threading

import psycopg.errors
import pytest
from sqlalchemy.exc import OperationalError

from app.accounts.models import DEFAULT_FLEET_ID as FLEET
from app.storage.locks import ATTEMPTS, persist
from app.storage.resources import Resources
from app.trips import repository
from tests.yards import Yard


def undone(kind: type[psycopg.Error]) -> OperationalError:
    return OperationalError("UPDATE", {}, kind())


def test_what_the_database_undid_is_done_again() -> None:
    runs: list[int] = []

    def work() -> None:
        runs.append(1)
        if len(runs) < ATTEMPTS:
            raise undone(psycopg.errors.DeadlockDetected)

    persist(work)
    assert len(runs) == ATTEMPTS


@pytest.mark.parametrize(("kind", "runs"), [("DeadlockDetected", ATTEMPTS), ("AdminShutdown", 1)])
def test_what_never_works_is_raised_in_the_end(kind: str, runs: int) -> None:
    seen: list[int] = []

    def work() -> None:
        seen.append(1)
        raise undone(getattr(psycopg.errors, kind))

    with pytest.raises(OperationalError):
        persist(work)
    assert len(seen) == runs


def test_two_that_refer_to_a_trip_can_both_lock_it(resources: Resources) -> None:
    """Each holds a key-share lock on the trip, as a worker does who changed its job twice, then locks the trip."""
    yard = Yard(resources)
    database, referred = yard.resources.database, threading.Barrier(2, timeout=20)
    concurrent = database.engine.dialect.name == "postgresql"  # SQLite has one writer at a time, so none to wait for

    def add(word: str) -> None:
        with database.transaction(FLEET) as session:
            if concurrent:
                session.connection().exec_driver_sql("SELECT id FROM trips FOR KEY SHARE")
                referred.wait()
            trip = repository.trip(session, yard.trip_id, lock=True)
            assert trip is not None
            trip.notes += word

    threads = [threading.Thread(target=add, args=(word,)) for word in ("one ", "two ")]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert sorted(yard.trip().notes.split()) == ["one", "two"]
