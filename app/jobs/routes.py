"""The API of the jobs."""

from __future__ import annotations

from typing import Annotated, Any

from fastapi import APIRouter, Header, Query, Response
from sse_starlette import EventSourceResponse
from starlette.concurrency import run_in_threadpool

from app.edge import CurrentPrincipal, OpenResources, ReadSession, WriteSession
from app.jobs import service
from app.jobs.models import JobState
from app.jobs.schemas import JobView
from app.jobs.streams import JobEvents, last_event_id
from app.schemas import DEFAULT_LIMIT, Cursor, Id, Limit, Listing

router = APIRouter(tags=["jobs"])

LastEventId = Annotated[int | None, Header(alias="Last-Event-ID", ge=0, le=2**62)]
After = Annotated[int | None, Query(ge=0, le=2**62, description="Like Last-Event-ID, which goes first.")]
EVENTS: dict[int | str, dict[str, Any]] = {
    200: {"content": {"text/event-stream": {}}, "description": "Events `stage`, `progress`, `log` and `state`."}
}


@router.get("/jobs")
def list_jobs(
    session: ReadSession,
    state: JobState | None = None,
    trip_id: Annotated[str | None, Query(max_length=32)] = None,
    drive_id: Annotated[str | None, Query(max_length=32)] = None,
    battery_id: Annotated[str | None, Query(max_length=32)] = None,
    cursor: Cursor = None,
    limit: Limit = DEFAULT_LIMIT,
) -> Listing[JobView]:
    """List jobs, newest first."""
    about = {"trip_id": trip_id, "drive_id": drive_id, "battery_id": battery_id}
    return service.page(session, state=state, **about, cursor=cursor, limit=limit)


@router.get("/jobs/events", response_class=EventSourceResponse, responses=EVENTS)
async def follow_all_jobs(
    who: CurrentPrincipal, opened: OpenResources, last_event_id_seen: LastEventId = None, after: After = None
) -> EventSourceResponse:
    """Follow all jobs of the fleet from now on, or after the event that was seen last; ``data`` carries ``job_id``."""
    seen = last_event_id_seen if last_event_id_seen is not None else after
    if seen is None:
        seen = await run_in_threadpool(last_event_id, opened.database, who.fleet_id)
    return JobEvents(opened.database, who.fleet_id, None, seen).answer()


@router.get("/jobs/{job_id}")
def read_job(session: ReadSession, job_id: Id) -> JobView:
    """Return a job with its stages."""
    return service.get(session, job_id)


@router.get("/jobs/{job_id}/events", response_class=EventSourceResponse, responses=EVENTS)
async def follow_job(
    who: CurrentPrincipal,
    opened: OpenResources,
    job_id: Id,
    last_event_id_seen: LastEventId = None,
    after: After = None,
) -> Response:
    """Follow a job from its beginning, or after the event that was seen last; ends when the job is over.

    A reader that comes back although it has seen all of a finished job is answered 204, and so stops asking.
    """
    seen = last_event_id_seen if last_event_id_seen is not None else after or 0
    events = JobEvents(opened.database, who.fleet_id, job_id, seen)
    if await run_in_threadpool(events.is_exhausted):
        return Response(status_code=204)
    return events.answer()


@router.post("/jobs/{job_id}/cancel")
def cancel_job(session: WriteSession, job_id: Id) -> JobView:
    """Cancel a job: at once while it waits, otherwise as soon as its worker notices."""
    return service.cancel(session, job_id)


@router.post("/jobs/{job_id}/retry")
def retry_job(session: WriteSession, job_id: Id) -> JobView:
    """Run a failed or cancelled job again from the stage at which it ended."""
    return service.retry(session, job_id)


@router.post("/demo", status_code=202)
def fill_with_demo_cars(session: WriteSession) -> JobView:
    """Fill the fleet with virtual cars and their trips, in the background."""
    return service.create_demo_job(session)
