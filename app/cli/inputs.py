"""Files of any known kind as recordings, one trip after the other."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from enum import StrEnum
from hashlib import sha256
from pathlib import Path
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from app.science.logger.recording import Recording

CHUNK_BYTES = 4 * 1024**2
HEAD_BYTES = 64 * 1024
IN_ANY_TABLE = {"utc_s", "satellites", "hdop"}
"""Signals that tables of one trip may both have: a receiver's account of itself."""


class InputFormat(StrEnum):
    """What a file holds."""

    AUTO = "auto"
    LOGGER = "logger"
    SIGNALS = "signals"


@dataclass(frozen=True, slots=True)
class Trip:
    """A recording and the name of the file, or files, that it came from."""

    name: str
    recording: Recording


def recordings(
    paths: Sequence[Path], form: InputFormat = InputFormat.AUTO, mapping: Path | None = None
) -> Iterator[Trip]:
    """Give the trips of files one by one, in the order of the files; of a logger image, one trip is held at a time.

    Tables that follow each other, share no signal and have a clock in common are one trip: what some loggers write
    as a file for the engine and a file for the receiver.

    Raises
    ------
    ScienceError
        When a file holds nothing usable.
    """
    tables: list[Trip] = []
    for path in paths:
        if form_of(path, form) == InputFormat.LOGGER:
            yield from joined(tables)
            yield from decoded(path)
            tables = []
            continue
        table = Trip(path.name, signals(path, mapping))
        if tables and not is_one_trip([*tables, table]):
            yield from joined(tables)
            tables = []
        tables.append(table)
    yield from joined(tables)


def decoded(path: Path) -> Iterator[Trip]:
    """Give the trips of a logger image."""
    from app.science.logger.decode import ImageDecoder

    for recording in ImageDecoder().trips(chunks(path)):
        yield Trip(path.name, recording)


def signals(path: Path, mapping: Path | None) -> Recording:
    """Return the recording of a signals table, with the columns renamed by a mapping file."""
    from app.imports.signals import SignalMapping, read_signals

    chosen = None if mapping is None else SignalMapping.from_json(mapping.read_text(encoding="utf-8"))
    return read_signals(path.read_bytes(), filename=path.name, mapping=chosen)


def form_of(path: Path, wanted: InputFormat) -> InputFormat:
    """Return what a file holds: what was asked for, or what its first bytes look like.

    Raises
    ------
    SignalsError
        When they look like nothing that holds measurements.
    """
    from app.imports.detect import detect_format, explain_unknown
    from app.science.errors import SignalsError

    if wanted != InputFormat.AUTO:
        return wanted
    with path.open("rb") as file:
        head = file.read(HEAD_BYTES)
    match detect_format(head, path.name):
        case "logger" | "signals" as found:
            return InputFormat(found)
        case "unknown":
            raise SignalsError(f"{path.name}: {explain_unknown(head, path.name)}")
        case other:
            raise SignalsError(f"{path.name} holds no measurements: it is {other.replace('_', ' ')}.")


def is_one_trip(tables: Sequence[Trip]) -> bool:
    """Say whether tables are pieces of one trip: none has a signal of another, and their clocks can be joined."""
    from app.imports.combine import combine
    from app.science.errors import SignalsError

    *earlier, last = tables
    if any((set(last.recording) & set(table.recording)) - IN_ANY_TABLE for table in earlier):
        return False
    try:
        combine([table.recording for table in tables])
    except SignalsError:
        return False
    return True


def joined(tables: Sequence[Trip]) -> Iterator[Trip]:
    """Give the one trip of some tables; none when there are none."""
    from app.imports.combine import combine

    if tables:
        names = [table.name for table in tables]
        yield Trip(" + ".join(names), combine([table.recording for table in tables], names=names))


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
