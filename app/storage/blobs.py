"""Files: a local folder or an S3-compatible object store, under keys like ``fleets/{fleet}/uploads/{id}``."""

from __future__ import annotations

import errno
import io
import os
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from datetime import timedelta
from pathlib import Path
from typing import Any, BinaryIO

import obstore
from obstore.exceptions import AlreadyExistsError, BaseError
from obstore.store import LocalStore, S3Store

from app.errors import PonthyError
from app.storage.ranges import BUFFER_BYTES, ObjectReader

CHUNK_BYTES = 4 * 1024**2
RETRY_FOR = timedelta(seconds=20)
"""How long a request to the object store is tried again before the caller hears of it."""


class FilesUnavailable(PonthyError):  # noqa: N818 - reads as the condition it names
    """The object store doesn't answer, or not as it should."""

    def __init__(self) -> None:
        message = "The store of the files doesn't answer at the moment. Try again in a minute."
        super().__init__("files-unavailable", message, 503, headers={"Retry-After": "60"})


@contextmanager
def _understood() -> Iterator[None]:
    """Say the store's failures in our words: a full disk as the operating system does, anything else as ours."""
    try:
        yield
    except BaseError as error:
        if isinstance(error, FileNotFoundError | AlreadyExistsError):
            raise
        if f"os error {errno.ENOSPC}" in str(error):
            raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC)) from error
        raise FilesUnavailable from error


class Blobs:
    """Named bytes that are written once and read in pieces.

    Parameters
    ----------
    folder : Path
        Where the bytes are kept when ``url`` is not given.
    url : str, optional
        ``s3://bucket/prefix``; credentials come from the usual AWS environment variables.
    endpoint : str, optional
        Endpoint of an S3-compatible store.
    """

    def __init__(self, folder: Path, url: str | None = None, endpoint: str | None = None) -> None:
        self._folder: Path | None = None
        self._store: LocalStore | S3Store
        if url is None:
            folder.mkdir(parents=True, exist_ok=True)
            self._folder = folder
            self._store = LocalStore(prefix=folder, automatic_cleanup=True)
        else:
            options: dict[str, Any] = {}
            if endpoint is not None:
                options = {"endpoint": endpoint, "client_options": {"allow_http": endpoint.startswith("http://")}}
            self._store = S3Store.from_url(url, retry_config={"retry_timeout": RETRY_FOR}, **options)

    def put(self, key: str, data: bytes) -> None:
        """Write bytes, replacing what is there; a reader sees the old or the new, never a mixture."""
        with _understood():
            obstore.put(self._store, key, data)

    def put_new(self, key: str, data: bytes) -> bool:
        """Write bytes unless the key is taken; return whether they were written."""
        try:
            with _understood():
                obstore.put(self._store, key, data, mode="create")
        except AlreadyExistsError:
            return False
        return True

    def adopt(self, key: str, path: Path) -> None:
        """Store a finished file. Doing it again is harmless: a key always stands for the same content.

        In a local folder on the same disk this costs no copy: the file gets a second name.
        """
        target = self.local_path(key)
        if target is None:
            with _understood():
                obstore.put(self._store, key, path)
            return
        target.parent.mkdir(parents=True, exist_ok=True)
        try:
            with suppress(FileExistsError):
                os.link(path, target)
                sync_folder(target.parent)
        except OSError:  # another disk, or a file system without hard links
            with _understood():
                obstore.put(self._store, key, path)

    def get(self, key: str) -> bytes:
        """Return all bytes of a key; raises `FileNotFoundError`."""
        with _understood():
            return bytes(obstore.get(self._store, key).bytes())

    def stream(self, key: str, chunk_bytes: int = CHUNK_BYTES) -> Iterator[bytes]:
        """Give the bytes of a key piece by piece, so that a file of any size needs little memory."""
        path = self.local_path(key)
        if path is None:
            with _understood():
                for piece in obstore.get(self._store, key).stream(min_chunk_size=chunk_bytes):
                    yield bytes(piece)
            return
        with path.open("rb") as file:
            while piece := file.read(chunk_bytes):
                yield piece

    def open(self, key: str) -> BinaryIO:
        """Return a key's bytes as a file to read anywhere in; raises `FileNotFoundError`. The caller closes it."""
        path = self.local_path(key)
        return io.BufferedReader(ObjectReader(self._store, key), BUFFER_BYTES) if path is None else path.open("rb")

    def size(self, key: str) -> int:
        """Return the number of bytes of a key; raises `FileNotFoundError`."""
        with _understood():
            return int(obstore.head(self._store, key)["size"])

    def exists(self, key: str) -> bool:
        """Whether a key is there."""
        try:
            self.size(key)
        except FileNotFoundError:
            return False
        return True

    def delete(self, *keys: str) -> None:
        """Remove keys; one that is not there is as good as removed."""
        for key in keys:
            with suppress(FileNotFoundError), _understood():
                obstore.delete(self._store, key)

    def keys(self, prefix: str) -> list[str]:
        """Return all keys below a prefix, sorted."""
        with _understood():
            return sorted(entry["path"] for batch in obstore.list(self._store, prefix=prefix) for entry in batch)

    def delete_below(self, prefix: str) -> None:
        """Remove every key below a prefix."""
        self.delete(*self.keys(prefix))

    def local_path(self, key: str) -> Path | None:
        """Return the file behind a key, or None in an object store; readers may map it, nobody writes it."""
        return None if self._folder is None else self._folder / key

    def check(self) -> None:
        """Raise when the store doesn't answer."""
        with _understood():
            next(iter(obstore.list(self._store, prefix="ready", chunk_size=1)), None)


def sync_folder(folder: Path) -> None:
    """Return once the entries of a folder are on the disk."""
    descriptor = os.open(folder, os.O_RDONLY)
    try:
        os.fsync(descriptor)
    finally:
        os.close(descriptor)
