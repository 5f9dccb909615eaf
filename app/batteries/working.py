"""What workers do about batteries: estimate a trip or a file, estimate everything again, fit a curve, make the report.

Estimates of one battery follow each other in time, each beginning with what the one before it knew. One that comes late
is put in its place, and those after it are made again by a job of their own.
"""

from __future__ import annotations

from functools import partial

import structlog
from sqlalchemy.orm import Session

from app.batteries import repository, sources
from app.batteries.asking import mend
from app.batteries.estimating import answer, question
from app.batteries.fitting import fit
from app.batteries.keeping import forget, keep, refuse
from app.batteries.models import Battery, BatteryEstimate, Work
from app.batteries.reporting import report
from app.batteries.schemas import EstimateView
from app.batteries.sources import Source
from app.errors import PonthyError
from app.jobs import service as jobs
from app.science.errors import ScienceError
from app.storage.locks import persist
from app.storage.resources import Resources
from app.trips import service as trips
from app.webhooks import service as webhooks

FAULT = "Estimating itself failed: {error}. The server's log says more; the trip can be run again."
UNREADABLE = "The stored measurements can't be read; run the trip again, or send the file again."

log = structlog.get_logger(__name__)


def run(
    resources: Resources, fleet_id: str, battery_id: str | None, job_id: str, progress: jobs.Progress
) -> jobs.Store:
    """Do what a job asks about a battery, or the report's runs; raises `ScienceError` when the data won't do."""
    with resources.database.transaction(fleet_id, read_only=True) as session:
        asked = repository.run(session, job_id)
        file = None if asked is None or asked.file_id is None else repository.file(session, asked.file_id)
        battery = None if battery_id is None else repository.battery(session, battery_id)
    if asked is not None and asked.work == Work.REPORT:
        return report(resources, fleet_id, job_id, progress)
    if asked is None or battery is None:
        raise jobs.LeaseLost(f"battery {battery_id} was removed, and its jobs with it")
    if asked.work == Work.CURVE:
        return fit(resources, fleet_id, battery, asked, progress)
    if file is None:
        return again(resources, fleet_id, battery, progress)
    store = one(resources, fleet_id, battery, sources.of_file(resources.blobs, file), progress)
    return partial(in_its_place, battery, store)


def of_trip(resources: Resources, fleet_id: str, trip_id: str, progress: jobs.Progress) -> jobs.Store:
    """Estimate the state of a car's battery from a trip; one without battery or measurements of it ends at once.

    Whatever fails is told in the estimate's row: it never costs the trip anything.
    """
    with resources.database.transaction(fleet_id, read_only=True) as session:
        trip = trips.decoded_trip(session, trip_id)
        batteries = [] if trip is None else repository.of_cars(session, [trip.car_id])
    if trip is None or not batteries:
        return lambda session: None
    store = gently(resources, fleet_id, batteries[0], sources.of_trip(resources.blobs, trip), progress)
    return partial(in_its_place, batteries[0], store)


def again(resources: Resources, fleet_id: str, battery: Battery, progress: jobs.Progress) -> jobs.Store:
    """Estimate from everything there is, in the order of time; what would come out the same stays."""
    with resources.database.transaction(fleet_id, read_only=True) as session:
        known = {row.trip_id or row.file_id: row.began_at for row in repository.history(session, battery.id)}
        found = sources.of_battery(session, resources.blobs, battery.id, battery.car_id)
    found.sort(key=lambda source: (known.get(source.id, source.zero_at), source.id))
    for number, source in enumerate(found):
        store = gently(resources, fleet_id, battery, source, _part(progress, number, len(found)))
        persist(partial(_in_a_transaction, resources, fleet_id, store))
    return lambda session: None


def _in_a_transaction(resources: Resources, fleet_id: str, store: jobs.Store) -> None:
    with resources.database.transaction(fleet_id) as session:
        store(session)


def _part(progress: jobs.Progress, number: int, count: int) -> jobs.Progress:
    def on(fraction: float, detail: str | None = None) -> None:
        progress((number + fraction) / count, f"{number + 1} of {count}: {detail}")

    return on


def gently(
    resources: Resources, fleet_id: str, battery: Battery, source: Source, progress: jobs.Progress
) -> jobs.Store:
    """Estimate from a source; what fails becomes the reason in its row."""
    try:
        return one(resources, fleet_id, battery, source, progress)
    except (jobs.JobCancelled, jobs.LeaseLost):
        raise
    except FileNotFoundError:
        reason = UNREADABLE
    except (ScienceError, PonthyError) as error:
        reason = str(error)
    except Exception as error:
        log.warning("no estimate of the battery", battery_id=battery.id, source=source.id, exc_info=True)
        reason = FAULT.format(error=str(error).partition("\n")[0])
    return partial(refuse, resources, battery.id, source, reason)


def one(resources: Resources, fleet_id: str, battery: Battery, source: Source, progress: jobs.Progress) -> jobs.Store:
    """Estimate from a source, unless that was done before with the very same; raises `ScienceError`."""
    progress(0.0, source.name)
    record = source.read()
    if record is None:
        return partial(forget, resources, battery.id, source)
    with resources.database.transaction(fleet_id, read_only=True) as session:
        asked = question(session, battery, source, record, resources.settings.code_version)
        is_done = repository.has_key(session, battery.id, asked.key)
    if is_done:
        return lambda session: None
    found, took_over = answer(asked, lambda share: progress(share, source.name))
    return keep(resources, fleet_id, asked, found, took_over=took_over)


def in_its_place(battery: Battery, store: jobs.Store, session: Session) -> None:
    """Store an estimate, tell of it, and have those made again that began with something else than is known by now."""
    store(session)
    made = [row for row in (*session.new, *session.dirty) if isinstance(row, BatteryEstimate) and row.document_key]
    session.flush()
    for row in made:
        told = EstimateView.model_validate(row).model_dump(mode="json")
        webhooks.publish(session, "battery.ready", told | {"car_id": battery.car_id, "name": battery.name})
    mend(session, battery)
