"""Running one stage of a job: take it, hold it, do it, and store its result together with its end."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass

import structlog

from app.errors import PonthyError, Problem, from_os, from_science, problem
from app.jobs import service as jobs
from app.science.errors import ScienceError
from app.storage.locks import persist
from app.storage.resources import Resources
from workers.announcing import announce
from workers.holding import Hold

log = structlog.get_logger(__name__)


@dataclass(frozen=True, slots=True)
class StageWork:
    """What a stage is given to work with."""

    resources: Resources
    fleet_id: str
    claim: jobs.Claim
    progress: jobs.Progress


Stage = Callable[[StageWork], jobs.Store]
"""Does the work of a stage and returns what stores its result."""


def run_next_stage(resources: Resources, fleet_id: str, job_id: str, stages: Mapping[tuple[str, str], Stage]) -> str:
    """Run the next stage of a job, if it can be had.

    Parameters
    ----------
    resources : Resources
    fleet_id, job_id : str
    stages : mapping of (kind of job, name of stage) to Stage

    Returns
    -------
    str
        ``put off`` when the stage can wait and others can't, ``refused`` when somebody else has the job or it is over,
        else ``succeeded``, ``failed``, ``cancelled``, or
        ``lost`` when the lease ran out and the result was not taken.
    """
    database, lease_s = resources.database, resources.settings.lease_s
    with database.transaction(fleet_id) as session:
        if jobs.put_off(session, job_id):
            return "put off"
        claim = jobs.claim(session, job_id, lease_s)
    if claim is None:
        return "refused"
    structlog.contextvars.bind_contextvars(stage=claim.stage, trip_id=claim.trip_id, attempt=claim.attempt)
    try:
        with Hold(database, fleet_id, claim, lease_s) as hold:
            return _run(StageWork(resources, fleet_id, claim, hold.progress), stages[claim.kind, claim.stage], hold)
    except jobs.LeaseLost:
        log.warning("the lease ran out; the result of this attempt was not taken")
        return "lost"


def _run(work: StageWork, stage: Stage, hold: Hold) -> str:
    database, claim = work.resources.database, work.claim
    try:
        store = stage(work)
        persist(lambda: _store(work, store, hold.detail))
    except jobs.LeaseLost:
        raise
    except jobs.JobCancelled:
        with database.transaction(work.fleet_id) as session:
            jobs.stop(session, claim)
        return "cancelled"
    except Exception as error:  # noqa: BLE001 - the edge: whatever it was becomes a problem that the page can show
        with database.transaction(work.fleet_id) as session:
            jobs.fail(session, claim, problem_of(error))
            announce(session, work.fleet_id, claim.job_id)
        return "failed"
    return "succeeded"


def _store(work: StageWork, store: jobs.Store, detail: str | None) -> None:
    with work.resources.database.transaction(work.fleet_id) as session:
        jobs.finish(session, work.claim, detail)
        store(session)
        announce(session, work.fleet_id, work.claim.job_id)


def problem_of(error: Exception) -> Problem:
    """Return the problem document of whatever ended a stage."""
    match error:
        case PonthyError():
            return problem(error)
        case ScienceError():
            return problem(from_science(error))
        case MemoryError():
            message = "There is not enough memory for this trip. Free some or use a larger machine, then retry the job."
            return problem(PonthyError("out-of-memory", message, 507))
        case OSError() if (known := from_os(error)) is not None:
            return problem(known)
    log.error("stage failed", exc_info=error)
    message = (
        "This is a fault in Ponthy, not in the data. The server's log has the details under this job's id; "
        "retrying helps if the cause was passing, such as a database that didn't answer."
    )
    return problem(PonthyError("internal-error", message, 500))
