"""Trips over REST: taken in, listed, changed, run again, removed."""

from __future__ import annotations

from typing import Annotated, Any

from fastapi import APIRouter, Query, Request
from pydantic import BaseModel
from starlette.concurrency import run_in_threadpool

from app.edge import CurrentPrincipal, OpenResources, ReadSession, WriteSession
from app.jobs import service as jobs
from app.jobs.service import JobView
from app.schemas import DEFAULT_LIMIT, Cursor, Id, Limit, Listing
from app.storage.resources import Resources
from app.trips import result_routes, service
from app.trips.schemas import Reprocessing, TripChange, TripView
from app.uploads import service as uploads

STREAMED = 2**62
"""Bodies of any length: what may be sent is for the upload to say."""

FILE: dict[str, Any] = {
    "requestBody": {
        "required": True,
        "content": {"application/octet-stream": {"schema": {"type": "string", "format": "binary"}}},
    }
}

trips = APIRouter(prefix="/trips", tags=["trips"])
receiving = APIRouter(prefix="/trips", tags=["trips"], max_body_size=STREAMED)
router = APIRouter()


class Received(BaseModel):
    """What became of a file: the upload, and the first of its trips with its job."""

    upload: uploads.UploadDocument
    trip: TripView | None
    job: JobView | None


@receiving.post("", status_code=202, openapi_extra=FILE)
async def send_trip(
    request: Request,
    who: CurrentPrincipal,
    opened: OpenResources,
    car_id: Annotated[str, Query(pattern="^[0-9a-f]{32}$")],
    filename: Annotated[str, Query(min_length=1, max_length=255)],
) -> Received:
    """Send a logger image or a signals table in one piece, for `curl --data-binary @FILE`; uploads can be resumed."""
    metadata = {"car_id": car_id, "filename": filename}
    wanted = uploads.make_wish(opened.settings.max_upload_bytes, metadata)
    await run_in_threadpool(_check, opened, who.fleet_id, wanted)
    upload_id = await uploads.receive_whole(opened, who.fleet_id, wanted, request.stream())
    return await run_in_threadpool(_received, opened, who.fleet_id, upload_id)


def _check(opened: Resources, fleet_id: str, wanted: uploads.Wish) -> None:
    with opened.database.transaction(fleet_id, read_only=True) as session:
        uploads.check_wish(session, opened, wanted)


def _received(opened: Resources, fleet_id: str, upload_id: str) -> Received:
    with opened.database.transaction(fleet_id, read_only=True) as session:
        upload = uploads.document(session, opened, upload_id)
        trip = service.get(session, upload.trip_ids[0]) if upload.trip_ids else None
        job = jobs.get(session, trip.job_id) if trip is not None and trip.job_id is not None else None
    return Received(upload=upload, trip=trip, job=job)


@trips.get("")
def list_trips(
    session: ReadSession,
    car_id: Annotated[str | None, Query(max_length=32)] = None,
    cursor: Cursor = None,
    limit: Limit = DEFAULT_LIMIT,
) -> Listing[TripView]:
    """List trips, newest first, of one car or of all."""
    return service.page(session, car_id=car_id, cursor=cursor, limit=limit)


@trips.get("/{trip_id}")
def show_trip(session: ReadSession, trip_id: Id) -> TripView:
    """Show a trip and its newest result in short."""
    return service.get(session, trip_id)


@trips.patch("/{trip_id}")
def change_trip(session: WriteSession, trip_id: Id, body: TripChange) -> TripView:
    """Rename a trip, note something on it, or leave it out of its car's map (which is then made anew)."""
    return service.change(session, trip_id, body)


@trips.delete("/{trip_id}", status_code=204)
def delete_trip(session: WriteSession, opened: OpenResources, trip_id: Id) -> None:
    """Remove a trip with its results; the uploaded file goes with the last trip that came from it."""
    upload_id = service.delete(session, trip_id)
    if upload_id is not None:
        uploads.forget(session, opened, upload_id)


@trips.post("/{trip_id}/reprocess", status_code=202)
def reprocess_trip(session: WriteSession, trip_id: Id, body: Reprocessing) -> JobView:
    """Run a trip again, perhaps with another tuning, without the smoother or without some sensors."""
    return service.reprocess(session, trip_id, body)


for part in (trips, receiving, result_routes.router):
    router.include_router(part)
