"""What others may ask of the batteries: make, look up, configure, take data in, estimate, remove."""

from __future__ import annotations

from collections.abc import Sequence
from functools import partial
from typing import Any

from sqlalchemy.orm import Session

from app.batteries import configuring, repository, viewing
from app.batteries.asking import ask, mend
from app.batteries.keys import SWEEP, sent_file
from app.batteries.models import Battery, BatteryEstimate, BatteryFile, Work
from app.batteries.receiving import SentFile
from app.batteries.schemas import BatteryChange, BatteryView, EstimateView, FileView, NewBattery, Received
from app.batteries.sweeping import sweep
from app.cars import service as cars
from app.errors import Conflict, Invalid, NotFound
from app.jobs import service as jobs
from app.schemas import Listing
from app.science.vehicle.battery import BatterySpec
from app.storage.base import new_id
from app.storage.outbox import afterwards, enqueue
from app.storage.resources import Resources
from app.storage.tenancy import fleet_of

__all__ = ["WORKS", "estimate_trip", "ids_of_cars", "notice", "run", "sweep"]

WORKS = tuple(Work)
"""What jobs do about batteries, by the names of their stages."""


def estimate_trip(resources: Resources, fleet_id: str, trip_id: str, progress: jobs.Progress) -> jobs.Store:
    """Estimate a car's battery from a trip; see `app.batteries.working.of_trip`."""
    from app.batteries import working  # for workers only, as it brings what the web server has no room for

    return working.of_trip(resources, fleet_id, trip_id, progress)


def run(
    resources: Resources, fleet_id: str, battery_id: str | None, job_id: str, progress: jobs.Progress
) -> jobs.Store:
    """Do what a job asks about a battery; see `app.batteries.working.run`."""
    from app.batteries import working  # as above

    return working.run(resources, fleet_id, battery_id, job_id, progress)


def notice(session: Session, car_id: str, car_name: str, revision: int, spec: BatterySpec | None) -> None:
    """Take note of what a car's new file says of its battery; the first one that has any makes the battery's row."""
    if spec is None:
        return
    row = next(iter(repository.of_cars(session, [car_id])), None)
    if row is None:
        row = Battery(car_id=car_id, name=f"Battery of {car_name}"[:200])
        session.add(row)
    row.config_revision = revision
    row.name = spec.name[:200] or row.name
    session.flush()


def ids_of_cars(session: Session, car_ids: Sequence[str]) -> dict[str, list[str]]:
    """Return the batteries of each car."""
    found: dict[str, list[str]] = {car_id: [] for car_id in car_ids}
    for row in repository.of_cars(session, car_ids):
        found[row.car_id].append(row.id)
    return found


def create(session: Session, wanted: NewBattery) -> BatteryView:
    """Give a car a battery: its configuration becomes the ``<battery>`` of the car's file, as a new revision.

    Raises
    ------
    Invalid
        When there is no such car.
    Conflict
        When the car has a battery already.
    ProblemError
        With the path of what is wrong in the configuration.
    """
    if not cars.names(session, [wanted.car_id]):
        raise Invalid("unknown-car", f"There is no car {wanted.car_id!r} in this fleet.", field="body.car_id")
    car = cars.config(session, wanted.car_id, lock=True)
    there = next(iter(repository.of_cars(session, [wanted.car_id])), None)
    if there is not None and car.vehicle.battery is not None:
        message = f"The car has a battery already, {there.id}. PUT its configuration, or remove it first."
        raise Conflict("car-has-battery", message)
    found = configuring.put_in_force(
        session, wanted.car_id, wanted.config, name=wanted.name, end_of_life=wanted.end_of_life
    )
    name = cars.names(session, [wanted.car_id])[wanted.car_id]
    notice(session, wanted.car_id, name, found.revision, found.spec)
    return viewing.batteries(session, repository.of_cars(session, [wanted.car_id]))[0]


def row(session: Session, battery_id: str, *, lock: bool = False) -> Battery:
    """Return a battery; raises `NotFound`."""
    found = repository.battery(session, battery_id, lock=lock)
    if found is None:
        raise NotFound("battery", battery_id)
    return found


def get(session: Session, battery_id: str) -> BatteryView:
    """Return a battery as the API shows it; raises `NotFound`."""
    return viewing.batteries(session, [row(session, battery_id)])[0]


def page(session: Session, *, car_id: str | None, cursor: str | None, limit: int) -> Listing[BatteryView]:
    """Return one page of the batteries, newest first."""
    found = repository.page(session, car_id, cursor, limit)
    return Listing(items=viewing.batteries(session, found.items), next_cursor=found.next_cursor)


def change(session: Session, battery_id: str, wanted: BatteryChange) -> BatteryView:
    """Write a battery's name and end of life into its car's file; raises `NotFound`, `Conflict` (no such file)."""
    battery = row(session, battery_id)
    configuring.named(session, battery.car_id, name=wanted.name, end_of_life=wanted.end_of_life)
    session.flush()
    return get(session, battery_id)


