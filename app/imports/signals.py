"""Signals tables (CSV, packed CSV, Parquet; long or wide; Ponthy's names or a foreign logger's) as recordings."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from app.imports.bundle import MAGIC, open_bundle
from app.imports.combine import combine
from app.imports.known import recognise
from app.imports.mapping import SignalMapping
from app.imports.repair import CLOCK_TEXT, SOURCE_TEXT, Repairs, find_clock, on_clock, sampled_together, tidy
from app.imports.streams import LongTable, Source, Stream, mapped_stream, open_source
from app.imports.table import LARGEST_BYTES, Table, read_table
from app.science.errors import SignalsError
from app.science.logger.recording import SIGNAL_UNITS, Recording, Series

__all__ = ["SignalMapping", "read_signals"]


def read_signals(data: bytes, *, filename: str, mapping: SignalMapping | None = None) -> Recording:
    """Read a signals table, or several of one trip from a ZIP archive.

    Parameters
    ----------
    data : bytes
        CSV with comma, semicolon or tab (with a semicolon or tab, numbers may have decimal commas), the same packed
        with gzip, or Parquet. Long (``t_s,signal,value``) or wide (``t_s`` and a column for each signal). Or a ZIP
        archive of such files, which are joined as by `combine`.
    filename : str
        Only for messages.
    mapping : SignalMapping, optional
        How foreign columns become signals. Without one, the loggers that Ponthy knows are recognised.

    Returns
    -------
    Recording
        Rows that can't be used are left out, disorder is mended, and the warnings say so. Times since 1970 set
        ``started_at_utc_s``, and so does a ``utc_s`` signal. A table that Ponthy wrote itself reads back as it was.

    Raises
    ------
    SignalsError
        When nothing can be used: with row and column where that helps.
    """
    return _bundled(data, mapping) if data.startswith(MAGIC) else _single(data, filename, mapping)


def _single(data: bytes, filename: str, mapping: SignalMapping | None) -> Recording:
    table = read_table(data)
    if table.metadata:
        return _written_by_ponthy(table)
    chosen = mapping or recognise(table) or SignalMapping()
    source = open_source(table, chosen)
    streams = _signals(source, table, chosen, filename)
    repairs = Repairs()
    streams = {name: tidied for name, stream in streams.items() if len(tidied := tidy(name, stream, repairs))}
    streams = {name: stream for name, stream in sampled_together(streams, repairs).items() if len(stream)}
    if not streams:
        raise _nothing(source, table, filename)
    clock = find_clock(streams)
    streams = {name: stream for name, one in streams.items() if len(stream := on_clock(name, one, clock, repairs))}
    signals = {name: _series(streams[name]) for name in SIGNAL_UNITS if name in streams}
    texts = {} if clock.zero_s == 0.0 else {CLOCK_TEXT: repr(clock.zero_s)}
    if mapping is None and chosen.name:
        texts[SOURCE_TEXT] = chosen.name
    if clock.zero_s and not clock.is_utc:
        repairs.note(f"Times began at {clock.zero_s:g} s; they are counted from the first one.", "")
    warnings = (*table.warnings, *repairs.sentences())
    return Recording(signals, clock.zero_s if clock.is_utc else _started_at(signals), texts, warnings)


def _bundled(data: bytes, mapping: SignalMapping | None) -> Recording:
    """Join the tables of an archive; one that can't be used is left out as long as another can."""
    bundle = open_bundle(data, LARGEST_BYTES)
    read: dict[str, Recording] = {}
    failed: list[SignalsError] = []
    for name, content in bundle.tables:
        try:
            read[name] = _single(content, name, mapping)
        except SignalsError as error:
            failed.append(SignalsError(f"{name} can't be used: {error}", error.row, error.field))
    if not read:
        raise failed[0]
    joined = combine(list(read.values()), names=list(read))
    return replace(joined, warnings=(*joined.warnings, *(str(error) for error in failed)))


def _signals(source: Source, table: Table, mapping: SignalMapping, filename: str) -> dict[str, Stream]:
    """Return the streams by signal name: those of the mapping first, then columns that bear a signal's name."""
    streams: dict[str, Stream] = {}
    used: set[str] = set()
    for column, wanted in mapping.signals.items():
        if column not in source.names:
            continue
        used |= {column, wanted.times, *wanted.mean_with}
        stream = mapped_stream(source, column, wanted, mapping)
        if stream is None:
            table.warnings.append(
                f"{column} needs “{wanted.times}”, which is neither a column nor a constant of the mapping; "
                f"{wanted.signal} is left out."
            )
        elif wanted.signal in streams and len(stream):
            table.warnings.append(f"{column} is left out: {wanted.signal} comes from an earlier column.")
        else:
            streams[wanted.signal] = stream
    lower = {name.lower(): name for name in SIGNAL_UNITS}
    left_out = []
    for column in source.names:
        name = lower.get(column.lower())
        if column in used or column in mapping.drop:
            continue
        if name is None or name in streams:
            left_out.append(column)
        else:
            streams[name] = source.stream(column)
    if left_out and "*" not in mapping.drop:
        table.warnings.append(f"Columns that aren't signals were left out: {', '.join(left_out[:20])}.")
    if not streams:
        raise _nothing(source, table, filename)
    return streams


def _nothing(source: Source, table: Table, filename: str) -> SignalsError:
    bad = next((name for name in table.names if table.first_bad_row(name)), "")
    row = table.first_bad_row(bad) if bad else 0
    found = ", ".join(source.names[:12])
    return SignalsError(
        f"{filename or 'The table'} holds no signal that can be used"
        + (f" (row {row}: “{bad}” isn't a number)" if bad else "")
        + f". Its columns are {found}; signals are named like speed_mps or engine_speed_rpm, and a mapping renames "
        "others.",
        row,
        bad,
    )


def _series(stream: Stream) -> Series:
    return Series(np.ascontiguousarray(stream.t_s), np.ascontiguousarray(stream.value))


def _started_at(signals: dict[str, Series]) -> float | None:
    """Return UTC at time zero from the receiver's stamps; the middle one, because single stamps come late."""
    utc = signals.get("utc_s")
    return float(np.median(utc.value - utc.t_s)) if utc else None


def _written_by_ponthy(table: Table) -> Recording:
    """Read back what `app.exports.parquet.recording_parquet` wrote, untouched."""
    about = table.metadata
    source = LongTable(table, SignalMapping())
    streams = {name: source.stream(name) for name in source.names if name in SIGNAL_UNITS}
    if any(np.any(np.diff(stream.t_s) <= 0.0) for stream in streams.values()) or not streams:
        raise SignalsError(
            "This file of Ponthy's has been changed since: times aren't in order. Export the trip again."
        )
    texts, started = about.get("texts", {}), about.get("started_at_utc_s")
    if not isinstance(texts, dict) or not isinstance(started, int | float | None):
        raise SignalsError(
            "This file of Ponthy's has been changed since: its metadata is damaged. Export the trip again."
        )
    recording = Recording(
        {name: _series(stream) for name, stream in streams.items()},
        None if started is None else float(started),
        {str(key): str(text) for key, text in texts.items()},
        tuple(str(one) for one in about.get("warnings", ())),
    )
    return replace(recording, warnings=(*recording.warnings, *table.warnings))
