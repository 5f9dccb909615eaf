"""Bodies of the uploads' answers."""

from __future__ import annotations

from typing import Any, Literal

from pydantic import ConfigDict, Field

from app.schemas import Document, Moment

UPLOAD_EXAMPLE: dict[str, Any] = {
    "id": "6f1c2f0b8d8e4a0f9a52f1b6c0de0004",
    "state": "complete",
    "offset": 52428800,
    "size": 52428800,
    "filename": "27-october.dat",
    "kind": "trip",
    "car_id": "6f1c2f0b8d8e4a0f9a52f1b6c0de0003",
    "sha256": "0e5751c026e543b2e8ab2eb06099daa1d1e5df47778f7787faab45cdf12fe3a8",
    "trip_ids": ["6f1c2f0b8d8e4a0f9a52f1b6c0de0002"],
    "job_id": "6f1c2f0b8d8e4a0f9a52f1b6c0de0001",
    "duplicate": False,
    "problem": None,
    "created_at": "2026-03-01T08:00:00Z",
    "expires_at": None,
    "completed_at": "2026-03-01T08:00:41Z",
}


class UploadDocument(Document):
    """A file on its way in, or in.

    While it is `receiving`, a `problem` tells early that the file can't become what it is meant to be; the upload will
    fail with it. A `duplicate` brought nothing new: its trips are those that the same content made before.
    """

    model_config = ConfigDict(from_attributes=True, json_schema_extra={"example": UPLOAD_EXAMPLE})

    id: str
    state: Literal["receiving", "complete", "failed"]
    offset: int = Field(description="Bytes received and kept.")
    size: int
    filename: str
    kind: Literal["trip", "elevation"]
    car_id: str | None
    sha256: str | None
    trip_ids: list[str]
    job_id: str | None
    duplicate: bool
    problem: dict[str, Any] | None
    created_at: Moment
    expires_at: Moment | None = Field(description="An unfinished upload is dropped then, unless bytes come.")
    completed_at: Moment | None
