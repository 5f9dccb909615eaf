"""One stage of a job: done, stored together with its end, or ended with a problem that a person can read."""

from __future__ import annotations

import errno
import time
from collections.abc import Callable, Iterator

import pytest
from sqlalchemy.orm import Session

from app.accounts.models import DEFAULT_FLEET_ID as FLEET
from app.errors import NotFound
from app.jobs import service as jobs
from app.science.errors import DecodeError
from app.settings import Settings
from app.storage.resources import Resources
from app.trips import repository
from tests.yards import Yard
from workers.running import Stage, StageWork, run_next_stage

Body = Callable[[StageWork], None]


@pytest.fixture
def quick(settings: Settings) -> Iterator[Yard]:
    resources = Resources.open(settings.model_copy(update={"lease_s": 0.4}))
    yield Yard(resources)
    resources.close()


def note(yard: Yard, text: str) -> jobs.Store:
    def store(session: Session) -> None:
        trip = repository.trip(session, yard.trip_id)
        assert trip is not None
        trip.notes += text

    return store


def run(yard: Yard, job_id: str, body: Body, store: jobs.Store | None = None) -> str:
    def stage(work: StageWork) -> jobs.Store:
        body(work)
        return store or note(yard, work.claim.stage)

    stages: dict[tuple[str, str], Stage] = {("trip", name): stage for name in jobs.TRIP_STAGES}
    return run_next_stage(yard.resources, FLEET, job_id, stages)


def nothing(work: StageWork) -> None:
    """Do no work."""


def failing(error: Exception) -> Body:
    def body(_work: StageWork) -> None:
        raise error

    return body


def test_the_result_and_the_end_of_a_stage_are_stored_together(quick: Yard) -> None:
    job = quick.new_job()
    assert run(quick, job.id, nothing) == "succeeded"
    assert quick.trip().notes == "decode"

    def store(session: Session) -> None:
        note(quick, "half")(session)
        raise OSError(errno.EIO, "the store is gone")

    assert run(quick, job.id, nothing, store) == "failed"
    assert quick.trip().notes == "decode"
    assert quick.job(job.id).stages[1].state == "failed"


def test_a_job_that_is_over_or_somebody_elses_is_refused(quick: Yard) -> None:
    job = quick.new_job()
    quick.claim(job.id)
    assert run(quick, job.id, nothing) == "refused"
    assert run(quick, "0" * 32, nothing) == "refused"


@pytest.mark.parametrize(
    ("error", "code", "words"),
    [
        (DecodeError("Nothing but zeros.", 4096), "undecodable-image", "Nothing but zeros."),
        (NotFound("car", "x"), "not-found", "no car 'x'"),
        (OSError(errno.ENOSPC, "No space left on device"), "storage-full", "make room"),
        (MemoryError(), "out-of-memory", "memory"),
        (ZeroDivisionError("division by zero"), "internal-error", "fault in Ponthy"),
    ],
)
def test_whatever_ends_a_stage_becomes_a_problem(quick: Yard, error: Exception, code: str, words: str) -> None:
    job = quick.new_job()
    assert run(quick, job.id, failing(error)) == "failed"
    problem = quick.job(job.id).problem
    assert problem is not None
    assert problem["code"] == code
    assert words in problem["detail"]
    assert "division" not in problem["detail"]


def test_a_long_stage_keeps_its_lease(quick: Yard) -> None:
    job = quick.new_job()

    def body(_work: StageWork) -> None:
        time.sleep(1.0)
        with quick.resources.database.system_transaction() as session:
            assert jobs.recover(session, 3) == 0

    assert run(quick, job.id, body) == "succeeded"


def test_progress_is_told_and_its_last_word_kept(quick: Yard) -> None:
    job = quick.new_job()

    def body(work: StageWork) -> None:
        for number in range(1000):
            work.progress(number / 1000, f"{number} of 1000")

    run(quick, job.id, body)
    assert quick.job(job.id).stages[0].detail == "999 of 1000"
    with quick.resources.database.transaction(FLEET, read_only=True) as session:
        from app.jobs import repository as job_rows

        told = [e.data["progress"] for e in job_rows.events(session, after=0, job_id=job.id) if e.kind == "progress"]
    assert 1 <= len(told) < 50
    assert told == sorted(told)


def test_a_stage_notices_that_it_should_stop(quick: Yard) -> None:
    job = quick.new_job()

    def body(work: StageWork) -> None:
        with quick.resources.database.transaction(FLEET) as session:
            jobs.cancel(session, job.id)
        end = time.monotonic() + 20
        while time.monotonic() < end:
            work.progress(0.1)
            time.sleep(0.01)

    assert run(quick, job.id, body) == "cancelled"
    assert quick.job(job.id).state == "cancelled"
    assert quick.trip().notes == ""


def test_a_stage_notices_that_the_job_was_taken_from_it(quick: Yard) -> None:
    job = quick.new_job()

    def body(work: StageWork) -> None:
        with quick.resources.database.system_transaction() as session:
            jobs.recover(session, 3, everything=True)
        end = time.monotonic() + 20
        while time.monotonic() < end:
            work.progress(0.1)
            time.sleep(0.01)

    assert run(quick, job.id, body) == "lost"
    assert quick.job(job.id).stages[0].state == "waiting"
