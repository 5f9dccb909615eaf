"""A ZIP archive as the files of one trip, unpacked without trusting it."""

from __future__ import annotations

import io
import lzma
import struct
import zipfile
import zlib
from dataclasses import dataclass
from pathlib import PurePosixPath

from app.science.errors import SignalsError

MAGIC = b"PK\x03\x04"
TABLE_ENDINGS = (".csv", ".csv.gz", ".tsv", ".txt", ".parquet")
MOST_MEMBERS = 50
_DAMAGE = (zipfile.BadZipFile, zlib.error, lzma.LZMAError, struct.error, EOFError, RuntimeError, ValueError, OSError)


@dataclass(frozen=True, slots=True)
class Bundle:
    """Tables of an archive: name and content, and what in it is no table."""

    tables: tuple[tuple[str, bytes], ...]
    others: tuple[str, ...]


def looks_like_bundle(head: bytes) -> bool:
    """Tell whether an archive's first member is a table; Excel, Word and KMZ files are ZIP too, and begin otherwise."""
    if not head.startswith(MAGIC) or len(head) < 30:
        return False
    name = head[30 : 30 + int.from_bytes(head[26:28], "little")].decode("utf-8", "replace")
    return name.endswith("/") or _is_table(name) or _is_hidden(name)


def open_bundle(data: bytes, limit: int) -> Bundle:
    """Unpack the tables of an archive.

    Parameters
    ----------
    data : bytes
        The archive.
    limit : int
        Most bytes to unpack.

    Raises
    ------
    SignalsError
        When the archive is damaged, locked or too large, or holds no table.
    """
    try:
        archive = zipfile.ZipFile(io.BytesIO(data))
    except _DAMAGE as error:
        raise SignalsError("The ZIP archive is damaged or breaks off; copy it again.") from error
    names = [member for member in archive.infolist() if not member.is_dir() and not _is_hidden(member.filename)]
    members = [member for member in names if _is_table(member.filename)]
    if not members:
        raise SignalsError(f"The ZIP archive holds no table; tables end in {', '.join(TABLE_ENDINGS)}.")
    size = sum(member.file_size for member in members)  # nothing beyond what is declared gets unpacked
    if size > limit or len(members) > MOST_MEMBERS:
        raise SignalsError(
            f"The ZIP archive holds {len(members)} tables of {size // 1_000_000} MB together. Put the files of one "
            "trip into one archive."
        )
    if any(member.flag_bits & 1 for member in members):
        raise SignalsError("The ZIP archive is locked with a password; make one without.")
    tables = tuple((member.filename, _unpacked(archive, member)) for member in members)
    return Bundle(tables, tuple(member.filename for member in names if member not in members))


def _unpacked(archive: zipfile.ZipFile, member: zipfile.ZipInfo) -> bytes:
    try:
        return archive.read(member)
    except _DAMAGE as error:
        raise SignalsError(f"{member.filename} in the ZIP archive is damaged: {error}.") from error


def _is_table(name: str) -> bool:
    return name.lower().endswith(TABLE_ENDINGS) and PurePosixPath(name).stem.lower() not in {"readme", "license"}


def _is_hidden(name: str) -> bool:
    return any(part.startswith((".", "__MACOSX")) for part in PurePosixPath(name).parts)
