"""Uploads over REST: tus 1.0 for sending, JSON for looking."""

from __future__ import annotations

from collections.abc import Callable, Coroutine
from typing import Any

from fastapi import APIRouter, Request, Response
from fastapi.routing import APIRoute
from starlette.concurrency import run_in_threadpool

from app.edge import CurrentPrincipal, OpenResources, ReadSession, WriteSession
from app.errors import PonthyError, from_science
from app.schemas import Cursor, Id, Limit, Listing
from app.science.errors import ScienceError
from app.storage.paging import DEFAULT_LIMIT
from app.uploads import service, tus, view
from app.uploads.models import Upload, UploadState
from app.uploads.schemas import UploadDocument


class TusRoute(APIRoute):
    """A route that speaks tus: it wants the version in every request, and puts it into every answer."""

    def get_route_handler(self) -> Callable[[Request], Coroutine[Any, Any, Response]]:
        """Return the route's handler with the protocol around it."""
        handle = super().get_route_handler()

        async def speaking_tus(request: Request) -> Response:
            try:
                if request.method != "OPTIONS":
                    tus.check_version(request.headers)
                response = await handle(request)
            except (PonthyError, ScienceError) as error:
                refusal = from_science(error) if isinstance(error, ScienceError) else error
                refusal.headers["Tus-Resumable"] = tus.VERSION
                raise refusal from error
            response.headers["Tus-Resumable"] = tus.VERSION
            return response

        return speaking_tus


router = APIRouter(tags=["uploads"])
sending = APIRouter(prefix="/uploads", route_class=TusRoute)

BYTES = {"requestBody": {"content": {tus.BODY_TYPE: {"schema": {"type": "string", "format": "binary"}}}}}


def url_of(upload_id: str) -> str:
    """Return the address of an upload."""
    return f"/api/v1/uploads/{upload_id}"


def _progress(upload: Upload, offset: int) -> dict[str, str]:
    headers = {"Upload-Offset": str(offset)}
    if upload.expires_at is not None:
        headers["Upload-Expires"] = tus.expires(upload.expires_at)
    if upload.state != UploadState.RECEIVING:
        headers["Upload-Result"] = url_of(upload.id)
    return headers


@sending.options("", status_code=204)
def describe(resources: OpenResources) -> Response:
    """Say what of tus is spoken here."""
    return Response(
        status_code=204,
        headers={
            "Tus-Version": tus.VERSION,
            "Tus-Extension": tus.EXTENSIONS,
            "Tus-Max-Size": str(resources.settings.max_upload_bytes),
            "Tus-Checksum-Algorithm": ",".join(tus.ALGORITHMS),
        },
    )


@sending.post("", status_code=201, openapi_extra=BYTES)
async def create_upload(request: Request, resources: OpenResources, who: CurrentPrincipal) -> Response:
    """Begin an upload: `Upload-Length`, and in `Upload-Metadata` filename, car_id, kind, mapping.

    A body of the type application/offset+octet-stream is taken as the first bytes.
    """
    upload_id = await run_in_threadpool(service.create, resources, who.fleet_id, tus.wish(request.headers))
    location = {"Location": url_of(upload_id)}
    try:
        if request.headers.get("content-type") == tus.BODY_TYPE:
            upload = await _receive(request, resources, who.fleet_id, upload_id, offset=0)
        else:
            upload = await run_in_threadpool(service.repaired, resources, who.fleet_id, upload_id)
    except PonthyError as error:
        error.headers.update(location)
        raise
    offset = await run_in_threadpool(view.offset_of, upload, resources)
    return Response(status_code=201, headers=_progress(upload, offset) | location)


async def _receive(request: Request, resources: OpenResources, fleet_id: str, upload_id: str, offset: int) -> Upload:
    announced = "content-length" in request.headers
    return await service.receive(
        resources,
        fleet_id,
        upload_id,
        request.stream(),
        offset=offset,
        checksum=tus.checksum(request.headers),
        announced=tus.whole_number(request.headers, "Content-Length") if announced else None,
    )


@sending.head("/{upload_id}")
def ask_offset(upload_id: Id, resources: OpenResources, who: CurrentPrincipal) -> Response:
    """Say how many bytes of an upload are here."""
    upload = service.repaired(resources, who.fleet_id, upload_id)
    metadata = {"filename": upload.filename, "kind": upload.kind}
    if upload.car_id is not None:
        metadata["car_id"] = upload.car_id
    headers = {"Upload-Length": str(upload.size), "Upload-Metadata": tus.write_metadata(metadata)}
    return Response(headers=headers | _progress(upload, view.offset_of(upload, resources)))


@sending.patch("/{upload_id}", status_code=204, openapi_extra=BYTES)
async def append(upload_id: Id, request: Request, resources: OpenResources, who: CurrentPrincipal) -> Response:
    """Send the next bytes, from `Upload-Offset` on. The answer to the last of them names the `Upload-Result`."""
    if request.headers.get("content-type") != tus.BODY_TYPE:
        raise tus.BadTusRequest("Content-Type", f"must be {tus.BODY_TYPE}", 415)
    offset = tus.whole_number(request.headers, "Upload-Offset")
    upload = await _receive(request, resources, who.fleet_id, upload_id, offset)
    return Response(status_code=204, headers=_progress(upload, view.offset_of(upload, resources)))


@sending.delete("/{upload_id}", status_code=204)
def terminate(upload_id: Id, resources: OpenResources, session: WriteSession) -> Response:
    """End an upload and forget its bytes; one that became a trip is removed with the trip."""
    service.delete(session, resources, upload_id)
    return Response(status_code=204)


@router.get("/uploads")
def list_uploads(
    session: ReadSession, resources: OpenResources, cursor: Cursor = None, limit: Limit = DEFAULT_LIMIT
) -> Listing[UploadDocument]:
    """List the uploads, newest first."""
    return Listing[UploadDocument].model_validate(service.documents(session, resources, cursor, limit))


@router.get("/uploads/{upload_id}")
def show_upload(upload_id: Id, session: ReadSession, resources: OpenResources) -> UploadDocument:
    """Show how far an upload is, and what became of it."""
    return service.document(session, resources, upload_id)


router.include_router(sending)
