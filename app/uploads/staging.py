"""Files while they are received. The offset of an upload is the length of its file, so no crash can make them differ.

Bytes that came with a checksum count only once the checksum is known to be right. Where such a chunk begins is noted
beside the file before its first byte is written, so that after a crash in its middle the offset is where it began.
"""

from __future__ import annotations

import fcntl
import hashlib
import os
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path

from app.errors import PonthyError
from app.storage.blobs import sync_folder

READ_BYTES = 4 * 1024**2


class UploadBusy(PonthyError):  # noqa: N818 - reads as the condition it names
    """Somebody else is writing to the upload at this moment."""

    def __init__(self) -> None:
        message = "Another sender is writing to this upload. Wait a moment, ask for the offset, then go on from there."
        super().__init__("upload-busy", message, 423, headers={"Retry-After": "2"})


class Staging:
    """A folder with one file for each upload being received.

    Parameters
    ----------
    folder : Path
        On a disk of this machine.
    """

    def __init__(self, folder: Path) -> None:
        self._folder = folder

    def path(self, upload_id: str) -> Path:
        """Return where the bytes of an upload are."""
        return self._folder / f"{upload_id}.part"

    def _mark(self, upload_id: str) -> Path:
        return self._folder / f"{upload_id}.unverified"

    def create(self, upload_id: str) -> None:
        """Begin an upload with no bytes."""
        self._folder.mkdir(parents=True, exist_ok=True)
        self.path(upload_id).touch(exist_ok=False)
        sync_folder(self._folder)

    def offset(self, upload_id: str) -> int:
        """Return how many bytes are kept; raises `FileNotFoundError` when the upload has no file."""
        size = self.path(upload_id).stat().st_size
        with suppress(FileNotFoundError, ValueError):
            return min(size, int(self._mark(upload_id).read_text()))
        return size

    @contextmanager
    def writer(self, upload_id: str) -> Iterator[Writer]:
        """Open an upload for one writer; a lock of the operating system keeps others out and dies with the process.

        Raises
        ------
        UploadBusy
            When somebody else writes to it.
        FileNotFoundError
            When the upload has no file.
        """
        descriptor = os.open(self.path(upload_id), os.O_RDWR)
        try:
            try:
                fcntl.flock(descriptor, fcntl.LOCK_EX | fcntl.LOCK_NB)
            except BlockingIOError as error:
                raise UploadBusy from error
            if not self.path(upload_id).exists():  # removed by the one who held the lock before
                raise FileNotFoundError(upload_id)
            yield Writer(descriptor, self._mark(upload_id))
        finally:
            os.close(descriptor)

    def head(self, upload_id: str, length: int) -> bytes:
        """Return the first bytes of an upload, as many as asked for or there are."""
        with self.path(upload_id).open("rb") as file:
            return file.read(length)

    def sha256(self, upload_id: str) -> str:
        """Return the SHA-256 of an upload's bytes, read piece by piece."""
        digest = hashlib.sha256()
        with self.path(upload_id).open("rb") as file:
            while piece := file.read(READ_BYTES):
                digest.update(piece)
        return digest.hexdigest()

    def remove(self, upload_id: str) -> None:
        """Forget the bytes of an upload."""
        for path in (self.path(upload_id), self._mark(upload_id)):
            path.unlink(missing_ok=True)

    def upload_ids(self) -> list[str]:
        """Return the identifiers of all uploads that have a file here."""
        return sorted(path.stem for path in self._folder.glob("*.part"))


class Writer:
    """Appends to one upload while its lock is held."""

    def __init__(self, descriptor: int, mark: Path) -> None:
        self._descriptor = descriptor
        self._mark = mark
        with suppress(FileNotFoundError, ValueError):  # a crash in the middle of a chunk with a checksum
            self.cut(int(mark.read_text()))
        mark.unlink(missing_ok=True)
        self.offset = os.lseek(descriptor, 0, os.SEEK_END)

    def write(self, data: bytes) -> None:
        """Append bytes; on a full disk those that fit stay, and the error goes on."""
        view = memoryview(data)
        while view:
            written = os.write(self._descriptor, view)
            self.offset += written
            view = view[written:]

    def begin_unverified(self) -> None:
        """Note that what follows counts only after `verified`."""
        self._mark.write_text(str(self.offset))
        sync_folder(self._mark.parent)

    def verified(self) -> None:
        """Keep what was written since `begin_unverified`."""
        self.sync()
        self._mark.unlink(missing_ok=True)

    def cut(self, offset: int) -> None:
        """Drop what is beyond an offset."""
        os.ftruncate(self._descriptor, offset)
        self.offset = os.lseek(self._descriptor, 0, os.SEEK_END)
        self._mark.unlink(missing_ok=True)

    def sync(self) -> None:
        """Return once the bytes are on the disk."""
        os.fsync(self._descriptor)
