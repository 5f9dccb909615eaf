"""Several files of one trip as one recording."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from app.imports.repair import CLOCK_TEXT, EARLIEST_START_S, SOURCE_TEXT
from app.science.errors import SignalsError
from app.science.logger.recording import Recording, Series

SAME_CLOCK_S = 2.0
"""Zeros that receivers place this close together are one: their stamps come late by up to a second."""
_YEAR_2000 = 0.946e9


def combine(recordings: Sequence[Recording], *, names: Sequence[str] = ()) -> Recording:
    """Join the files of one trip on one time axis.

    Files of one logger share its clock, so their times are taken as they are. Files whose times are UTC, or that know
    UTC from a receiver and lie more than 2 s apart by it, are placed by UTC.

    Parameters
    ----------
    recordings : sequence of Recording
        The first one's time axis is kept unless another begins before it. Of a signal that several have, the first is
        taken.
    names : sequence of str, optional
        What to call the files in warnings.

    Raises
    ------
    SignalsError
        When there is no recording, or two have no clock in common.
    """
    if not recordings:
        raise SignalsError("There is no file to combine.")
    first, *others = recordings
    if not others:
        return first
    labels = list(names) or [f"File {number}" for number in range(1, len(recordings) + 1)]
    shifts = [0.0, *(_shift(other, first, label) for label, other in zip(labels[1:], others, strict=True))]
    signals: dict[str, Series] = {}
    warnings: list[str] = []
    for label, recording, shift in zip(labels, recordings, shifts, strict=True):
        warnings += [f"{label}: {warning}" for warning in recording.warnings]
        twice = [name for name in recording if name in signals]
        if twice:
            warnings.append(f"{label}: {', '.join(twice)} left out, because an earlier file has it.")
        signals |= {
            name: Series(series.t_s + shift, series.value)
            for name, series in recording.signals.items()
            if name not in signals
        }
        if not _overlap(first, recording, shift):
            warnings.append(f"{label} doesn't overlap with the first file in time: do they belong to one trip?")
    begin = min((float(series.t_s[0]) for series in signals.values()), default=0.0)
    zero = begin if begin < EARLIEST_START_S else 0.0
    if zero:
        signals = {name: Series(series.t_s - zero, series.value) for name, series in signals.items()}
    started = _started_at(recordings, shifts)
    texts = {name: text for recording in reversed(recordings) for name, text in recording.texts.items()}
    texts.pop(CLOCK_TEXT, None)
    if clock_zero := _clock_zero(first) + zero:
        texts[CLOCK_TEXT] = repr(clock_zero)
    sources = dict.fromkeys(r.texts[SOURCE_TEXT] for r in recordings if SOURCE_TEXT in r.texts)
    if sources:
        texts[SOURCE_TEXT] = "; ".join(sources)
    return Recording(signals, None if started is None else started + zero, texts, tuple(warnings))


def _shift(other: Recording, first: Recording, label: str) -> float:
    """Return what to add to a recording's times to have them on the first one's axis."""
    own, reference = _clock_zero(other), _clock_zero(first)
    utc_own, utc_reference = own >= _YEAR_2000, reference >= _YEAR_2000
    if utc_own == utc_reference:
        by_clock = own - reference
        if utc_own or other.started_at_utc_s is None or first.started_at_utc_s is None:
            return by_clock
        by_utc = other.started_at_utc_s - first.started_at_utc_s
        return by_clock if abs(by_utc - by_clock) <= SAME_CLOCK_S else by_utc
    if other.started_at_utc_s is None or first.started_at_utc_s is None:
        raise SignalsError(
            f"{label} and the first file have no clock in common: one has UTC, the other its own time and no "
            "receiver. Give both files times of one clock."
        )
    return other.started_at_utc_s - first.started_at_utc_s


def _clock_zero(recording: Recording) -> float:
    """Return what the file's own clock showed at the recording's zero."""
    try:
        return float(recording.texts.get(CLOCK_TEXT, "0"))
    except ValueError:
        return 0.0


def _overlap(first: Recording, other: Recording, shift: float) -> bool:
    begin, end = _span(first)
    other_begin, other_end = _span(other)
    return other_begin + shift <= end and other_end + shift >= begin


def _span(recording: Recording) -> tuple[float, float]:
    begins = [series.t_s[0] for series in recording.signals.values() if len(series)]
    return (float(min(begins)), recording.duration_s) if begins else (np.inf, -np.inf)


def _started_at(recordings: Sequence[Recording], shifts: Sequence[float]) -> float | None:
    for recording, shift in zip(recordings, shifts, strict=True):
        if recording.started_at_utc_s is not None:
            return recording.started_at_utc_s - shift
    return None
