"""Bytes come in: to the file of their upload, in small memory, kept however the connection ends."""

from __future__ import annotations

import asyncio
import hashlib
from collections.abc import AsyncIterator
from datetime import timedelta

from starlette.concurrency import run_in_threadpool
from starlette.requests import ClientDisconnect

from app.errors import Conflict, NotFound, PonthyError, from_os, from_problem, problem
from app.storage.base import new_id, now
from app.storage.resources import Resources
from app.uploads import repository
from app.uploads.finishing import finish, staging_of
from app.uploads.kinds import HEAD_BYTES, complaint
from app.uploads.models import Upload, UploadKind, UploadState
from app.uploads.staging import Staging, Writer
from app.uploads.tus import CHECKSUM_MISMATCH, Checksum, Wish

GATHER_BYTES = 1024**2
"""Bytes gathered before they are written, so that a fast sender doesn't cost a thread switch for each packet."""
EXTEND_EVERY = timedelta(minutes=10)
"""An upload's expiry is moved no more often than this."""


class TooLarge(PonthyError):  # noqa: N818 - reads as the condition it names
    """More bytes than agreed, or allowed."""

    def __init__(self, limit: int) -> None:
        super().__init__("upload-too-large", f"This is more than the {limit} bytes that are expected here.", 413)


async def receive(
    resources: Resources,
    fleet_id: str,
    upload_id: str,
    stream: AsyncIterator[bytes],
    *,
    offset: int,
    checksum: Checksum | None = None,
    announced: int | None = None,
) -> Upload:
    """Append the bytes of one request to an upload; with its last byte the upload is finished.

    Parameters
    ----------
    resources : Resources
    fleet_id, upload_id : str
    stream : async iterator of bytes
        The body of the request.
    offset : int
        Where the sender believes the upload to be.
    checksum : Checksum, optional
        What the bytes must hash to; when they don't, none of them is kept.
    announced : int, optional
        Length of the body, where the sender says it.

    Returns
    -------
    Upload
        As it is now.

    Raises
    ------
    PonthyError
        404, 409, 410, 413, 423, 460 or 507, as tus wants it. Bytes without a checksum that did arrive are kept.
    """
    upload = await run_in_threadpool(look_up, resources, fleet_id, upload_id)
    staging = staging_of(resources)
    if upload.state != UploadState.RECEIVING:
        _check_offset(upload.size, offset)
        return upload
    try:
        with staging.writer(upload_id) as writer:
            _check_offset(writer.offset, offset)
            if announced is not None and offset + announced > upload.size:
                raise TooLarge(upload.size - offset)
            try:
                await _append(writer, upload.size, stream, checksum, resources.settings.upload_idle_s)
            finally:
                await run_in_threadpool(_note, resources, upload, staging, offset)
            if writer.offset == upload.size:
                await run_in_threadpool(finish, resources, fleet_id, upload_id)
    except FileNotFoundError as error:
        raise Gone from error
    except OSError as error:
        raise from_os(error) or error from error
    return await run_in_threadpool(look_up, resources, fleet_id, upload_id)


class Gone(PonthyError):  # noqa: N818 - reads as the condition it names
    """An upload that can't be gone on with."""

    def __init__(self) -> None:
        message = "What was received of this upload is no longer kept; it rested for too long. Start it again."
        super().__init__("upload-expired", message, 410)


def look_up(resources: Resources, fleet_id: str, upload_id: str) -> Upload:
    """Return an upload that has not expired; raises `NotFound` or `Gone`."""
    with resources.database.transaction(fleet_id, read_only=True) as session:
        upload = repository.upload(session, upload_id)
    if upload is None:
        raise NotFound("upload", upload_id)
    if upload.expires_at is not None and upload.expires_at < now():
        raise Gone
    return upload


def _check_offset(actual: int, claimed: int) -> None:
    if claimed != actual:
        message = f"The upload is at byte {actual}, not {claimed}. Go on from there."
        error = Conflict("upload-offset-conflict", message)
        error.where["offset"] = actual
        raise error


async def _append(
    writer: Writer, limit: int, stream: AsyncIterator[bytes], checksum: Checksum | None, idle_s: float
) -> None:
    start = writer.offset
    digest = None if checksum is None else checksum.new_hash()
    if digest is not None:
        await run_in_threadpool(writer.begin_unverified)
    fits = True
    try:
        async for data in gathered(stream, idle_s):
            if writer.offset + len(data) > limit:
                await run_in_threadpool(writer.cut, start)
                raise TooLarge(limit - start)
            await run_in_threadpool(_write, writer, digest, data)
    finally:
        fits = await run_in_threadpool(_conclude, writer, start, digest, checksum)
    if not fits:
        message = "The bytes don't fit their checksum; none of them was kept. Send them again."
        raise PonthyError("checksum-mismatch", message, CHECKSUM_MISMATCH)


