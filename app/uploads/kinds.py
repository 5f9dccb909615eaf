"""Whether a file can be what its sender says it is, told from its first bytes."""

from __future__ import annotations

from app.errors import Invalid, PonthyError, from_science
from app.imports.detect import detect_format
from app.science.errors import ScienceError
from app.uploads.models import UploadKind

LARGEST_TABLE_BYTES = 256 * 1024**2


def complaint(head: bytes, size: int, filename: str, kind: UploadKind) -> PonthyError | None:
    """Return what is wrong with a file, or None when it may well be fine.

    Parameters
    ----------
    head : bytes
        Its first bytes.
    size : int
        Its length.
    filename : str
    kind : UploadKind
        What it is meant to be.
    """
    if size == 0:
        return Invalid("empty-file", f"{filename} is empty; nothing was recorded, or the copy went wrong.")
    if kind is UploadKind.ELEVATION:
        return None if b"\0" not in head else Invalid("not-a-table", f"{filename} is not a text file with columns.")
    try:
        detect_format(head, filename)
    except ScienceError as error:
        return from_science(error)
    return None
