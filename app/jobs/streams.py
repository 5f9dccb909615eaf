"""Server-sent events of jobs: what happened since the event the reader saw last, then whatever happens."""

from __future__ import annotations

import json
from collections import deque
from collections.abc import AsyncIterator, Sequence

import anyio
from sse_starlette import EventSourceResponse, ServerSentEvent
from starlette.concurrency import run_in_threadpool

from app.errors import NotFound
from app.jobs import repository
from app.jobs.models import OPEN_STATES, JobEvent
from app.storage.database import Database

POLL_S = 0.25
GRACE_S = 2.0
"""So long a stream may take to end when the server stops, which itself waits a little longer."""
OVERLAP = 100
"""On PostgreSQL an event may become visible after one with a greater id of another job; so far back is looked again."""


class JobEvents:
    """Events of one job, or of all jobs of a fleet.

    Parameters
    ----------
    database : Database
    fleet_id : str
    job_id : str or None
        One job, whose stream ends when the job is over; or None for all jobs, whose stream never ends.
    after : int
        Id of the last event the reader saw.
    """

    def __init__(self, database: Database, fleet_id: str, job_id: str | None, after: int) -> None:
        self._database = database
        self._fleet_id = fleet_id
        self._job_id = job_id
        self._start = self._after = after
        self._sent: deque[int] = deque(maxlen=2 * OVERLAP)

    def answer(self) -> EventSourceResponse:
        """Return the answer that carries the events; when the server stops, it comes to a proper end."""
        ending = anyio.Event()
        return EventSourceResponse(self.stream(ending), shutdown_event=ending, shutdown_grace_period=GRACE_S)

    async def stream(self, ending: anyio.Event) -> AsyncIterator[ServerSentEvent]:
        """Give events as they happen, until the job is over or the server stops."""
        while not ending.is_set():
            events, is_over = await run_in_threadpool(self.read)
            for event in events:
                yield _message(event)
            if is_over and not events:
                return
            with anyio.move_on_after(POLL_S):
                await ending.wait()

    def is_exhausted(self) -> bool:
        """Whether the job is over and its last event was seen; raises `NotFound` when there is no such job."""
        with self._database.transaction(self._fleet_id, read_only=True) as session:
            job = None if self._job_id is None else repository.job(session, self._job_id)
            if job is None:
                raise NotFound("job", str(self._job_id))
            rest = repository.events(session, after=self._after, job_id=self._job_id, limit=1)
        return job.state not in OPEN_STATES and not rest

    def read(self) -> tuple[Sequence[JobEvent], bool]:
        """Return the events since the last call, and whether the job is over."""
        since = self._after if self._job_id is not None else max(self._start, self._after - OVERLAP)
        with self._database.transaction(self._fleet_id, read_only=True) as session:
            job = None if self._job_id is None else repository.job(session, self._job_id)
            events = [e for e in repository.events(session, after=since, job_id=self._job_id) if e.id not in self._sent]
        for event in events:
            self._after = max(self._after, event.id)
            self._sent.append(event.id)
        return events, self._job_id is not None and (job is None or job.state not in OPEN_STATES)


def last_event_id(database: Database, fleet_id: str) -> int:
    """Return the id of the fleet's newest event."""
    with database.transaction(fleet_id, read_only=True) as session:
        return repository.last_event_id(session)


def _message(event: JobEvent) -> ServerSentEvent:
    data = {"job_id": event.job_id, "at": event.created_at.isoformat().replace("+00:00", "Z"), **event.data}
    return ServerSentEvent(json.dumps(data), event=event.kind, id=str(event.id))
