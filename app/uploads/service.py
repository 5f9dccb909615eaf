"""What others may ask of the uploads: begin one, look it up, end it; take a whole file; look after what was left."""

from __future__ import annotations

from functools import partial

import structlog
from sqlalchemy.orm import Session

from app.cars import service as cars
from app.errors import Conflict, Invalid, NotFound, PonthyError
from app.storage.base import new_id, now
from app.storage.database import afterwards
from app.storage.paging import DEFAULT_LIMIT, Page
from app.storage.resources import Resources
from app.uploads import repository, view
from app.uploads.finishing import finish, staging_of
from app.uploads.kinds import LARGEST_TABLE_BYTES
from app.uploads.models import Upload, UploadKind, UploadState
from app.uploads.receiving import Gone, TooLarge, begin, gathered, look_up, receive, receive_whole
from app.uploads.schemas import UploadDocument
from app.uploads.staging import UploadBusy
from app.uploads.tus import Wish, make_wish

__all__ = [
    "Gone",
    "UploadDocument",
    "Wish",
    "check_wish",
    "create",
    "delete",
    "document",
    "documents",
    "forget",
    "forget_of_car",
    "gathered",
    "make_wish",
    "reap",
    "receive",
    "receive_whole",
    "repaired",
]

log = structlog.get_logger(__name__)


def check_wish(session: Session, resources: Resources, wanted: Wish) -> None:
    """Refuse what is too large or for nobody's car, before a byte of it is sent."""
    limit = resources.settings.max_upload_bytes
    if wanted.kind is UploadKind.ELEVATION:
        limit = min(limit, LARGEST_TABLE_BYTES)
    if wanted.size > limit:
        raise TooLarge(limit)
    if wanted.car_id is None:
        return
    try:
        cars.get(session, wanted.car_id)
    except NotFound as error:
        raise Invalid("unknown-car", error.message, field="car_id") from error


def create(resources: Resources, fleet_id: str, wanted: Wish) -> str:
    """Begin an upload and return its identifier; raises when it is too large or its car is not there."""
    with resources.database.transaction(fleet_id, read_only=True) as session:
        check_wish(session, resources, wanted)
    upload_id = new_id()
    staging_of(resources).create(upload_id)
    begin(resources, fleet_id, wanted, upload_id, wanted.size)
    if wanted.size == 0:
        finish(resources, fleet_id, upload_id)
    return upload_id


def repaired(resources: Resources, fleet_id: str, upload_id: str) -> Upload:
    """Return an upload, after finishing it where all its bytes are here and a crash kept it from being finished.

    Raises
    ------
    NotFound, Gone
    """
    upload = look_up(resources, fleet_id, upload_id)
    if upload.state != UploadState.RECEIVING or view.offset_of(upload, resources) < upload.size:
        return upload
    try:
        with staging_of(resources).writer(upload_id):
            finish(resources, fleet_id, upload_id)
    except (UploadBusy, FileNotFoundError):
        log.debug("being finished by somebody else", upload_id=upload_id)
    return look_up(resources, fleet_id, upload_id)


def document(session: Session, resources: Resources, upload_id: str) -> UploadDocument:
    """Return an upload as the API shows it; raises `NotFound`."""
    return view.upload(session, resources, _get(session, upload_id))


def documents(
    session: Session, resources: Resources, cursor: str | None = None, limit: int = DEFAULT_LIMIT
) -> Page[UploadDocument]:
    """Return one page of the uploads, newest first."""
    page = repository.uploads(session, cursor, limit)
    return Page(view.uploads(session, resources, page.items), page.next_cursor)


def delete(session: Session, resources: Resources, upload_id: str) -> None:
    """End an upload and forget its bytes.

    Raises
    ------
    NotFound
        When there is no such upload.
    UploadBusy
        While somebody is sending.
    Conflict
        When a trip stands on it.
    """
    upload = _get(session, upload_id)
    if upload.state == UploadState.COMPLETE and upload.kind == UploadKind.TRIP and upload.duplicate_of is None:
        raise Conflict("upload-in-use", "A trip was made from this upload. Remove the trip; the file goes with it.")
    if upload.state == UploadState.RECEIVING:
        try:
            with staging_of(resources).writer(upload_id):
                staging_of(resources).remove(upload_id)
        except FileNotFoundError:
            log.debug("the bytes were gone already", upload_id=upload_id)
    forget(session, resources, upload_id)


def forget(session: Session, resources: Resources, upload_id: str) -> None:
    """Remove an upload and its file, once no trip needs it any more; its content may then be uploaded afresh."""
    upload = repository.upload(session, upload_id)
    if upload is None:
        return
    is_table = upload.kind == UploadKind.ELEVATION and upload.state == UploadState.COMPLETE
    if upload.blob_key is not None and not is_table:  # the bytes of a table belong to the table now
        afterwards(session, partial(resources.blobs.delete, upload.blob_key))
    session.delete(upload)
    session.flush()


def forget_of_car(session: Session, resources: Resources, car_id: str) -> None:
    """Remove all uploads of a car that is about to be removed; its trips are gone already."""
    for upload in repository.of_car(session, car_id):
        staging_of(resources).remove(upload.id)
        forget(session, resources, upload.id)


def reap(resources: Resources) -> None:
    """Finish what a crash left complete, drop what has expired, remove bytes that belong to nobody."""
    staging = staging_of(resources)
    with resources.database.system_transaction(read_only=True) as session:
        left = [(upload.id, upload.fleet_id, upload.expires_at) for upload in repository.receiving(session)]
    for upload_id, fleet_id, expires_at in left:
        try:
            if expires_at is not None and expires_at < now():
                with resources.database.transaction(fleet_id) as session:
                    delete(session, resources, upload_id)
            else:
                repaired(resources, fleet_id, upload_id)
        except (PonthyError, OSError) as error:
            log.warning("upload left for later", upload_id=upload_id, reason=str(error))
    here = staging.upload_ids()
    with resources.database.system_transaction(read_only=True) as session:
        known = repository.known_ids(session, here)
    for upload_id in set(here) - known:
        _remove_stray(resources, upload_id)


def _remove_stray(resources: Resources, upload_id: str) -> None:
    staging = staging_of(resources)
    try:
        with staging.writer(upload_id):  # a whole file being received has no row yet, but a writer
            staging.remove(upload_id)
    except (UploadBusy, FileNotFoundError):
        log.debug("not a stray file after all", upload_id=upload_id)


def _get(session: Session, upload_id: str) -> Upload:
    upload = repository.upload(session, upload_id)
    if upload is None:
        raise NotFound("upload", upload_id)
    return upload
