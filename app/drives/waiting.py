"""Waiting for a drive to be solved. The web server solves nothing: it looks whether a worker has."""

from __future__ import annotations

import asyncio
import time

from starlette.concurrency import run_in_threadpool

from app.drives import service
from app.drives.models import Work
from app.drives.results import document_of
from app.drives.schemas import NewDrive, WholeDrive
from app.storage.resources import Resources

LOOK_EVERY_S = 0.05
UNDER_WAY = ("waiting", "solving")


def posed(resources: Resources, fleet_id: str, wanted: NewDrive) -> WholeDrive:
    """Keep a problem and have it solved, in a transaction of its own, so that a worker sees it while we wait."""
    with resources.database.transaction(fleet_id) as session:
        return service.pose(session, resources.blobs, wanted)


async def settled(resources: Resources, fleet_id: str, drive: WholeDrive, wait_s: float) -> WholeDrive:
    """Return a drive with its answer as soon as it is solved, or without one after a time.

    Raises
    ------
    PonthyError
        Why there is none, when it failed.
    """
    end = time.monotonic() + wait_s
    while time.monotonic() < end:
        await asyncio.sleep(LOOK_EVERY_S)
        found = await run_in_threadpool(_solved, resources, fleet_id, drive.id)
        if found is not None:
            return found
    return drive if wait_s == 0.0 else await run_in_threadpool(_as_it_is, resources, fleet_id, drive.id)


def _as_it_is(resources: Resources, fleet_id: str, drive_id: str) -> WholeDrive:
    with resources.database.transaction(fleet_id, read_only=True) as session:
        return service.whole(session, drive_id)


def _solved(resources: Resources, fleet_id: str, drive_id: str) -> WholeDrive | None:
    """Return a drive with its answer; None while somebody may still find one."""
    with resources.database.transaction(fleet_id, read_only=True) as session:
        if service.get(session, drive_id).state in UNDER_WAY:  # a problem may be long, so it is read at the end only
            return None
        found = service.whole(session, drive_id)
        found.answer = document_of(session, resources.blobs, service.row(session, drive_id), Work.SOLVE)
    return found
