"""Drives over REST: posed, waited for, looked at, removed."""

from __future__ import annotations

from typing import Annotated, Any, Literal

from fastapi import APIRouter, Depends, Query, Request, Response
from pydantic import BeforeValidator, TypeAdapter
from starlette.concurrency import run_in_threadpool

from app.bodies import short_body, validated
from app.drives import filling_routes, result_routes, road_routes, service
from app.drives.schemas import (
    CheckedProblem,
    CompareWish,
    DriveChange,
    DriveView,
    FrontWish,
    NewDrive,
    WholeDrive,
    as_posed,
)
from app.drives.waiting import posed, settled
from app.edge import API, CurrentPrincipal, OpenResources, ReadSession, WriteSession
from app.jobs.service import JobView
from app.schemas import DEFAULT_LIMIT, Cursor, Id, Limit, Listing

LARGEST_PROBLEM_BYTES = 2_000_000
LONGEST_WAIT_S = 30.0

drives = APIRouter(prefix="/drives", tags=["drives"])
router = APIRouter()

Wait = Annotated[
    float, Query(ge=0, le=LONGEST_WAIT_S, description="Answer when it is solved, or after so many seconds.")
]
KindName = Literal["accelerate", "distance", "route", "ball_and_wheel"]
SOLVED: dict[int | str, dict[str, Any]] = {201: {"model": WholeDrive, "description": "Solved, with the answer in it."}}
POSED: TypeAdapter[NewDrive] = TypeAdapter(Annotated[NewDrive, BeforeValidator(as_posed)])
BODY = {"requestBody": {"required": True, "content": {"application/json": {"schema": POSED.json_schema()}}}}


async def new_drive(request: Request) -> NewDrive:
    """Return what is posed in the body; raises for one that is too long or no drive."""
    return validated(POSED, await short_body(request, LARGEST_PROBLEM_BYTES, "problem-too-large", "A drive problem"))


@drives.post("", status_code=202, responses=SOLVED, openapi_extra=BODY)
async def pose_drive(
    who: CurrentPrincipal,
    body: Annotated[NewDrive, Depends(new_drive)],
    opened: OpenResources,
    response: Response,
    wait: Wait = 0.0,
) -> WholeDrive:
    """Have a problem solved: 202 with the job that does it, or with `wait` 201 with the answer, or 422."""
    made = await run_in_threadpool(posed, opened, who.fleet_id, body)
    found = await settled(opened, who.fleet_id, made, wait)
    response.headers["Location"] = f"{API}/drives/{made.id}"
    response.status_code = 202 if found.answer is None else 201
    return found


@drives.post("/check", openapi_extra=BODY)
def check_problem(
    session: ReadSession, opened: OpenResources, body: Annotated[NewDrive, Depends(new_drive)]
) -> CheckedProblem:
    """Say whether a problem can be solved as it is, without keeping it: 422 with the field that is wrong."""
    return service.check(session, opened.blobs, body)


@drives.get("")
def list_drives(
    session: ReadSession,
    car_id: Annotated[str | None, Query(max_length=32)] = None,
    kind: KindName | None = None,
    cursor: Cursor = None,
    limit: Limit = DEFAULT_LIMIT,
) -> Listing[DriveView]:
    """List drives, newest first, of one car or of all."""
    return service.page(session, car_id=car_id, kind=kind, cursor=cursor, limit=limit)


@drives.get("/{drive_id}")
def show_drive(session: ReadSession, drive_id: Id) -> WholeDrive:
    """Show a drive with its problem, how far it is, and its answer in short."""
    return service.whole(session, drive_id)


@drives.patch("/{drive_id}")
def rename_drive(session: WriteSession, drive_id: Id, body: DriveChange) -> DriveView:
    """Give a drive another name."""
    return service.rename(session, drive_id, body.name)


@drives.delete("/{drive_id}", status_code=204)
def delete_drive(session: WriteSession, drive_id: Id) -> None:
    """Remove a drive with everything that was worked out about it; what is under way is stopped."""
    service.delete(session, drive_id)


@drives.post("/{drive_id}/solve", status_code=202)
def solve_drive_again(session: WriteSession, drive_id: Id) -> JobView:
    """Solve a drive once more, with the program as it is now; the answer that is there stays until then."""
    return service.solve_again(session, drive_id)


@drives.post("/{drive_id}/compare", status_code=202)
def compare_methods(session: WriteSession, drive_id: Id, body: CompareWish) -> JobView:
    """Have the drive solved by several methods: energy, time, error and milliseconds of each."""
    return service.compare(session, drive_id, body)


@drives.post("/{drive_id}/front", status_code=202)
def draw_front(session: WriteSession, drive_id: Id, body: FrontWish) -> JobView:
    """Have fuel weighed against an emission (or `time`), as a Pareto front."""
    return service.draw_front(session, drive_id, body)


of_problems = (filling_routes.router, road_routes.router)
for part in (*of_problems, drives, result_routes.router):  # a drive's identifier is asked for last
    router.include_router(part)
