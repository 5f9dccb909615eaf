"""Who may work on a job, whose result counts, and what becomes of the jobs of dead workers."""

from __future__ import annotations

import time
from concurrent.futures import ThreadPoolExecutor
from datetime import timedelta

import pytest

from app.accounts.models import DEFAULT_FLEET_ID as FLEET
from app.errors import Conflict
from app.jobs import repository
from app.jobs import service as jobs
from app.jobs.models import Job, JobEvent
from app.storage.base import now
from app.storage.outbox import collected
from tests.yards import Yard

PROBLEM = {"code": "broken", "detail": "It broke."}


def recover(yard: Yard, attempts: int = 3, *, everything: bool = False) -> int:
    with yard.resources.database.system_transaction() as session:
        return jobs.recover(session, attempts, everything=everything)


def finish(yard: Yard, claim: jobs.Claim) -> None:
    with yard.resources.database.transaction(FLEET) as session:
        jobs.finish(session, claim)


def test_a_job_goes_through_its_stages_and_succeeds(yard: Yard) -> None:
    job = yard.new_job()
    stages = ["decode", "observe", "map", "health", "battery", "score"]
    assert (job.state, [s.name for s in job.stages]) == ("queued", stages)
    for stage in stages:
        claim = yard.claim(job.id)
        assert claim.stage == stage
        assert yard.job(job.id).current_stage == stage
        finish(yard, claim)
    done = yard.job(job.id)
    assert done.state == "succeeded"
    assert done.finished_at is not None
    assert [(s.state, s.progress) for s in done.stages] == [("succeeded", 1.0)] * 6
    assert yard.claim(job.id) is None


def test_of_many_workers_that_race_for_a_job_one_gets_it(yard: Yard) -> None:
    job = yard.new_job()
    with ThreadPoolExecutor(8) as pool:
        claims = list(pool.map(lambda _: yard.claim(job.id), range(16)))
    assert sum(claim is not None for claim in claims) == 1
    assert yard.job(job.id).attempt == 1


def test_a_late_result_is_refused_and_leaves_no_trace(yard: Yard) -> None:
    job = yard.new_job()
    slow = yard.claim(job.id, lease_s=0.01)
    time.sleep(0.02)
    assert recover(yard) == 1
    quick = yard.claim(job.id)
    late = [
        lambda session: jobs.finish(session, slow),
        lambda session: jobs.fail(session, slow, PROBLEM),
        lambda session: jobs.stop(session, slow),
        lambda session: jobs.renew(session, slow, 30.0),
        lambda session: jobs.advance(session, slow, 0.5, "half"),
    ]
    for change in late:
        with pytest.raises(jobs.LeaseLost), yard.resources.database.transaction(FLEET) as session:
            change(session)
    assert yard.job(job.id).stages[0].state == "running"
    finish(yard, quick)
    assert yard.job(job.id).stages[0].state == "succeeded"


def test_a_renewed_lease_is_left_alone(yard: Yard) -> None:
    claim = yard.claim(yard.new_job().id, lease_s=0.05)
    with yard.resources.database.transaction(FLEET) as session:
        jobs.renew(session, claim, 30.0)
    time.sleep(0.06)
    assert recover(yard) == 0
    finish(yard, claim)


def test_a_stage_that_keeps_losing_its_worker_fails_with_a_reason(yard: Yard) -> None:
    job = yard.new_job()
    for attempt in (1, 2, 3):
        assert yard.claim(job.id, lease_s=0.0).attempt == attempt
        assert recover(yard) == 1
    failed = yard.job(job.id)
    assert failed.state == "failed"
    assert failed.problem["code"] == "worker-lost"
    assert "3 times" in failed.problem["detail"]
    assert failed.stages[0].state == "failed"


def test_attempts_are_counted_per_stage(yard: Yard) -> None:
    job = yard.new_job()
    yard.claim(job.id, lease_s=0.0)
    recover(yard)
    finish(yard, yard.claim(job.id))
    assert yard.job(job.id).attempt == 0
    assert yard.claim(job.id).attempt == 1


