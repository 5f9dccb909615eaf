"""Uploads as the API shows them."""

from __future__ import annotations

from collections.abc import Sequence

from sqlalchemy.orm import Session

from app.jobs import service as jobs
from app.storage.resources import Resources
from app.trips import service as trips
from app.uploads.finishing import staging_of
from app.uploads.models import Upload, UploadState
from app.uploads.schemas import UploadDocument


def uploads(session: Session, resources: Resources, rows: Sequence[Upload]) -> list[UploadDocument]:
    """Return the documents of uploads."""
    trip_ids = {row.id: trips.ids_of_upload(session, row.duplicate_of or row.id) for row in rows}
    first = {upload_id: ids[0] for upload_id, ids in trip_ids.items() if ids}
    newest = jobs.newest_of_trips(session, list(first.values()))
    return [_document(row, resources, trip_ids[row.id], newest.get(first.get(row.id, ""))) for row in rows]


def upload(session: Session, resources: Resources, row: Upload) -> UploadDocument:
    """Return the document of one upload."""
    return uploads(session, resources, [row])[0]


def _document(row: Upload, resources: Resources, trip_ids: list[str], job: jobs.JobView | None) -> UploadDocument:
    return UploadDocument.model_validate(
        {
            "id": row.id,
            "state": row.state,
            "offset": offset_of(row, resources),
            "size": row.size,
            "filename": row.filename,
            "kind": row.kind,
            "car_id": row.car_id,
            "sha256": row.sha256,
            "trip_ids": trip_ids,
            "job_id": None if job is None else job.id,
            "duplicate": row.duplicate,
            "problem": row.problem,
            "created_at": row.created_at,
            "expires_at": row.expires_at,
            "completed_at": row.completed_at,
        }
    )


def offset_of(row: Upload, resources: Resources) -> int:
    """Return how many bytes of an upload are received and kept."""
    if row.state != UploadState.RECEIVING:
        return row.size
    try:
        return staging_of(resources).offset(row.id)
    except FileNotFoundError:
        return 0
