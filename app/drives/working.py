"""What a worker does about a drive: solve it, compare methods on it, weigh fuel against an emission."""

from __future__ import annotations

import json
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from sqlalchemy.orm import Session

from app.drives import repository
from app.drives.keys import result_file
from app.drives.models import Work
from app.drives.posing import resolved
from app.jobs import service as jobs
from app.jsonable import jsonable
from app.science.optimal.costs.front import pareto
from app.science.optimal.methods.comparing import compare
from app.science.optimal.reading import read_problem
from app.science.optimal.solve import solve
from app.storage.base import now
from app.storage.resources import Resources

HEADLINE = ("fuel_energy_j", "time_s", "distance_m")


@dataclass(frozen=True, slots=True)
class Asked:
    """What a job is about.

    Attributes
    ----------
    work : Work
    options : mapping
    problem : dict
        With an engine that says what it burns.
    sha256 : str
    map : mapping or None
        Which version of which car's map the engine came from.
    """

    work: Work
    options: Mapping[str, Any]
    problem: dict[str, Any]
    sha256: str
    map: Mapping[str, Any] | None


def run(resources: Resources, fleet_id: str, drive_id: str, job_id: str, progress: jobs.Progress) -> jobs.Store:
    """Do what a job asks about a drive.

    Raises
    ------
    Infeasible
        When no drive fulfils the problem.
    """
    with resources.database.transaction(fleet_id, read_only=True) as session:
        asked = _asked(session, drive_id, job_id)
    progress(0.0)
    document = _document(asked, progress)
    key = result_file(fleet_id, drive_id, job_id)
    resources.blobs.put(key, json.dumps(jsonable(document), separators=(",", ":"), allow_nan=False).encode())
    provenance = {
        "drive_id": drive_id,
        "problem_sha256": asked.sha256,
        "map": asked.map,
        "options": asked.options,
        "code_version": resources.settings.code_version,
        "made_at": now().isoformat().replace("+00:00", "Z"),
    }
    return lambda session: _store(session, job_id, key, provenance, document)


def _asked(session: Session, drive_id: str, job_id: str) -> Asked:
    drive, found = repository.drive(session, drive_id, whole=True), repository.run(session, job_id)
    if drive is None or found is None:
        raise jobs.LeaseLost(f"drive {drive_id} was removed, and its jobs with it")
    problem = resolved(drive.problem, drive.engine)
    return Asked(Work(found.work), found.options, problem, drive.problem_sha256, drive.map)


def _document(asked: Asked, progress: jobs.Progress) -> dict[str, Any]:
    wish = asked.options
    match asked.work:
        case Work.SOLVE:
            return solve(read_problem(asked.problem), progress).document()
        case Work.COMPARE:
            return compare(read_problem(asked.problem), wish["methods"], progress).document()
        case Work.FRONT:
            axes = wish["emission"], wish["points"]
            return pareto(asked.problem, *axes, progress, against=wish["against"]).document()


def _store(session: Session, job_id: str, key: str, provenance: dict[str, Any], document: Mapping[str, Any]) -> None:
    found = repository.run(session, job_id)
    if found is None:
        return  # it was removed meanwhile, and the file goes with the next sweep
    found.document_key, found.provenance = key, provenance
    drive = repository.drive(session, found.drive_id, lock=True)
    if drive is None or found.work != Work.SOLVE:
        return
    for name in HEADLINE:
        setattr(drive, name, document.get(name))
    drive.verdict = (document.get("certificate") or {}).get("verdict")