def test_at_a_start_without_workers_every_held_job_is_freed(yard: Yard) -> None:
    job = yard.new_job()
    yard.claim(job.id, lease_s=1000.0)
    assert recover(yard) == 0
    for _ in range(5):  # being stopped is not the stage's fault, however often it happens
        assert recover(yard, everything=True) == 1
        assert yard.claim(job.id, lease_s=1000.0).attempt == 1


def test_the_steps_of_long_finished_jobs_are_forgotten_but_not_their_end(yard: Yard) -> None:
    long_over, just_over, again, running = (yard.new_job(yard.new_trip(name)) for name in "abcd")
    for job in (long_over, just_over, again, running):
        claim = yard.claim(job.id)
        with yard.resources.database.transaction(FLEET) as session:
            jobs.advance(session, claim, 0.5, "half")
        if job is not running:
            with yard.resources.database.transaction(FLEET) as session:
                jobs.fail(session, claim, PROBLEM)
    with yard.resources.database.transaction(FLEET) as session:
        for job in (long_over, again):
            repository.present(session, job.id).finished_at = now() - timedelta(days=31)
    with yard.resources.database.transaction(FLEET) as session:
        jobs.retry(session, again.id)
    before = {job.id: events(yard, job.id) for job in (long_over, just_over, again, running)}
    assert jobs.forget_steps(yard.resources.database, 30.0) == len(before[long_over.id]) - 1 > 3
    (end,) = events(yard, long_over.id)
    assert (end.kind, end.data["state"], end.data["problem"]) == ("state", "failed", PROBLEM)
    for job in (just_over, again, running):
        assert [e.id for e in events(yard, job.id)] == [e.id for e in before[job.id]]
    assert jobs.forget_steps(yard.resources.database, 30.0) == 0


def events(yard: Yard, job_id: str) -> list[JobEvent]:
    with yard.resources.database.transaction(FLEET, read_only=True) as session:
        return list(repository.events(session, after=0, job_id=job_id))


def test_a_waiting_job_is_cancelled_at_once(yard: Yard) -> None:
    job = yard.new_job()
    with yard.resources.database.transaction(FLEET) as session:
        assert jobs.cancel(session, job.id).state == "cancelled"
    assert yard.claim(job.id) is None
    with pytest.raises(Conflict), yard.resources.database.transaction(FLEET) as session:
        jobs.cancel(session, job.id)


def test_a_running_job_is_asked_to_stop(yard: Yard) -> None:
    job = yard.new_job()
    claim = yard.claim(job.id)
    with yard.resources.database.transaction(FLEET) as session:
        asked = jobs.cancel(session, job.id)
    assert (asked.state, asked.cancel_requested) == ("running", True)
    with pytest.raises(jobs.JobCancelled), yard.resources.database.transaction(FLEET) as session:
        jobs.renew(session, claim, 30.0)
    with pytest.raises(jobs.JobCancelled), yard.resources.database.transaction(FLEET) as session:
        jobs.advance(session, claim, 0.5, "half")
    with yard.resources.database.transaction(FLEET) as session:
        jobs.stop(session, claim)
    assert yard.job(job.id).state == "cancelled"


def test_a_job_asked_to_stop_ends_between_stages_or_with_its_worker(yard: Yard) -> None:
    between, orphan = yard.new_job(), yard.new_job()
    claim = yard.claim(between.id)
    yard.claim(orphan.id, lease_s=0.0)
    with yard.resources.database.transaction(FLEET) as session:
        jobs.cancel(session, between.id)
        jobs.cancel(session, orphan.id)
    finish(yard, claim)
    recover(yard)
    assert [yard.job(job.id).state for job in (between, orphan)] == ["cancelled", "cancelled"]
    assert [s.state for s in yard.job(between.id).stages] == ["succeeded", "cancelled", *["waiting"] * 4]


def test_a_retry_goes_on_from_the_stage_that_failed(yard: Yard) -> None:
    job = yard.new_job()
    finish(yard, yard.claim(job.id))
    with yard.resources.database.transaction(FLEET) as session:
        jobs.fail(session, yard.claim(job.id), PROBLEM)
    assert yard.job(job.id).problem == PROBLEM
    with yard.resources.database.transaction(FLEET) as session:
        again = jobs.retry(session, job.id)
    assert (again.state, again.problem, again.attempt) == ("queued", None, 0)
    assert [s.state for s in again.stages] == ["succeeded", *["waiting"] * 5]
    assert yard.claim(job.id).stage == "observe"


