"""What webhooks hear of the jobs: each end of a trip's job once, and nothing of what was not stored."""

from __future__ import annotations

from typing import Any

import pytest

from app.accounts.models import DEFAULT_FLEET_ID as FLEET
from app.errors import NotFound
from app.jobs import service as jobs
from app.science.errors import DecodeError
from app.settings import Settings
from app.storage.resources import Resources
from app.webhooks import service as webhooks
from app.webhooks.models import EVENTS
from tests.yards import Yard
from workers.beats import look_after_jobs
from workers.pipeline import STAGES
from workers.running import Stage, StageWork, run_next_stage


def nothing(_work: StageWork) -> jobs.Store:
    return lambda _session: None


def failing(_work: StageWork) -> jobs.Store:
    raise DecodeError("no packet in this image", offset=12)


def gone(_work: StageWork) -> jobs.Store:
    def store(_session: object) -> None:
        raise NotFound("trip", "x")

    return store


@pytest.fixture
def yard(resources: Resources) -> Yard:
    return Yard(resources)


def listen(yard: Yard) -> str:
    with yard.resources.database.transaction(FLEET) as session:
        settings = yard.resources.settings
        return webhooks.add(session, settings, url="http://localhost:9/", events=EVENTS, description="").id


def heard(yard: Yard, webhook_id: str) -> list[tuple[str, dict[str, Any]]]:
    with yard.resources.database.transaction(FLEET, read_only=True) as session:
        rows = webhooks.deliveries(session, webhook_id, None, 50).items
        return [(row.event, row.payload["data"]) for row in reversed(rows)]


def run(yard: Yard, job_id: str, stage: Stage) -> str:
    return run_next_stage(yard.resources, FLEET, job_id, dict.fromkeys(STAGES, stage))


def test_a_trip_is_ready_when_its_last_stage_is_stored(yard: Yard) -> None:
    listener, job = listen(yard), yard.new_job()
    for stage in job.stages:
        assert heard(yard, listener) == [], stage.name
        assert run(yard, job.id, nothing) == "succeeded"
    ((event, data),) = heard(yard, listener)
    assert event == "trip.ready"
    assert (data["trip_id"], data["job_id"], data["car_id"]) == (yard.trip_id, job.id, yard.car_id)
    assert (data["name"], data["car_name"]) == ("trip", "car")
    assert "problem" not in data


def test_a_failed_trip_is_told_with_its_problem(yard: Yard) -> None:
    listener, job = listen(yard), yard.new_job()
    assert run(yard, job.id, failing) == "failed"
    ((event, data),) = heard(yard, listener)
    assert (event, data["problem"]["code"], data["problem"]["offset"]) == ("trip.failed", "undecodable-image", 12)


def test_a_result_that_cannot_be_stored_is_told_as_failed_only(yard: Yard) -> None:
    listener, job = listen(yard), yard.new_job()
    for _ in job.stages[:-1]:
        run(yard, job.id, nothing)
    assert run(yard, job.id, gone) == "failed"
    assert [event for event, _ in heard(yard, listener)] == ["trip.failed"]


def test_other_jobs_and_cancelled_ones_are_not_told(yard: Yard) -> None:
    listener, job = listen(yard), yard.new_job()
    with yard.resources.database.transaction(FLEET) as session:
        jobs.cancel(session, job.id)
        map_job = jobs.create_map_job(session, car_id=yard.car_id, title="map")
    while yard.job(map_job.id).state != "succeeded":
        assert run(yard, map_job.id, nothing) == "succeeded"
    assert heard(yard, listener) == []


def test_a_job_whose_workers_all_died_is_told_by_the_reaper(settings: Settings) -> None:
    resources = Resources.open(settings.model_copy(update={"attempts": 1}))
    yard = Yard(resources)
    listener, job = listen(yard), yard.new_job()
    yard.claim(job.id, lease_s=0.0)
    look_after_jobs(resources)
    ((event, data),) = heard(yard, listener)
    assert (event, data["job_id"], data["problem"]["code"]) == ("trip.failed", job.id, "worker-lost")
    resources.close()
