"""Waiting for the job of a file that was sent. The web server estimates nothing: it looks whether a worker has."""

from __future__ import annotations

import asyncio
import time

from starlette.concurrency import run_in_threadpool

from app.batteries import service
from app.batteries.schemas import Received
from app.errors import from_problem
from app.jobs import service as jobs
from app.storage.resources import Resources

LOOK_EVERY_S = 0.05


async def settled(resources: Resources, fleet_id: str, taken: Received, wait_s: float) -> Received:
    """Return what became of a file as soon as its job is over, or how far it is after a time.

    Raises
    ------
    PonthyError
        Why nothing came of it, when the job failed.
    """
    end = time.monotonic() + wait_s
    found = taken
    while time.monotonic() < end and found.job is not None and not found.job.is_over:
        await asyncio.sleep(LOOK_EVERY_S)
        found = await run_in_threadpool(_look, resources, fleet_id, taken)
    if found.job is not None and found.job.problem is not None:
        raise from_problem(found.job.problem | {"file_id": taken.file.id, "job_id": found.job.id})
    return found


def _look(resources: Resources, fleet_id: str, taken: Received) -> Received:
    if taken.job is None:
        return taken
    with resources.database.transaction(fleet_id, read_only=True) as session:
        job = jobs.get(session, taken.job.id)
        return service.now_of(session, taken.file.id, job, duplicate=taken.duplicate) if job.is_over else taken