def test_only_what_ended_badly_can_be_retried(yard: Yard) -> None:
    job = yard.new_job()
    with pytest.raises(Conflict), yard.resources.database.transaction(FLEET) as session:
        jobs.retry(session, job.id)


def test_a_job_is_not_retried_while_another_one_works_on_the_trip(yard: Yard) -> None:
    old = yard.new_job()
    with yard.resources.database.transaction(FLEET) as session:
        jobs.cancel(session, old.id)
    yard.new_job()
    with pytest.raises(Conflict, match="still being worked on"), yard.resources.database.transaction(FLEET) as session:
        jobs.retry(session, old.id)


def test_a_forgotten_job_is_offered_again_once(yard: Yard) -> None:
    held, first, second = yard.new_job(), yard.new_job(), yard.new_job()
    yard.claim(held.id)
    time.sleep(0.02)
    with yard.resources.database.system_transaction() as session:
        assert jobs.redeliver(session, 10.0, messages=0) == 0  # they were offered just now
        assert jobs.redeliver(session, 0.01, messages=2) == 0  # there is a message for each
        assert jobs.redeliver(session, 0.01, messages=1) == 2  # one is lost, nobody knows which
        assert jobs.redeliver(session, 0.01, messages=1) == 0
        offered = [message.kwargs for message in collected(session)]
    assert offered == [{"fleet_id": FLEET, "job_id": job.id} for job in (first, second)]


def test_stages_that_were_done_elsewhere_are_not_run(yard: Yard) -> None:
    with yard.resources.database.transaction(FLEET) as session:
        job = jobs.create_trip_job(session, trip_id=yard.trip_id, car_id=yard.car_id, title="t", done=("decode",))
    assert yard.claim(job.id).stage == "observe"


def test_a_map_job_that_waits_serves_several_changes(yard: Yard) -> None:
    with yard.resources.database.transaction(FLEET) as session:
        first = jobs.create_map_job(session, car_id=yard.car_id, title="a")
        assert jobs.create_map_job(session, car_id=yard.car_id, title="b").id == first.id
    yard.claim(first.id)
    with yard.resources.database.transaction(FLEET) as session:
        assert jobs.create_map_job(session, car_id=yard.car_id, title="c").id != first.id


def test_the_queue_tells_how_many_messages_wait(yard: Yard) -> None:
    assert yard.resources.queue.size() == 0
    yard.new_job()
    yard.new_job()
    assert yard.resources.queue.size() == 2


def test_a_score_waits_for_everything_else_but_not_for_other_scores(yard: Yard) -> None:
    first, second = yard.new_job(), yard.new_job()
    ahead = len(jobs.TRIP_STAGES) - 1

    def put_off(job_id: str) -> bool:
        with yard.resources.database.transaction(FLEET) as session:
            return jobs.put_off(session, job_id)

    assert not put_off(first.id)
    for _ in range(ahead):
        finish(yard, yard.claim(first.id))
    queued = yard.resources.queue.size()
    assert put_off(first.id)
    assert yard.resources.queue.size() == queued + 1
    for _ in range(ahead):
        finish(yard, yard.claim(second.id))
    assert not put_off(first.id)
    assert yard.claim(first.id).stage == "score"


def test_a_cancelled_or_old_score_is_not_put_off(yard: Yard) -> None:
    old, cancelled, _waiting = yard.new_job(), yard.new_job(), yard.new_job()
    for job in (old, cancelled):
        for _ in range(len(jobs.TRIP_STAGES) - 1):
            finish(yard, yard.claim(job.id))
    with yard.resources.database.transaction(FLEET) as session:
        jobs.cancel(session, cancelled.id)
        session.get_one(Job, old.id).created_at -= timedelta(hours=1)
    with yard.resources.database.transaction(FLEET) as session:
        assert not jobs.put_off(session, cancelled.id)
        assert not jobs.put_off(session, old.id)
