"""Everything a service keeps, in one tar file, and back.

The archive holds the database, every file under its key, and last a manifest. A file that lacks the manifest was
not finished and is refused.
"""

from __future__ import annotations

import json
import shutil
import sqlite3
import tarfile
from contextlib import closing
from datetime import UTC, datetime
from io import BytesIO
from pathlib import Path
from tempfile import NamedTemporaryFile, TemporaryDirectory
from typing import IO, Any

from sqlalchemy import make_url

from app import __version__
from app.errors import PonthyError
from app.settings import Settings
from app.storage.blobs import Blobs

DATABASE, FILES, MANIFEST = "database.sqlite3", "files/", "manifest.json"


def write_archive(settings: Settings, blobs: Blobs, path: Path) -> dict[str, Any]:
    """Write all data to a tar file that must not exist yet; safe while the service runs.

    The database is copied first. Files are written once and never changed, so those that it names are there still.

    Returns
    -------
    dict
        The manifest.

    Raises
    ------
    PonthyError
        When the database is not SQLite, or the file exists.
    """
    source = sqlite_file(settings)
    if path.exists():
        raise PonthyError("archive-exists", f"{path} exists already. Give another name or remove it.", 409)
    with TemporaryDirectory(dir=path.parent, prefix=".ponthy-backup-") as folder:
        copy, unfinished = Path(folder) / DATABASE, Path(folder) / path.name
        copy_database(source, copy)
        with tarfile.open(unfinished, "w") as archive:
            archive.add(copy, DATABASE)
            keys = blobs.keys("")
            size = sum(_add_blob(archive, blobs, key) for key in keys)
            manifest = {
                "ponthy": __version__,
                "made_at": datetime.now(UTC).isoformat(timespec="seconds"),
                "files": len(keys),
                "file_bytes": size,
                "database_bytes": copy.stat().st_size,
            }
            text = json.dumps(manifest, indent=2).encode()
            entry = tarfile.TarInfo(MANIFEST)
            entry.size = len(text)
            archive.addfile(entry, BytesIO(text))
        unfinished.replace(path)
    return manifest


def read_archive(settings: Settings, blobs: Blobs, path: Path) -> dict[str, Any]:
    """Put the data of a tar file into a service that has none.

    The database comes last, so that an interrupted restore never looks like a finished one.

    Returns
    -------
    dict
        The manifest.

    Raises
    ------
    PonthyError
        When there is data already, or the file is not a whole archive.
    """
    target = sqlite_file(settings)
    if target.exists():
        raise PonthyError("not-empty", f"{target} exists. Restore into an empty data folder (--data DIR).", 409)
    target.parent.mkdir(parents=True, exist_ok=True)
    database = target.with_suffix(".restoring")
    manifest: dict[str, Any] | None = None
    files = 0
    try:
        with tarfile.open(path, "r:") as archive:
            for entry in archive:
                content = archive.extractfile(entry)
                if content is None:
                    continue
                if entry.name == DATABASE:
                    with database.open("wb") as file:
                        shutil.copyfileobj(content, file)
                elif entry.name == MANIFEST:
                    manifest = json.load(content)
                elif entry.name.startswith(FILES):
                    _take_blob(blobs, entry.name.removeprefix(FILES), content)
                    files += 1
    except tarfile.TarError as error:
        raise PonthyError("bad-archive", f"{path} is not a whole tar file: {error}.", 422) from error
    if manifest is None or manifest["files"] != files or not database.exists():
        raise PonthyError("bad-archive", f"{path} is not a whole archive made by `backup`: parts are missing.", 422)
    database.replace(target)
    return manifest


def sqlite_file(settings: Settings) -> Path:
    """Return the file of the SQLite database.

    Raises
    ------
    PonthyError
        When another database is in use.
    """
    url = make_url(settings.database)
    if url.get_backend_name() != "sqlite" or not url.database:
        message = "This service keeps its data in PostgreSQL: use pg_dump and pg_restore, and copy the files beside it."
        raise PonthyError("not-sqlite", message, 422)
    return Path(url.database)


def copy_database(source: Path, target: Path) -> None:
    """Copy a SQLite database as it is at one moment, while others write to it, and check the copy."""
    if not source.exists():
        raise PonthyError("no-data", f"There is no Ponthy data at {source.parent}. Name its folder with --data.", 404)
    with (
        closing(sqlite3.connect(f"file:{source}?mode=ro", uri=True)) as reading,
        closing(sqlite3.connect(target)) as to,
    ):
        reading.backup(to)
        to.execute("PRAGMA journal_mode=DELETE")
        (result,) = to.execute("PRAGMA integrity_check").fetchone()
    if result != "ok":
        raise PonthyError("damaged-database", f"The database is damaged: {result}", 500)


def _add_blob(archive: tarfile.TarFile, blobs: Blobs, key: str) -> int:
    with NamedTemporaryFile() as spool:
        for piece in blobs.stream(key):
            spool.write(piece)
        spool.flush()
        spool.seek(0)
        entry = tarfile.TarInfo(f"{FILES}{key}")
        entry.size = Path(spool.name).stat().st_size
        archive.addfile(entry, spool)
    return entry.size


def _take_blob(blobs: Blobs, key: str, content: IO[bytes]) -> None:
    if key.startswith("/") or ".." in key.split("/"):
        raise PonthyError("bad-archive", f"The archive holds a file that would land outside: {key!r}.", 422)
    with NamedTemporaryFile() as spool:
        shutil.copyfileobj(content, spool)
        spool.flush()
        blobs.adopt(key, Path(spool.name))
