"""Workers are killed and frozen, their queue is deleted: every job is done nevertheless, and each stage counts once."""

from __future__ import annotations

import shutil
import signal
from typing import Any

import pytest

from app.accounts.models import DEFAULT_FLEET_ID as FLEET
from app.jobs import service as jobs


def running(yard: Any, job_id: str, stage: str) -> bool:
    job = yard.job(job_id)
    return job.state == "running" and job.current_stage == stage and job.stages[0].started_at is not None


@pytest.mark.parametrize("stage", ["decode", "observe"])
def test_a_killed_workers_stage_runs_again(yard: Any, stage: str) -> None:
    held = yard.hold(stage)
    worker = yard.start_worker()
    job_id = yard.new_job()
    yard.until(lambda: any(s.name == stage and s.detail == "held" for s in yard.job(job_id).stages))
    worker.kill()
    held.unlink()
    yard.start_worker()
    yard.until(lambda: yard.job(job_id).state == "succeeded")
    assert yard.notes() == "decode observe map "


def test_a_frozen_workers_late_result_is_refused(yard: Any) -> None:
    held = yard.hold("observe")
    frozen = yard.start_worker()
    job_id = yard.new_job()
    yard.until(lambda: any(s.name == "observe" and s.detail == "held" for s in yard.job(job_id).stages))
    frozen.send_signal(signal.SIGSTOP)
    yard.start_worker()
    yard.until(lambda: yard.job(job_id).attempt == 2)
    held.unlink()
    yard.until(lambda: yard.job(job_id).state == "succeeded")
    frozen.send_signal(signal.SIGCONT)
    log = yard.folder / "worker-0.log"
    yard.until(lambda: "the result of this attempt was not taken" in log.read_text())
    assert yard.notes() == "decode observe map "


def test_jobs_survive_the_queue(yard: Any) -> None:
    waiting = [yard.new_job() for _ in range(3)]
    shutil.rmtree(yard.resources.settings.queue_dir)
    yard.start_worker()
    yard.until(lambda: all(yard.job(job_id).state == "succeeded" for job_id in waiting))


def test_jobs_survive_a_queue_that_is_deleted_under_a_working_worker(yard: Any) -> None:
    held = yard.hold("decode")
    worker = yard.start_worker()
    first = yard.new_job()
    yard.until(lambda: any(s.detail == "held" for s in yard.job(first).stages))
    second = yard.new_job()
    shutil.rmtree(yard.resources.settings.queue_dir)
    held.unlink()
    assert worker.wait(20) != 0  # the broker's client can't live without its folder; the supervisor starts it again
    yard.start_worker()
    yard.until(lambda: {yard.job(first).state, yard.job(second).state} == {"succeeded"})


def test_a_running_job_stops_when_asked_to(yard: Any) -> None:
    yard.hold("decode")
    yard.start_worker()
    job_id = yard.new_job()
    yard.until(lambda: any(s.detail == "held" for s in yard.job(job_id).stages))
    with yard.resources.database.transaction(FLEET) as session:
        jobs.cancel(session, job_id)
    yard.until(lambda: yard.job(job_id).state == "cancelled")
    assert yard.notes() == ""


def test_two_workers_share_the_work(yard: Any) -> None:
    yard.start_worker()
    yard.start_worker()
    several = [yard.new_job() for _ in range(6)]
    yard.until(lambda: all(yard.job(job_id).state == "succeeded" for job_id in several))
    assert sorted(yard.notes().split()) == ["decode"] * 6 + ["map"] * 6 + ["observe"] * 6


def test_a_worker_stops_in_order(yard: Any) -> None:
    worker = yard.start_worker()
    job_id = yard.new_job()
    yard.until(lambda: yard.job(job_id).state == "succeeded")
    worker.terminate()
    assert worker.wait(20) == 0
