"""Workers are killed and frozen, their queue is deleted: every job is done nevertheless, and each stage counts once."""

from __future__ import annotations

import shutil
import signal

import pytest
import redis

from app.accounts.models import DEFAULT_FLEET_ID as FLEET
from app.jobs import service as jobs
from tests.workers.conftest import WorkYard


def forget_all_messages(yard: WorkYard) -> None:
    """Delete the queue's folder, or empty Redis."""
    url = yard.resources.settings.broker_url
    if url is None:
        shutil.rmtree(yard.resources.settings.queue_dir)
    else:
        redis.Redis.from_url(url.get_secret_value()).flushdb()


@pytest.mark.parametrize("stage", ["decode", "observe"])
def test_a_killed_workers_stage_runs_again(yard: WorkYard, stage: str) -> None:
    held = yard.hold(stage)
    worker = yard.start_worker()
    job_id = yard.new_job().id
    yard.until(lambda: yard.is_held(job_id, stage))
    worker.kill()
    held.unlink()
    yard.start_worker()
    yard.until(lambda: yard.job(job_id).state == "succeeded")
    assert yard.notes() == "decode observe map health battery score "


def test_a_frozen_workers_late_result_is_refused(yard: WorkYard) -> None:
    held = yard.hold("observe")
    frozen = yard.start_worker()
    job_id = yard.new_job().id
    yard.until(lambda: yard.is_held(job_id, "observe"))
    frozen.send_signal(signal.SIGSTOP)
    yard.start_worker()
    yard.until(lambda: yard.job(job_id).attempt == 2)
    held.unlink()
    yard.until(lambda: yard.job(job_id).state == "succeeded")
    frozen.send_signal(signal.SIGCONT)
    log = yard.folder / "worker-0.log"
    yard.until(lambda: "the result of this attempt was not taken" in log.read_text())
    assert yard.notes() == "decode observe map health battery score "


def test_jobs_survive_the_queue(yard: WorkYard) -> None:
    waiting = [yard.new_job().id for _ in range(3)]
    assert yard.resources.queue.size() == 3
    forget_all_messages(yard)
    yard.start_worker()
    yard.until(lambda: all(yard.job(job_id).state == "succeeded" for job_id in waiting))


def test_jobs_survive_a_queue_that_is_deleted_under_a_working_worker(yard: WorkYard) -> None:
    held = yard.hold("decode")
    worker = yard.start_worker()
    first = yard.new_job().id
    yard.until(lambda: yard.is_held(first, "decode"))
    second = yard.new_job().id
    forget_all_messages(yard)
    held.unlink()
    if yard.resources.settings.broker_url is None:
        assert worker.wait(20) != 0  # the broker's client can't live without its folder; the supervisor starts it again
        yard.start_worker()
    yard.until(lambda: {yard.job(first).state, yard.job(second).state} == {"succeeded"})


def test_a_running_job_stops_when_asked_to(yard: WorkYard) -> None:
    yard.hold("decode")
    yard.start_worker()
    job_id = yard.new_job().id
    yard.until(lambda: yard.is_held(job_id, "decode"))
    with yard.resources.database.transaction(FLEET) as session:
        jobs.cancel(session, job_id)
    yard.until(lambda: yard.job(job_id).state == "cancelled")
    assert yard.notes() == ""


def test_two_workers_share_the_work(yard: WorkYard) -> None:
    yard.start_worker()
    yard.start_worker()
    several = [yard.new_job().id for _ in range(6)]
    yard.until(lambda: all(yard.job(job_id).state == "succeeded" for job_id in several))
    assert sorted(yard.notes().split()) == [
        name for name in ("battery", "decode", "health", "map", "observe", "score") for _ in range(6)
    ]


def test_a_worker_stops_in_order(yard: WorkYard) -> None:
    worker = yard.start_worker()
    job_id = yard.new_job().id
    yard.until(lambda: yard.job(job_id).state == "succeeded")
    worker.terminate()
    assert worker.wait(20) == 0
