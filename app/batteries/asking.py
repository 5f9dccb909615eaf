"""Having work done about batteries, by jobs."""

from __future__ import annotations

from typing import Any

from sqlalchemy.orm import Session

from app.batteries import repository
from app.batteries.models import Battery, BatteryFile, BatteryRun, Work
from app.jobs import service as jobs

TITLES = {
    Work.ESTIMATE: "{name} from {file}",
    Work.REESTIMATE: "{name} from all its data",
    Work.CURVE: "Open-circuit curve of {name} from {file}",
}


def mend(session: Session, battery: Battery) -> None:
    """Have estimates made again that began with something else than what the one before them knows by now."""
    history = repository.history(session, battery.id)
    follows = [None if one.document_key is None else one.provenance.get("follows_key") for one in history]
    keys = [None, *(one.key for one in history)]
    if any(key != before for key, before in zip(follows, keys, strict=False)):
        ask(session, battery, Work.REESTIMATE)


def ask(
    session: Session,
    battery: Battery,
    work: Work,
    file: BatteryFile | None = None,
    options: dict[str, Any] | None = None,
) -> jobs.JobView:
    """Have something done about a battery; the same that is asked for already and still waits is not done twice."""
    wanted = options or {}
    newest = repository.newest_run(session, battery.id, work, file_id=None if file is None else file.id)
    if newest is not None and newest.options == wanted:
        before = jobs.get(session, newest.job_id)
        if before.state == "queued" or (before.state == "running" and file is not None):
            return before
    title = TITLES[work].format(name=battery.name, file="" if file is None else file.name)
    about = {"battery_id": battery.id, "car_id": battery.car_id}
    job = jobs.create_battery_job(session, stage=work, title=title[:300], **about)
    run = BatteryRun(job_id=job.id, battery_id=battery.id, work=work, options=wanted)
    run.file_id = None if file is None else file.id
    session.add(run)
    session.flush()
    return job
