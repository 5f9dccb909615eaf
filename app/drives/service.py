"""What others may ask of the drives: pose, look up, have worked out, remove."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from sqlalchemy.orm import Session

from app.cars import service as cars
from app.drives import repository
from app.drives.keys import SWEEP
from app.drives.models import Drive, DriveRun, Work
from app.drives.posing import read_posed, title_of
from app.drives.results import failure_of, state_of
from app.drives.schemas import CheckedProblem, CompareWish, DriveView, FrontWish, JobsOfDrive, NewDrive, WholeDrive
from app.drives.sweeping import sweep
from app.errors import Conflict, Invalid, NotFound
from app.jobs import service as jobs
from app.schemas import Listing
from app.science.optimal.methods.names import NAMES
from app.storage.blobs import Blobs
from app.storage.outbox import enqueue
from app.storage.resources import Resources
from app.storage.tenancy import fleet_of

__all__ = ["WORKS", "DriveView", "WholeDrive", "get", "pose", "run", "sweep"]

WORKS = tuple(Work)
"""What jobs do about drives, by the names of their stages."""

TITLES = {Work.SOLVE: "Drive", Work.COMPARE: "Methods for", Work.FRONT: "Front of"}


def run(resources: Resources, fleet_id: str, drive_id: str, job_id: str, progress: jobs.Progress) -> jobs.Store:
    """Do what a job asks about a drive; see `app.drives.working.run`."""
    from app.drives import working  # brings compiled kernels, which the web server never runs and has no room for

    return working.run(resources, fleet_id, drive_id, job_id, progress)


def pose(session: Session, blobs: Blobs, wanted: NewDrive) -> WholeDrive:
    """Keep a problem and have it solved.

    Raises
    ------
    Invalid
        When there is no such car.
    ProblemError
        With the path of what is wrong in the problem.
    """
    _check_car(session, wanted.car_id)
    posed = read_posed(session, blobs, wanted.problem, wanted.car_id)
    of_map = posed.map_of
    drive = Drive(
        name=wanted.name or title_of(wanted.problem),
        kind=posed.kind,
        car_id=wanted.car_id or (of_map and of_map.car_id),
        problem=wanted.problem,
        engine=posed.engine,
        map=of_map and {"car_id": of_map.car_id, "version": of_map.version},
        problem_sha256=posed.sha256,
    )
    session.add(drive)
    session.flush()
    ask(session, drive, Work.SOLVE, {})
    return whole(session, drive.id)


def check(session: Session, blobs: Blobs, wanted: NewDrive) -> CheckedProblem:
    """Read a problem as `pose` does and keep nothing; raises the same."""
    _check_car(session, wanted.car_id)
    posed = read_posed(session, blobs, wanted.problem, wanted.car_id)
    name = wanted.name or title_of(wanted.problem)
    return CheckedProblem(kind=posed.kind, name=name, warnings=list(posed.warnings))


def _check_car(session: Session, car_id: str | None) -> None:
    if car_id is not None and not cars.names(session, [car_id]):
        raise Invalid("unknown-car", f"There is no car {car_id!r} in this fleet.", field="body.car_id")


def ask(session: Session, drive: Drive, work: Work, options: dict[str, Any]) -> jobs.JobView:
    """Have something worked out about a drive; the same thing that is still under way is not asked for twice."""
    newest = repository.newest_run(session, drive.id, work)
    if newest is not None and newest.options == options:
        under_way = jobs.get(session, newest.job_id)
        if not under_way.is_over:
            return under_way
    job = jobs.create_drive_job(session, drive_id=drive.id, stage=work, title=f"{TITLES[work]} {drive.name}")
    session.add(DriveRun(job_id=job.id, drive_id=drive.id, work=work, options=options))
    session.flush()
    return job


def solve_again(session: Session, drive_id: str) -> jobs.JobView:
    """Solve a drive anew, with the program as it is now; raises `NotFound`."""
    return ask(session, row(session, drive_id), Work.SOLVE, {})


def compare(session: Session, drive_id: str, wanted: CompareWish) -> jobs.JobView:
    """Have methods compared on a drive; raises `NotFound`, `Invalid` (a name), `Conflict` (no answer)."""
    drive = _solved(session, drive_id)
    unknown = [name for name in wanted.methods or () if name not in NAMES]
    if unknown:
        message = f"{unknown[0]!r} is the name of no method; there are {', '.join(NAMES)}."
        raise Invalid("unknown-method", message, field="body.methods")
    return ask(session, drive, Work.COMPARE, wanted.model_dump())


def draw_front(session: Session, drive_id: str, wanted: FrontWish) -> jobs.JobView:
    """Have fuel weighed against an emission; raises `NotFound`, or `Conflict` when the drive has no answer."""
    return ask(session, _solved(session, drive_id), Work.FRONT, wanted.model_dump())


def row(session: Session, drive_id: str, *, whole: bool = False, lock: bool = False) -> Drive:
    """Return a drive; raises `NotFound`."""
    drive = repository.drive(session, drive_id, whole=whole, lock=lock)
    if drive is None:
        raise NotFound("drive", drive_id)
    return drive


def get(session: Session, drive_id: str) -> DriveView:
    """Return a drive as the API shows it; raises `NotFound`."""
    return view(session, [row(session, drive_id)])[0]


def whole(session: Session, drive_id: str) -> WholeDrive:
    """Return a drive with its problem; raises `NotFound`."""
    drive = row(session, drive_id, whole=True)
    short = view(session, [drive])[0]
    return WholeDrive(**short.model_dump(), problem=drive.problem, engine=drive.engine)


def page(
    session: Session, *, car_id: str | None, kind: str | None, cursor: str | None, limit: int
) -> Listing[DriveView]:
    """Return one page of the drives, newest first."""
    found = repository.page(session, car_id=car_id, kind=kind, cursor=cursor, limit=limit)
    return Listing(items=view(session, found.items), next_cursor=found.next_cursor)


def rename(session: Session, drive_id: str, name: str) -> DriveView:
    """Give a drive another name; raises `NotFound`."""
    row(session, drive_id, lock=True).name = name
    session.flush()
    return get(session, drive_id)


def delete(session: Session, drive_id: str) -> None:
    """Remove a drive with its results and jobs; raises `NotFound`."""
    jobs.lock_of_drive(session, drive_id)
    drive = row(session, drive_id, lock=True)
    jobs.forget_drive(session, drive_id)
    session.delete(drive)
    session.flush()
    enqueue(session, SWEEP, fleet_id=fleet_of(session))


def view(session: Session, drives: Sequence[Drive]) -> list[DriveView]:
    """Return drives as the API shows them."""
    newest: dict[str, dict[str, str]] = {drive.id: {} for drive in drives}
    for found in repository.runs(session, list(newest)):
        newest[found.drive_id][found.work] = found.job_id
    solving = jobs.with_ids(session, [of[Work.SOLVE] for of in newest.values() if Work.SOLVE in of])
    names = cars.names(session, list({drive.car_id for drive in drives if drive.car_id is not None}))
    return [_view(drive, newest[drive.id], names, solving) for drive in drives]


def _view(drive: Drive, newest: dict[str, str], names: dict[str, str], solving: dict[str, jobs.JobView]) -> DriveView:
    job = solving.get(newest.get(Work.SOLVE, ""))
    columns = {name: getattr(drive, name) for name in DriveView.model_fields if hasattr(drive, name)}
    return DriveView(
        **columns,
        car_name=None if drive.car_id is None else names.get(drive.car_id),
        state=state_of(job),
        job_id=None if job is None else job.id,
        jobs=JobsOfDrive.model_validate(newest),
        failure=failure_of(job),
    )


def _solved(session: Session, drive_id: str) -> Drive:
    drive = row(session, drive_id)
    if drive.fuel_energy_j is None and drive.time_s is None:
        message = "The drive has no answer yet, so there is nothing to weigh it against. Wait until it is solved."
        raise Conflict("drive-not-solved", message)
    return drive
