"""A file of measurements comes in, as the body or as a form's file, in small memory; nothing of it is lost."""

from __future__ import annotations

import fcntl
import hashlib
import tempfile
from collections.abc import AsyncGenerator, AsyncIterator
from contextlib import asynccontextmanager
from dataclasses import dataclass
from datetime import datetime
from pathlib import Path
from typing import IO

from fastapi import Request
from starlette.concurrency import run_in_threadpool
from starlette.datastructures import UploadFile
from starlette.formparsers import MultiPartException, MultiPartParser

from app.errors import Invalid, PonthyError, from_os
from app.storage.resources import Resources
from app.uploads import service as uploads

LARGEST_FILE_BYTES = 512 * 1024**2
"""It is read in one piece; a hundred days at 1 Hz have half of that as text."""
PIECE_BYTES = 1024**2
LONGEST_NAME = 300
FORM = "multipart/form-data"
MOST_FIELDS = 20


@dataclass(frozen=True, slots=True)
class SentFile:
    """A file that has come in whole.

    Attributes
    ----------
    path : Path
        Where it lies until it is adopted.
    name : str
    sha256 : str
    size : int
    began_at : datetime or None
        When its time is zero, as its sender said.
    """

    path: Path
    name: str
    sha256: str
    size: int
    began_at: datetime | None


@asynccontextmanager
async def received(
    request: Request, resources: Resources, name: str, began_at: datetime | None
) -> AsyncIterator[SentFile]:
    """Take the file of a request; it is gone when the block ends, unless somebody adopted it.

    Raises
    ------
    PonthyError
        413 when it is too long, 422 when there is none or it is empty, 507 when the disk is full.
    """
    folder = resources.settings.staging_dir
    limit = min(resources.settings.max_upload_bytes, LARGEST_FILE_BYTES)
    folder.mkdir(parents=True, exist_ok=True)
    with tempfile.NamedTemporaryFile(dir=folder, suffix=".part") as file:
        fcntl.flock(file, fcntl.LOCK_EX)  # what a crash leaves here has no lock, and goes with other stray uploads
        try:
            given = await _take(request, file, limit, resources.settings.upload_idle_s)
        except OSError as error:
            raise from_os(error) or error from error
        size = file.tell()
        if size == 0:
            raise Invalid("empty-file", "The file is empty: nothing was recorded, or the copy went wrong.")
        digest = await run_in_threadpool(_settled, file)
        yield SentFile(Path(file.name), _clean(name or given), digest, size, began_at)


async def _take(request: Request, file: IO[bytes], limit: int, idle_s: float) -> str:
    """Write the body, or the form's file, and return the name that the form gives it."""
    body = _limited(uploads.gathered(request.stream(), idle_s), limit)
    if not request.headers.get("content-type", "").lower().startswith(FORM):
        async for piece in body:
            await run_in_threadpool(file.write, piece)
        return ""
    try:
        form = await MultiPartParser(request.headers, body, max_files=1, max_fields=MOST_FIELDS).parse()
    except MultiPartException as error:
        raise Invalid("bad-form", f"The form can't be read: {error.message} Send one file with it.") from error
    try:
        found = next((value for value in form.values() if isinstance(value, UploadFile)), None)
        if found is None:
            raise Invalid("no-file", "The form has no file. Send it as a field of any name, or as the body.")
        while piece := await found.read(PIECE_BYTES):
            await run_in_threadpool(file.write, piece)
        return found.filename or ""
    finally:
        await form.close()


async def _limited(stream: AsyncIterator[bytes], limit: int) -> AsyncGenerator[bytes]:
    length = 0
    async for piece in stream:
        length += len(piece)
        if length > limit:
            raise PonthyError("file-too-large", f"A battery's file has {limit} bytes at most; this one has more.", 413)
        yield piece


def _settled(file: IO[bytes]) -> str:
    file.flush()
    digest = hashlib.sha256()
    with Path(file.name).open("rb") as written:
        while piece := written.read(PIECE_BYTES):
            digest.update(piece)
    return digest.hexdigest()


def _clean(name: str) -> str:
    last = name.replace("\\", "/").rpartition("/")[2]
    return "".join(letter for letter in last if letter.isprintable()).strip()[-LONGEST_NAME:] or "battery data"
