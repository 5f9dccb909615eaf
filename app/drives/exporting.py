"""Drives as files to save, made on request from their stored results."""

from __future__ import annotations

import json
from collections.abc import Mapping
from typing import Any, Literal

from sqlalchemy.orm import Session

from app.answers import FileFormat
from app.drives.models import Drive, Work
from app.drives.posing import resolved
from app.drives.results import document_of
from app.exports.drive import drive_csv, drive_parquet
from app.storage.blobs import Blobs

FormatName = Literal["json", "csv", "parquet", "problem"]


FORMATS: Mapping[FormatName, FileFormat] = {
    "json": FileFormat(".answer.json", "application/json"),
    "csv": FileFormat(".csv", "text/csv; charset=utf-8"),
    "parquet": FileFormat(".parquet", "application/vnd.apache.parquet"),
    "problem": FileFormat(".problem.json", "application/json"),
}


def export(session: Session, blobs: Blobs, drive: Drive, form: FormatName) -> bytes:
    """Return a drive as a file.

    Raises
    ------
    PonthyError
        When there is no answer yet; the problem is there from the beginning.
    """
    if form == "problem":
        return _text(resolved(drive.problem, drive.engine))
    answer = document_of(session, blobs, drive, Work.SOLVE)
    match form:
        case "json":
            return _text(answer | {"problem": resolved(drive.problem, drive.engine)})
        case "csv":
            return drive_csv(answer)
        case "parquet":
            return drive_parquet(answer)


def _text(document: dict[str, Any]) -> bytes:
    return json.dumps(document, indent=2, ensure_ascii=False, allow_nan=False).encode()
