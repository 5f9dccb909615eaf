"""Laying an open-circuit curve through files of slow charges and discharges; what comes of it is a proposal."""

from __future__ import annotations

import json
from typing import Any

from sqlalchemy.orm import Session

from app.batteries import repository
from app.batteries.configuring import in_force
from app.batteries.keys import run_file
from app.batteries.models import Battery, BatteryFile, BatteryRun, Work
from app.batteries.sources import sent
from app.errors import Conflict, PonthyError, from_problem
from app.jobs import service as jobs
from app.jsonable import jsonable
from app.storage.base import now
from app.storage.blobs import Blobs
from app.storage.resources import Resources

NO_CURVE = "Nobody has had a curve fitted for this battery yet. POST a slow charge or discharge to …/curve first."


def fit(
    resources: Resources, fleet_id: str, battery: Battery, asked: BatteryRun, progress: jobs.Progress
) -> jobs.Store:
    """Fit a curve to the files of a job; raises `ScienceError` when they don't show one."""
    with resources.database.transaction(fleet_id, read_only=True) as session:
        files = _files(session, battery, asked)
        series, parallel = _cells(session, battery)
    records = []
    for number, file in enumerate(files):
        progress(number / (len(files) + 1), file.name)
        records.append(sent(resources.blobs, file))
    document = curve_document(records, series, parallel, asked.options)
    key = run_file(fleet_id, battery.id, asked.job_id)
    resources.blobs.put(key, json.dumps(jsonable(document), separators=(",", ":"), allow_nan=False).encode())
    provenance = {
        "files": [{"name": file.name, "sha256": file.sha256} for file in files],
        "options": asked.options,
        "cells": {"series": series, "parallel": parallel},
        "code_version": resources.settings.code_version,
        "made_at": now().isoformat().replace("+00:00", "Z"),
    }

    def store(session: Session) -> None:
        row = repository.run(session, asked.job_id)
        if row is not None:  # else it was removed meanwhile, and the file goes with the next sweep
            row.document_key, row.provenance = key, provenance

    return store


def curve_document(records: list[Any], series: int, parallel: int, options: dict[str, Any]) -> dict[str, Any]:
    """Return a fitted curve as configurations hold it, its rows, and what else the records show."""
    from app.science.battery.capacity_test import capacity_tests  # for workers only, which have room for it
    from app.science.battery.open_circuit_fit import fit_curve
    from app.science.battery.open_circuit_polynomial import polynomial_of

    fitted = fit_curve(records, options["capacity_ah"], series, parallel)
    made = None if options["polynomial"] is None else polynomial_of(fitted.curve, options["polynomial"])
    curve = fitted.curve if made is None else made.curve
    document: dict[str, Any] = {"ocv": curve.document(), "ocv_soc_range": list(curve.soc_range)}
    document |= {name: getattr(fitted, name).tolist() for name in ("soc", "volts", "spread_v", "resistance_ohm")}
    document |= {"capacity_ah": fitted.capacity_ah, "misfit_v": fitted.misfit_v, "warnings": list(fitted.warnings)}
    document["polynomial"] = None if made is None else {"rms_v": made.rms_v, "worst_v": made.worst_v}
    tests = [test for record in records for test in capacity_tests(record)]
    document["tests"] = [{name: getattr(test, name) for name in test.__dataclass_fields__} for test in tests]
    return document


def proposal(session: Session, blobs: Blobs, battery: Battery) -> dict[str, Any]:
    """Return the newest fitted curve.

    Raises
    ------
    PonthyError
        When there is none: nobody asked, it is still being fitted, or why it failed.
    """
    found = repository.newest_run(session, battery.id, Work.CURVE, done=True)
    if found is None or found.document_key is None:
        raise _missing(session, battery)
    document: dict[str, Any] = json.loads(blobs.get(found.document_key))
    return document | {"job_id": found.job_id, "provenance": found.provenance}


def _missing(session: Session, battery: Battery) -> PonthyError:
    newest = repository.newest_run(session, battery.id, Work.CURVE)
    if newest is None:
        return Conflict("no-curve", NO_CURVE)
    job = jobs.get(session, newest.job_id)
    if job.problem is not None:
        return from_problem(job.problem)
    message = f"The curve is being fitted. Ask again soon, or follow job {job.id}."
    return PonthyError("curve-not-ready", message, 409, headers={"Retry-After": "1"}, job_id=job.id)


def _files(session: Session, battery: Battery, asked: BatteryRun) -> list[BatteryFile]:
    found = (repository.file(session, file_id) for file_id in (asked.file_id, *asked.options["also"]) if file_id)
    return [file for file in found if file is not None and file.battery_id == battery.id]


def _cells(session: Session, battery: Battery) -> tuple[int, int]:
    spec = in_force(session, battery.car_id).spec
    return spec.series, spec.parallel