def _conclude(writer: Writer, start: int, digest: hashlib._Hash | None, checksum: Checksum | None) -> bool:
    if digest is None or checksum is None:
        writer.sync()
        return True
    if digest.digest() != checksum.digest:
        writer.cut(start)
        return False
    writer.verified()
    return True


def _write(writer: Writer, digest: hashlib._Hash | None, data: bytes) -> None:
    writer.write(data)
    if digest is not None:
        digest.update(data)


async def gathered(stream: AsyncIterator[bytes], idle_s: float) -> AsyncIterator[bytes]:
    """Give a body in pieces worth writing. When the sender falls silent or goes away, first what did arrive.

    Raises
    ------
    PonthyError
        When the body did not end as it should.
    """
    parts: list[bytes] = []
    ended: PonthyError | None = None
    pieces = aiter(stream)
    while ended is None:
        try:
            async with asyncio.timeout(idle_s):
                piece = await anext(pieces)
        except StopAsyncIteration:
            break
        except TimeoutError:
            ended = PonthyError("sender-silent", f"Nothing came for {idle_s:g} s. Ask for the offset and go on.", 408)
        except ClientDisconnect:
            ended = PonthyError("sender-gone", "The connection ended before the body did.", 400)
        else:
            parts.append(piece)
        if sum(map(len, parts)) >= GATHER_BYTES:
            yield b"".join(parts)
            parts = []
    if parts:
        yield b"".join(parts)
    if ended is not None:
        raise ended


def _note(resources: Resources, upload: Upload, staging: Staging, start: int) -> None:
    """Move the expiry, and say as early as possible when this can't become what it is meant to be."""
    expires_at = now() + timedelta(hours=resources.settings.upload_expiry_hours)
    extends = upload.expires_at is None or expires_at - upload.expires_at > EXTEND_EVERY
    error = None
    if start < HEAD_BYTES <= staging.offset(upload.id):
        error = complaint(staging.head(upload.id, HEAD_BYTES), upload.size, upload.filename, UploadKind(upload.kind))
    if not extends and error is None:
        return
    with resources.database.transaction(upload.fleet_id) as session:
        row = repository.upload(session, upload.id, lock=True)
        if row is not None and row.state == UploadState.RECEIVING:
            row.expires_at, row.updated_at = expires_at, now()
            row.problem = row.problem if error is None else problem(error)


async def receive_whole(resources: Resources, fleet_id: str, wanted: Wish, stream: AsyncIterator[bytes]) -> str:
    """Take a whole file in one request; return its upload's identifier.

    Parameters
    ----------
    resources : Resources
    fleet_id : str
    wanted : Wish
        Its size is the most that is taken.
    stream : async iterator of bytes

    Raises
    ------
    PonthyError
        413, 507 or the fault of the connection; nothing is kept then, because nobody could resume it. 422 when the
        file can't be used; it is kept as a failed upload, whose identifier the error has as ``upload_id``.
    """
    upload_id, staging = new_id(), staging_of(resources)
    await run_in_threadpool(staging.create, upload_id)
    try:
        with staging.writer(upload_id) as writer:
            await _append(writer, wanted.size, stream, None, resources.settings.upload_idle_s)
            await run_in_threadpool(begin, resources, fleet_id, wanted, upload_id, writer.offset)
            await run_in_threadpool(finish, resources, fleet_id, upload_id)
    except BaseException as error:
        await run_in_threadpool(_drop_unless_begun, resources, fleet_id, upload_id)
        if isinstance(error, OSError) and (known := from_os(error)) is not None:
            raise known from error
        raise
    upload = await run_in_threadpool(look_up, resources, fleet_id, upload_id)
    if upload.problem is not None:
        raise from_problem(upload.problem | {"upload_id": upload_id})
    return upload_id


def begin(resources: Resources, fleet_id: str, wanted: Wish, upload_id: str, size: int) -> None:
    """Write the row of an upload whose staging file is there."""
    expires_at = now() + timedelta(hours=resources.settings.upload_expiry_hours)
    with resources.database.transaction(fleet_id) as session:
        session.add(
            Upload(
                id=upload_id,
                car_id=wanted.car_id,
                kind=wanted.kind,
                filename=wanted.filename,
                mapping=wanted.mapping,
                size=size,
                expires_at=expires_at,
            )
        )


def _drop_unless_begun(resources: Resources, fleet_id: str, upload_id: str) -> None:
    with resources.database.transaction(fleet_id, read_only=True) as session:
        begun = repository.upload(session, upload_id) is not None
    if not begun:
        staging_of(resources).remove(upload_id)
