"""An object of an object store as a file that can be read anywhere, fetching only what is read."""

from __future__ import annotations

import io
from typing import Any

import obstore

BUFFER_BYTES = 256 * 1024


class ObjectReader(io.RawIOBase):
    """A seekable view of an object; wrap it in `io.BufferedReader`, because each read is a request.

    Parameters
    ----------
    store
        The obstore store it is in.
    key : str

    Raises
    ------
    FileNotFoundError
        When there is no such object.
    """

    def __init__(self, store: Any, key: str) -> None:
        self._store = store
        self._key = key
        self._size = int(obstore.head(store, key)["size"])
        self._at = 0

    def readable(self) -> bool:
        """Whether it can be read: yes."""
        return True

    def seekable(self) -> bool:
        """Whether one can go anywhere in it: yes."""
        return True

    def tell(self) -> int:
        """Return where the next read begins."""
        return self._at

    def seek(self, offset: int, whence: int = io.SEEK_SET) -> int:
        """Go to a place, counted from the start, from here, or from the end."""
        base = {io.SEEK_SET: 0, io.SEEK_CUR: self._at, io.SEEK_END: self._size}[whence]
        self._at = max(0, base + offset)
        return self._at

    def readinto(self, buffer: Any) -> int:
        """Fill a buffer as far as there are bytes; return how many were read."""
        end = min(self._at + len(buffer), self._size)
        if end <= self._at:
            return 0
        data = bytes(obstore.get_range(self._store, self._key, start=self._at, end=end))
        buffer[: len(data)] = data
        self._at += len(data)
        return len(data)
