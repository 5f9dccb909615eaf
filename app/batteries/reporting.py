"""The report's runs: worked out by a job when somebody asks, and kept until the program changes."""

from __future__ import annotations

import json
from functools import partial
from typing import Any

from sqlalchemy.orm import Session

from app.batteries import repository
from app.batteries.keys import run_file
from app.batteries.models import BatteryRun, Work
from app.errors import Conflict, PonthyError, from_problem
from app.jobs import service as jobs
from app.jsonable import jsonable
from app.storage.base import now
from app.storage.blobs import Blobs
from app.storage.outbox import afterwards
from app.storage.resources import Resources

TITLE = "The report's runs of a battery"
DETAIL = "ten days, and a hundred days with fading capacity"
NO_REPORT = "The report's runs have not been made yet. POST to …/batteries/report; it takes a worker some seconds."


def ask_for_report(session: Session, code: str) -> jobs.JobView:
    """Have the report's runs made, unless this very program made them or is about to."""
    newest = repository.newest_run(session, None, Work.REPORT)
    if newest is not None:
        job = jobs.get(session, newest.job_id)
        made_by = (newest.provenance or {}).get("code_version")
        if not job.is_over or (job.state == "succeeded" and made_by == code):
            return job
    job = jobs.create_battery_job(session, stage=Work.REPORT, title=TITLE, battery_id=None, car_id=None)
    session.add(BatteryRun(job_id=job.id, work=Work.REPORT, options={}))
    session.flush()
    return job


def report(resources: Resources, fleet_id: str, job_id: str, progress: jobs.Progress) -> jobs.Store:
    """Make the report's runs."""
    from app.science.battery.reproduce import reproduce  # for workers only, which have room for its kernels

    document = reproduce(progress=lambda share: progress(share, DETAIL)).document()
    key = run_file(fleet_id, None, job_id)
    resources.blobs.put(key, json.dumps(jsonable(document), separators=(",", ":"), allow_nan=False).encode())
    made_at = now().isoformat().replace("+00:00", "Z")

    def store(session: Session) -> None:
        row = repository.run(session, job_id)
        if row is None:
            return
        before = repository.newest_run(session, None, Work.REPORT, done=True)
        if before is not None and before.document_key not in (None, key):
            afterwards(session, partial(resources.blobs.delete, before.document_key))
            before.document_key = None
        row.document_key = key
        row.provenance = {"code_version": resources.settings.code_version, "made_at": made_at}

    return store


def report_of(session: Session, blobs: Blobs) -> dict[str, Any]:
    """Return the newest report's runs.

    Raises
    ------
    PonthyError
        When there are none: nobody asked, they are still being made, or why they failed.
    """
    found = repository.newest_run(session, None, Work.REPORT, done=True)
    if found is None or found.document_key is None:
        raise _missing(session)
    document: dict[str, Any] = json.loads(blobs.get(found.document_key))
    return document | {"job_id": found.job_id, "provenance": found.provenance}


def _missing(session: Session) -> PonthyError:
    newest = repository.newest_run(session, None, Work.REPORT)
    if newest is None:
        return Conflict("no-report", NO_REPORT)
    job = jobs.get(session, newest.job_id)
    if job.problem is not None:
        return from_problem(job.problem)
    message = f"The report's runs are being made. Ask again soon, or follow job {job.id}."
    return PonthyError("report-not-ready", message, 409, headers={"Retry-After": "1"}, job_id=job.id)
