"""The last byte is here: what the file is, whether it has been here before, and what becomes of it.

Everything up to the transaction can be done again, and the transaction decides. The received file stays until the
transaction is committed, so whatever dies in between is found complete and finished later.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import partial

from sqlalchemy.exc import IntegrityError
from sqlalchemy.orm import Session

from app.errors import NotFound, PonthyError, from_science, problem
from app.roads import service as roads
from app.science.errors import ScienceError
from app.storage.base import now
from app.storage.database import afterwards
from app.storage.resources import Resources
from app.trips import service as trips
from app.uploads import repository
from app.uploads.kinds import HEAD_BYTES, complaint
from app.uploads.models import Upload, UploadKind, UploadState
from app.uploads.staging import Staging


@dataclass(frozen=True, slots=True)
class Finding:
    """What was found out about a received file before the transaction.

    Attributes
    ----------
    sha256 : str
    blob_key : str
        Where its bytes are kept.
    table : roads.Table or None
        The elevation table it holds, where it is one.
    error : PonthyError or None
        Why it can't be used.
    """

    sha256: str
    blob_key: str
    table: roads.Table | None = None
    error: PonthyError | None = None


def staging_of(resources: Resources) -> Staging:
    """Return the folder of the uploads being received."""
    return Staging(resources.settings.staging_dir)


def finish(resources: Resources, fleet_id: str, upload_id: str) -> None:
    """Turn a completely received file into a trip and its job, or an elevation table; doing it again is harmless.

    The caller holds the upload's lock. A file that can't be used ends as a failed upload, its bytes kept.
    """
    with resources.database.transaction(fleet_id, read_only=True) as session:
        upload = repository.upload(session, upload_id)
    if upload is None:
        raise NotFound("upload", upload_id)
    if upload.state == UploadState.RECEIVING:
        finding = _examine(resources, upload)
        with resources.database.transaction(fleet_id) as session:
            _settle(session, resources, upload_id, finding)
    staging_of(resources).remove(upload_id)


def _examine(resources: Resources, upload: Upload) -> Finding:
    staging = staging_of(resources)
    key = f"fleets/{upload.fleet_id}/uploads/{upload.id}"
    sha256 = staging.sha256(upload.id)
    resources.blobs.adopt(key, staging.path(upload.id))
    error = complaint(staging.head(upload.id, HEAD_BYTES), upload.size, upload.filename, UploadKind(upload.kind))
    if error is not None or upload.kind == UploadKind.TRIP:
        return Finding(sha256, key, error=error)
    try:
        return Finding(sha256, key, table=roads.read_table(staging.path(upload.id).read_bytes()))
    except ScienceError as refused:
        return Finding(sha256, key, error=from_science(refused))


def _settle(session: Session, resources: Resources, upload_id: str, finding: Finding) -> None:
    upload = repository.upload(session, upload_id, lock=True)
    if upload is None:  # its car was removed meanwhile
        afterwards(session, partial(resources.blobs.delete, finding.blob_key))
        return
    if upload.state != UploadState.RECEIVING:
        return
    upload.sha256, upload.blob_key = finding.sha256, finding.blob_key
    upload.expires_at, upload.problem = None, None
    upload.updated_at = upload.completed_at = now()
    if finding.error is not None:
        upload.state, upload.problem = UploadState.FAILED, problem(finding.error)
        return
    upload.state = UploadState.COMPLETE
    if finding.table is not None:
        upload.duplicate = not roads.add_table(
            session, finding.table, name=upload.filename, blob_key=finding.blob_key
        ).is_new
    else:
        _make_trip(session, upload)
    if upload.duplicate:
        upload.blob_key = None
        afterwards(session, partial(resources.blobs.delete, finding.blob_key))


def _make_trip(session: Session, upload: Upload) -> None:
    first = _first_with_this_content(session, upload)
    if first is None:
        trips.accept_upload(session, upload)
    else:
        upload.duplicate, upload.duplicate_of = True, first.id


def _first_with_this_content(session: Session, upload: Upload) -> Upload | None:
    """Claim the content for this upload; return the upload that has it already, where one does.

    Two browsers may be here at the same time: the unique key lets one of them through.
    """
    key = f"{upload.car_id} {upload.sha256}"
    session.flush()
    try:
        with session.begin_nested():
            upload.content_key = key
    except IntegrityError:
        return repository.with_content(session, key)
    return None
