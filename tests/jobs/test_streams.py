"""Events of jobs as a stream: all of them, once, in order, resumed where the reader was."""

from __future__ import annotations

import asyncio
import json
from typing import Any

import anyio
import pytest

from app.accounts import service as accounts
from app.accounts.models import DEFAULT_FLEET_ID as FLEET
from app.errors import NotFound
from app.jobs import service as jobs
from app.jobs.models import JobEvent
from app.jobs.streams import JobEvents, last_event_id
from tests.yards import Yard


def work_off(yard: Yard, job_id: str) -> None:
    while (claim := yard.claim(job_id)) is not None:
        with yard.resources.database.transaction(FLEET) as session:
            jobs.finish(session, claim)


def events_of(yard: Yard, job_id: str | None, after: int, fleet_id: str = FLEET) -> JobEvents:
    return JobEvents(yard.resources.database, fleet_id, job_id, after)


def all_of(stream: JobEvents) -> list[dict[str, Any]]:
    async def collect() -> list[dict[str, Any]]:
        return [
            {"id": int(str(message.id)), "event": message.event, **json.loads(str(message.data))}
            async for message in stream.stream(anyio.Event())
        ]

    return asyncio.run(collect())


def test_a_jobs_stream_tells_everything_and_ends_with_the_job(yard: Yard) -> None:
    job = yard.new_job()
    work_off(yard, job.id)
    told = all_of(events_of(yard, job.id, 0))
    assert [event["id"] for event in told] == sorted({event["id"] for event in told})
    assert {event["job_id"] for event in told} == {job.id}
    assert [(e["name"], e["state"]) for e in told if e["event"] == "stage"] == [
        (name, state) for name in jobs.TRIP_STAGES for state in ("running", "succeeded")
    ]
    states = [event["state"] for event in told if event["event"] == "state"]
    assert (states[0], states[-1]) == ("queued", "succeeded")


def test_a_reader_goes_on_after_the_event_it_saw_last(yard: Yard) -> None:
    job = yard.new_job()
    work_off(yard, job.id)
    told = all_of(events_of(yard, job.id, 0))
    for seen in told:
        assert all_of(events_of(yard, job.id, seen["id"])) == [e for e in told if e["id"] > seen["id"]]
    assert events_of(yard, job.id, told[-1]["id"]).is_exhausted()
    assert not events_of(yard, job.id, told[-2]["id"]).is_exhausted()


def test_a_stream_follows_a_job_that_is_retried_after_it_was_over(yard: Yard) -> None:
    job = yard.new_job()
    with yard.resources.database.transaction(FLEET) as session:
        jobs.cancel(session, job.id)
    seen = all_of(events_of(yard, job.id, 0))[-1]["id"]
    with yard.resources.database.transaction(FLEET) as session:
        jobs.retry(session, job.id)
    stream = events_of(yard, job.id, seen)
    assert not stream.is_exhausted()
    work_off(yard, job.id)
    assert all_of(stream)[-1]["state"] == "succeeded"


def test_the_fleets_stream_tells_of_all_jobs_each_event_once(yard: Yard) -> None:
    stream = events_of(yard, None, last_event_id(yard.resources.database, FLEET))
    several = [yard.new_job().id for _ in range(3)]
    first, is_over = stream.read()
    work_off(yard, several[1])
    second, _ = stream.read()
    assert {event.job_id for event in first} == set(several)
    assert {event.job_id for event in second} == {several[1]}
    assert stream.read() == ([], False)
    assert not is_over


def test_an_event_that_becomes_visible_late_is_told_nevertheless(yard: Yard) -> None:
    job = yard.new_job()
    start = last_event_id(yard.resources.database, FLEET)
    with yard.resources.database.transaction(FLEET) as session:
        session.add(JobEvent(id=start + 10, job_id=job.id, kind="log", data={"message": "quick"}))
    stream = events_of(yard, None, start)
    assert [event.id for event in stream.read()[0]] == [start + 10]
    with yard.resources.database.transaction(FLEET) as session:
        session.add(JobEvent(id=start + 9, job_id=job.id, kind="log", data={"message": "slow to commit"}))
    assert [event.id for event in stream.read()[0]] == [start + 9]
    assert stream.read()[0] == []


def test_other_fleets_see_nothing(yard: Yard) -> None:
    job = yard.new_job()
    with yard.resources.database.system_transaction() as session:
        other = accounts.add_fleet(session, "others").id
    assert events_of(yard, None, 0, other).read()[0] == []
    with pytest.raises(NotFound):
        events_of(yard, job.id, 0, other).is_exhausted()


def test_a_stream_without_end_ends_when_the_server_stops(yard: Yard) -> None:
    job = yard.new_job()

    async def collect() -> list[int]:
        ending, seen = anyio.Event(), []
        async for message in events_of(yard, None, 0).stream(ending):
            seen.append(int(str(message.id)))
            ending.set()
        return seen

    async def in_time() -> list[int]:
        return await asyncio.wait_for(collect(), 10)

    assert asyncio.run(in_time()) == [event.id for event in events_of(yard, job.id, 0).read()[0]]
