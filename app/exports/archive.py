"""Zip archives whose bytes depend on nothing but their content."""

from __future__ import annotations

from collections.abc import Mapping
from io import BytesIO
from zipfile import ZIP_DEFLATED, ZipFile, ZipInfo

EARLIEST = (1980, 1, 1, 0, 0, 0)
READABLE = 0o644 << 16
UNIX = 3
FAST = 1  # a trip's numbers are mostly noise: more effort takes longer and saves next to nothing


def zip_bytes(files: Mapping[str, bytes]) -> bytes:
    """Pack files under their names, in the given order, with a fixed date."""
    packed = BytesIO()
    with ZipFile(packed, "w") as archive:
        for name, content in files.items():
            entry = ZipInfo(name, EARLIEST)
            entry.compress_type, entry.external_attr, entry.create_system = ZIP_DEFLATED, READABLE, UNIX
            archive.writestr(entry, content, compresslevel=FAST)
    return packed.getvalue()


def file_stem(name: str) -> str:
    """Return a name that every file system takes: what could be a path or a control character becomes ``_``."""
    stem = "".join(c if c.isprintable() and c not in '/\\:*?"<>|' else "_" for c in name).strip(". ")
    return stem[:100] or "trip"
