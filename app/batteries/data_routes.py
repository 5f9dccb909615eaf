"""Data of batteries over REST: files that are sent, kept as they are, and worked on by jobs."""

from __future__ import annotations

from typing import Annotated, Any

from fastapi import APIRouter, Depends, Query, Request, Response
from starlette.concurrency import run_in_threadpool

from app.answers import attachment, large_json
from app.batteries import service
from app.batteries.fitting import proposal
from app.batteries.models import Work
from app.batteries.receiving import SentFile, received
from app.batteries.schemas import At, FileView, Received
from app.batteries.waiting import settled
from app.edge import CurrentPrincipal, OpenResources, ReadSession, WriteSession
from app.schemas import DEFAULT_LIMIT, Cursor, Id, Limit, Listing
from app.storage.resources import Resources

FILE: dict[str, Any] = {
    "requestBody": {
        "required": True,
        "content": {
            "application/octet-stream": {"schema": {"type": "string", "format": "binary"}},
            "multipart/form-data": {
                "schema": {"type": "object", "properties": {"file": {"type": "string", "format": "binary"}}}
            },
        },
    }
}
STREAMED = 2**62
"""Bodies of any length: what may be sent is for the receiver to say."""

router = APIRouter(prefix="/batteries/{battery_id}", tags=["batteries"])
receiving = APIRouter(prefix="/batteries/{battery_id}", tags=["batteries"], max_body_size=STREAMED)

FileName = Annotated[str, Query(max_length=300, description="The file's name; a form has it already.")]
Wait = Annotated[float, Query(ge=0, le=30, description="Answer when its job is over, or after so many seconds.")]
BeganAt = Annotated[
    At | None,
    Query(description="When `t_s` is zero, ISO 8601; else the file's own clock, or when it comes, decides."),
]


def curve_wishes(
    capacity_ah: Annotated[
        float | None, Query(gt=0, le=1e5, description="Of one cell, where no full discharge is in the data.")
    ] = None,
    polynomial: Annotated[int | None, Query(ge=1, le=12, description="Degree; a table where none is given.")] = None,
    also: Annotated[list[str] | None, Query(max_length=10, description="Files sent before, to be fitted too.")] = None,
) -> dict[str, Any]:
    """Return how a curve is to be fitted."""
    return {"capacity_ah": capacity_ah, "polynomial": polynomial, "also": also or []}


@receiving.post("/data", status_code=202, openapi_extra=FILE)
async def send_data(
    request: Request,
    who: CurrentPrincipal,
    opened: OpenResources,
    battery_id: Id,
    filename: FileName = "",
    began_at: BeganAt = None,
    wait: Wait = 0.0,
) -> Received:
    """Estimate from a file with `t_s current_a voltage_v`: CSV (packed or not), Parquet or ZIP, as body or form."""
    await run_in_threadpool(_check, opened, who.fleet_id, battery_id)
    async with received(request, opened, filename, began_at) as sent:
        taken = await run_in_threadpool(_take_in, opened, who.fleet_id, battery_id, Work.ESTIMATE, sent)
    return await settled(opened, who.fleet_id, taken, wait)


@receiving.post("/curve", status_code=202, openapi_extra=FILE)
async def send_curve(
    request: Request,
    who: CurrentPrincipal,
    opened: OpenResources,
    battery_id: Id,
    wishes: Annotated[dict[str, Any], Depends(curve_wishes)],
    filename: FileName = "",
    wait: Wait = 0.0,
) -> Received:
    """Fit an open-circuit curve to a slow charge or discharge, or to pulses with rests; nothing is put in force."""
    await run_in_threadpool(_check, opened, who.fleet_id, battery_id)
    async with received(request, opened, filename, None) as sent:
        taken = await run_in_threadpool(_take_in, opened, who.fleet_id, battery_id, Work.CURVE, sent, wishes)
    return await settled(opened, who.fleet_id, taken, wait)


@router.get("/curve", response_model=dict[str, Any])
def show_curve(request: Request, session: ReadSession, opened: OpenResources, battery_id: Id) -> Response:
    """Give the newest fitted curve; its `ocv` may stand in a configuration as it is."""
    return large_json(request, proposal(session, opened.blobs, service.row(session, battery_id)))


def _check(opened: Resources, fleet_id: str, battery_id: str) -> None:
    with opened.database.transaction(fleet_id, read_only=True) as session:
        service.row(session, battery_id)


def _take_in(
    opened: Resources,
    fleet_id: str,
    battery_id: str,
    work: Work,
    sent: SentFile,
    options: dict[str, Any] | None = None,
) -> Received:
    with opened.database.transaction(fleet_id) as session:
        return service.take_in(session, opened, battery_id, work, sent, options)


@router.get("/data")
def list_data(
    session: ReadSession, battery_id: Id, cursor: Cursor = None, limit: Limit = DEFAULT_LIMIT
) -> Listing[FileView]:
    """List the files that were sent for a battery, newest first, and what became of each."""
    return service.files(session, battery_id, cursor, limit)


@router.get("/data/{file_id}", response_class=Response)
def give_data(session: ReadSession, opened: OpenResources, battery_id: Id, file_id: Id) -> Response:
    """Give a file as it was sent."""
    found = service.file_of(session, battery_id, file_id)
    return attachment(opened.blobs.get(found.blob_key), found.name, "application/octet-stream")


@router.delete("/data/{file_id}", status_code=204)
def delete_data(session: WriteSession, opened: OpenResources, battery_id: Id, file_id: Id) -> None:
    """Remove a file with its estimate; later ones are made again without it."""
    service.delete_file(session, opened, battery_id, file_id)
