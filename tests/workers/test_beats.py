"""What is done now and then goes on when a round goes wrong, and finds what was left behind."""

from __future__ import annotations

import threading
from datetime import timedelta

import pytest

from app.accounts.models import DEFAULT_FLEET_ID as FLEET
from app.jobs import repository
from app.jobs import service as jobs
from app.settings import Settings
from app.storage.base import now
from app.storage.outbox import collected
from app.storage.resources import Resources
from tests.yards import Yard
from workers.beats import Beat, look_after_jobs, tidy


def test_a_beat_goes_on_after_a_round_that_went_wrong() -> None:
    rounds: list[int] = []
    enough = threading.Event()

    def one_round() -> None:
        rounds.append(len(rounds))
        if len(rounds) >= 3:
            enough.set()
        raise ConnectionError("the database is away")

    with Beat("test", 0.01, one_round):
        assert enough.wait(10)
    assert rounds == list(range(len(rounds)))


def test_jobs_left_behind_are_found_and_jobs_that_are_well_are_left_alone(settings: Settings) -> None:
    resources = Resources.open(settings.model_copy(update={"redeliver_s": 0.01, "attempts": 2}))
    yard = Yard(resources)
    lost, dead, held = (yard.new_job() for _ in range(3))
    yard.claim(dead.id, lease_s=0.0)
    yard.claim(held.id, lease_s=60.0)
    with resources.database.transaction(FLEET) as session:
        unsent = jobs.create_map_job(session, car_id=yard.car_id, title="never sent")
        collected(session)  # the process died between the commit and the sending
    before = resources.queue.size()
    threading.Event().wait(0.05)
    look_after_jobs(resources)
    assert yard.job(dead.id).stages[0].state == "waiting"
    assert yard.job(held.id).stages[0].state == "running"
    assert resources.queue.size() > before
    assert {yard.job(job.id).state for job in (lost, unsent)} == {"queued"}
    resources.close()


def test_tidying_forgets_steps_and_removes_leftovers(settings: Settings) -> None:
    resources = Resources.open(settings.model_copy(update={"event_days": 1.0}))
    yard = Yard(resources)
    claim = yard.claim(yard.new_job().id)
    assert claim is not None
    with resources.database.transaction(FLEET) as session:
        jobs.fail(session, claim, {"code": "broken"})
        repository.present(session, claim.job_id).finished_at = now() - timedelta(days=2)
    leftover = f"fleets/{FLEET}/trips/{yard.trip_id}/old/states.parquet"
    resources.blobs.put(leftover, b"x")
    tidy(resources)
    with resources.database.transaction(FLEET, read_only=True) as session:
        (end,) = repository.events(session, after=0, job_id=claim.job_id)
    assert (end.kind, end.data["state"]) == ("state", "failed")
    assert not resources.blobs.exists(leftover)
    resources.close()


def test_nothing_is_locked_when_there_is_nothing_to_do(settings: Settings, monkeypatch: pytest.MonkeyPatch) -> None:
    resources = Resources.open(settings)
    yard = Yard(resources)
    yard.claim(yard.new_job().id)
    monkeypatch.setattr(jobs, "recover", lambda *_a, **_k: pytest.fail("took the write lock for nothing"))
    look_after_jobs(resources)
    resources.close()
