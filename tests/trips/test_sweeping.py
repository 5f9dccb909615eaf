"""Files of runs that no trip refers to any more go; what an open job may still need stays."""

from __future__ import annotations

from concurrent.futures import ThreadPoolExecutor
from datetime import timedelta

import pytest
from sqlalchemy.orm import Session

from app.accounts.models import DEFAULT_FLEET_ID as FLEET
from app.jobs import service as jobs
from app.trips import service as trips
from app.trips.keys import INNOVATIONS, POINTS, STATES, recording_file, report_file, result_file
from app.trips.models import Trip
from tests.yards import Yard

PROBLEM = {"code": "broken", "detail": "It broke."}


@pytest.fixture
def two_runs(yard: Yard) -> tuple[set[str], set[str]]:
    """Files that the trip refers to, and files that an earlier code version left."""
    trip = yard.trip()
    files = []
    for run in ("new", "old"):
        decoded = {recording_file(trip, run, 0), report_file(trip, run)}
        files.append(decoded | {result_file(trip, run, name) for name in (STATES, POINTS, INNOVATIONS)})
    for key in files[0] | files[1]:
        yard.resources.blobs.put(key, b"x")
    yard.write(lambda session: refer(session, yard.trip_id, "new"))
    return files[0], files[1]


def refer(session: Session, trip_id: str, run: str) -> None:
    trip = session.get(Trip, trip_id)
    assert trip is not None
    trip.decode_key = trip.observe_key = run


def present(yard: Yard, files: set[str]) -> set[str]:
    return {key for key in files if yard.resources.blobs.exists(key)}


def swept(yard: Yard) -> int:
    return trips.sweep(yard.resources, FLEET, rest=timedelta(0))


def end(yard: Yard, claim: jobs.Claim) -> None:
    with yard.resources.database.transaction(FLEET) as session:
        jobs.fail(session, claim, PROBLEM)


def test_runs_that_no_trip_refers_to_are_removed(yard: Yard, two_runs: tuple[set[str], set[str]]) -> None:
    shown, old = two_runs
    assert swept(yard) == 2
    assert present(yard, shown) == shown
    assert present(yard, old) == set()
    assert swept(yard) == 0


def test_nothing_is_removed_while_a_job_of_the_car_is_open(yard: Yard, two_runs: tuple[set[str], set[str]]) -> None:
    shown, old = two_runs
    job = yard.new_job()
    assert swept(yard) == 0
    claim = yard.claim(job.id, lease_s=0.0)
    assert claim is not None
    assert swept(yard) == 0  # it may still be alive, though its lease is over
    with yard.resources.database.system_transaction() as session:
        assert jobs.recover(session, 3) == 1
    assert swept(yard) == 0
    assert present(yard, shown | old) == shown | old
    again = yard.claim(job.id)
    assert again is not None
    end(yard, again)
    assert trips.sweep(yard.resources, FLEET) == 0  # a backup that is being made may still want it
    assert swept(yard) == 2
    assert present(yard, shown | old) == shown


def test_a_map_that_is_being_made_keeps_what_it_may_read(yard: Yard, two_runs: tuple[set[str], set[str]]) -> None:
    _, old = two_runs
    with yard.resources.database.transaction(FLEET) as session:
        jobs.create_map_job(session, car_id=yard.car_id, title="map")
    assert swept(yard) == 0
    assert present(yard, old) == old


def test_a_folder_that_another_trip_of_the_upload_refers_to_stays(
    yard: Yard, two_runs: tuple[set[str], set[str]]
) -> None:
    first = yard.trip()

    def add(session: Session) -> None:
        described = {"input_key": first.input_key, "input_sha256": first.input_sha256, "input_bytes": 3, "options": {}}
        of_upload = {"car_id": first.car_id, "upload_id": first.upload_id, "segment": 1}
        session.add(Trip(**of_upload, **described, name="second", filename="trip.dat", decode_key="old"))

    yard.write(add)
    assert swept(yard) == 1
    assert yard.resources.blobs.exists(recording_file(first, "old", 0))
    assert not yard.resources.blobs.exists(result_file(first, "old", STATES))


def test_a_run_that_begins_while_it_is_swept_loses_nothing(yard: Yard, two_runs: tuple[set[str], set[str]]) -> None:
    """A job that finds the old folder and one that is refused it: whichever comes first, no trip shows a hole."""
    trip = yard.trip()

    def take_up_the_old_run() -> None:
        job = yard.new_job()
        claim = yard.claim(job.id)
        assert claim is not None
        if not yard.resources.blobs.exists(report_file(trip, "old")):
            for key in two_runs[1]:
                yard.resources.blobs.put(key, b"made again")
        with yard.resources.database.transaction(FLEET) as session:
            jobs.finish(session, claim)
            refer(session, yard.trip_id, "old")

    with ThreadPoolExecutor(4) as pool:
        sweeps = [pool.submit(swept, yard) for _ in range(3)]
        pool.submit(take_up_the_old_run).result()
        for sweep in sweeps:
            sweep.result()
    assert present(yard, two_runs[1]) == two_runs[1]
