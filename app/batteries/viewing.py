"""Batteries and what was sent for them as the API shows them."""

from __future__ import annotations

from collections.abc import Sequence

from sqlalchemy.orm import Session

from app.batteries import repository
from app.batteries.models import Battery, BatteryFile
from app.batteries.schemas import BatteryView, EstimateView, FileView
from app.cars import service as cars
from app.jobs import service as jobs
from app.science.battery.config import ESTIMATORS
from app.science.vehicle.battery import BatterySpec

NO_BATTERY = ("battery in the car's file",)


def batteries(session: Session, rows: Sequence[Battery]) -> list[BatteryView]:
    """Return batteries as the API shows them."""
    ids = [row.id for row in rows]
    newest = {found.battery_id: found for found in repository.newest(session, ids)}
    counts = repository.counts(session, ids)
    names = cars.names(session, [row.car_id for row in rows])
    working = jobs.newest_of_batteries(session, ids)
    return [
        BatteryView(
            **_told(cars.config(session, row.car_id).vehicle.battery),
            id=row.id,
            car_id=row.car_id,
            car_name=names.get(row.car_id, ""),
            name=row.name,
            config_revision=row.config_revision,
            estimates=counts.get(row.id, 0),
            newest=EstimateView.model_validate(newest[row.id]) if row.id in newest else None,
            job_id=working.get(row.id),
            created_at=row.created_at,
        )
        for row in rows
    ]


def _told(spec: BatterySpec | None) -> dict[str, object]:
    if spec is None:
        unknown = dict.fromkeys(("end_of_life", "series", "parallel", "rated_capacity_ah", "estimator"))
        return unknown | {"missing": list(NO_BATTERY)}
    return {
        "end_of_life": spec.end_of_life,
        "series": spec.series,
        "parallel": spec.parallel,
        "rated_capacity_ah": spec.rated_capacity_ah or spec.capacity_ah,
        "estimator": spec.estimator or ESTIMATORS[0],
        "missing": list(spec.missing),
    }


def files(session: Session, rows: Sequence[BatteryFile]) -> list[FileView]:
    """Return files with the newest job about each, and the estimate that came of it."""
    ids = [row.id for row in rows]
    newest = {run.file_id: run.job_id for run in repository.runs_of_files(session, ids)}
    working = jobs.with_ids(session, newest.values())
    estimates = {found.file_id: found.id for found in repository.of_files(session, ids)}
    return [_file(row, working.get(newest.get(row.id, "")), estimates.get(row.id)) for row in rows]


def _file(row: BatteryFile, job: jobs.JobView | None, estimate_id: str | None) -> FileView:
    columns = {name: getattr(row, name) for name in FileView.model_fields if hasattr(row, name)}
    return FileView(
        **columns,
        job_id=None if job is None else job.id,
        state=None if job is None else job.state,
        problem=None if job is None else job.problem,
        estimate_id=estimate_id,
    )
