"""Whether a file can be what its sender says it is, told from its first bytes."""

from __future__ import annotations

from app.errors import Invalid, PonthyError
from app.imports.detect import detect_format, explain_unknown
from app.uploads.models import UploadKind

HEAD_BYTES = 64 * 1024
"""First bytes that are looked at."""
LARGEST_TABLE_BYTES = 256 * 1024**2
"""Largest elevation table; it is read in one piece."""


def complaint(head: bytes, size: int, filename: str, kind: UploadKind) -> PonthyError | None:
    """Return what is wrong with a file, or None when it may well be fine.

    Parameters
    ----------
    head : bytes
        Its first `HEAD_BYTES`.
    size : int
        Its length.
    filename : str
    kind : UploadKind
        What it is meant to be.
    """
    if size == 0:
        return Invalid("empty-file", f"{filename} is empty: nothing was recorded, or the copy went wrong.")
    match detect_format(head, filename), kind:
        case ("logger" | "signals", UploadKind.TRIP) | ("elevation" | "signals", UploadKind.ELEVATION):
            return None  # a table without the right columns is for its reader to judge, who names row and column
        case "elevation", _:
            message = f"{filename} is an elevation table, not a trip. Upload it as an elevation table."
        case "car_xml", _:
            message = f"{filename} is a car's XML. Put it in on the car's page, or PUT it to the car's config."
        case (("logger" | "signals"), _):
            message = f"{filename} holds measurements of a trip, not elevations. Upload it as a trip."
        case _:
            message = f"{filename} can't be used. {explain_unknown(head, filename)}"
    return Invalid("wrong-kind-of-file", message)