def config(session: Session, battery_id: str) -> dict[str, Any]:
    """Return a battery's configuration as its car's file says it; raises `NotFound`, `Conflict` (no such file)."""
    return configuring.in_force(session, row(session, battery_id).car_id).document


def replace_config(session: Session, battery_id: str, document: dict[str, Any]) -> dict[str, Any]:
    """Put another configuration in force; estimates stay until they are made again. Raises what `create` does."""
    battery = row(session, battery_id)
    return configuring.put_in_force(session, battery.car_id, document).document


def delete(session: Session, battery_id: str) -> None:
    """Remove a battery with its history, and take it out of its car's file; raises `NotFound`."""
    jobs.lock_of_battery(session, battery_id)
    configuring.taken_out(session, row(session, battery_id).car_id)  # a car is locked before its battery, as elsewhere
    battery = row(session, battery_id, lock=True)
    jobs.forget_battery(session, battery_id)
    session.delete(battery)
    session.flush()
    enqueue(session, SWEEP, fleet_id=fleet_of(session))


def take_in(
    session: Session,
    resources: Resources,
    battery_id: str,
    work: Work,
    sent: SentFile,
    options: dict[str, Any] | None = None,
) -> Received:
    """Keep a file and have it worked on; the very same bytes are answered with what came of them.

    Raises
    ------
    NotFound
        When there is no such battery, or no such other file that the options name.
    ProblemError, Conflict
        When its configuration lacks what an estimate needs.
    """
    battery = row(session, battery_id, lock=True)
    found = configuring.in_force(session, battery.car_id)
    if work is Work.ESTIMATE:
        found.config()
    for other in (options or {}).get("also", ()):
        file_of(session, battery_id, other)
    file = repository.same_file(session, battery_id, work, sent.sha256)
    duplicate = file is not None
    if file is None:
        file = BatteryFile(id=new_id(), battery_id=battery_id, work=work, name=sent.name, sha256=sent.sha256)
        file.size, file.began_at = sent.size, sent.began_at
        file.blob_key = sent_file(fleet_of(session), battery_id, file.id)
        resources.blobs.adopt(file.blob_key, sent.path)
        session.add(file)
        session.flush()
    there = now_of(session, file.id, None, duplicate=duplicate)
    if duplicate and there.estimate is not None:
        return there
    return now_of(session, file.id, ask(session, battery, work, file, options), duplicate=duplicate)


def now_of(session: Session, file_id: str, job: jobs.JobView | None, *, duplicate: bool) -> Received:
    """Return what has become of a file by now, with the job that is asked about; raises `NotFound`."""
    file, estimate = repository.file(session, file_id), repository.of_file(session, file_id)
    if file is None:
        raise NotFound("file", file_id)
    done = estimate is not None and estimate.document_key is not None
    told = EstimateView.model_validate(estimate) if done else None
    return Received(file=viewing.files(session, [file])[0], job=job, estimate=told, duplicate=duplicate)


def estimate_again(session: Session, battery_id: str) -> jobs.JobView:
    """Have everything estimated again, in the order of time; raises `NotFound`, and as `take_in` for the rest."""
    battery = row(session, battery_id)
    configuring.in_force(session, battery.car_id).config()
    return ask(session, battery, Work.REESTIMATE)


def files(session: Session, battery_id: str, cursor: str | None, limit: int) -> Listing[FileView]:
    """Return one page of the files that were sent for a battery, newest first; raises `NotFound`."""
    found = repository.files(session, row(session, battery_id).id, cursor, limit)
    return Listing(items=viewing.files(session, found.items), next_cursor=found.next_cursor)


def file_of(session: Session, battery_id: str, file_id: str) -> BatteryFile:
    """Return a file of a battery; raises `NotFound`."""
    found = repository.file(session, file_id)
    if found is None or found.battery_id != row(session, battery_id).id:
        raise NotFound("file", file_id)
    return found


def delete_file(session: Session, resources: Resources, battery_id: str, file_id: str) -> None:
    """Remove a file with what it said; those after it are estimated again. Raises `NotFound`."""
    found = file_of(session, battery_id, file_id)
    afterwards(session, partial(resources.blobs.delete, found.blob_key))
    session.delete(found)
    session.flush()
    mend(session, row(session, battery_id, lock=True))
    enqueue(session, SWEEP, fleet_id=fleet_of(session))


def estimates(
    session: Session, battery_id: str, *, trip_id: str | None, cursor: str | None, limit: int
) -> Listing[EstimateView]:
    """Return one page of a battery's estimates, the latest first, of one trip or of all; raises `NotFound`."""
    found = repository.estimates(session, row(session, battery_id).id, trip_id, cursor, limit)
    return Listing[EstimateView].model_validate(found)


def estimate(session: Session, battery_id: str, estimate_id: str) -> BatteryEstimate:
    """Return an estimate of a battery; raises `NotFound`."""
    found = repository.estimate(session, estimate_id)
    if found is None or found.battery_id != row(session, battery_id).id:
        raise NotFound("estimate", estimate_id)
    return found
