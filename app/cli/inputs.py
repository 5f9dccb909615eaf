"""Files of any known kind as recordings, one trip after the other."""

from __future__ import annotations

from collections.abc import Iterator
from enum import StrEnum
from hashlib import sha256
from pathlib import Path
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from app.science.logger.decode import DecodeReport
    from app.science.logger.recording import Recording

CHUNK_BYTES = 4 * 1024**2
HEAD_BYTES = 64 * 1024


class InputFormat(StrEnum):
    """What a file holds."""

    AUTO = "auto"
    LOGGER = "logger"
    SIGNALS = "signals"


class InputFile:
    """A file with measurements; `trips` gives its recordings, and `report` tells afterwards how decoding went."""

    def __init__(self, path: Path, form: InputFormat = InputFormat.AUTO, mapping: Path | None = None) -> None:
        self.path = path
        self.report: DecodeReport | None = None
        self._form = form
        self._mapping = mapping

    def trips(self) -> Iterator[Recording]:
        """Give the recordings one by one; of a logger image, no more than one trip is held at a time.

        Raises
        ------
        ScienceError
            When the file holds nothing usable.
        """
        if self.form() == InputFormat.LOGGER:
            yield from self._decoded()
        else:
            yield self._signals()

    def form(self) -> InputFormat:
        """Return what the file holds: what was asked for, or what its first bytes look like.

        Raises
        ------
        SignalsError
            When they look like nothing that holds measurements.
        """
        from app.imports.detect import detect_format, explain_unknown
        from app.science.errors import SignalsError

        if self._form != InputFormat.AUTO:
            return self._form
        with self.path.open("rb") as file:
            head = file.read(HEAD_BYTES)
        match detect_format(head, self.path.name):
            case "logger" | "signals" as found:
                return InputFormat(found)
            case "unknown":
                raise SignalsError(f"{self.path.name}: {explain_unknown(head, self.path.name)}")
            case other:
                raise SignalsError(f"{self.path.name} holds no measurements: it is {other.replace('_', ' ')}.")

    def _decoded(self) -> Iterator[Recording]:
        from app.science.logger.decode import ImageDecoder

        decoder = ImageDecoder()
        yield from decoder.trips(chunks(self.path))
        self.report = decoder.report

    def _signals(self) -> Recording:
        from app.imports.signals import SignalMapping, read_signals

        mapping = None if self._mapping is None else SignalMapping.from_json(self._mapping.read_text())
        return read_signals(self.path.read_bytes(), filename=self.path.name, mapping=mapping)


def chunks(path: Path) -> Iterator[bytes]:
    """Give a file piece by piece."""
    with path.open("rb") as file:
        while piece := file.read(CHUNK_BYTES):
            yield piece


def fingerprint(path: Path) -> str:
    """Return the SHA-256 of a file."""
    digest = sha256()
    for piece in chunks(path):
        digest.update(piece)
    return digest.hexdigest()
