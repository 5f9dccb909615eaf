"""Receiver text of timed packets as timed sentences."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from app.science.arrays import IntArray
from app.science.logger.nmea import NmeaCounts, NmeaReader
from app.science.logger.stretch import Stretch, TimedSentences


class TimedNmea:
    """Reads the sentences of stretch after stretch; one begun in a stretch may end in the next of the same power-on."""

    def __init__(self) -> None:
        self._reader = NmeaReader()
        self._run = -1
        self._end = np.empty(0, np.int64)
        self._before_ms = np.empty(0, np.int64)
        self._after_ms = np.empty(0, np.int64)

    def read(self, stretch: Stretch) -> Stretch:
        """Return the stretch with the sentences that end in it."""
        text = stretch.text
        if stretch.run != self._run:
            self._reader.forget()
            self._run = stretch.run
            self._keep(0, text.end[:0], text.before_ms[:0], text.after_ms[:0])
        sentences = self._reader.read(text.text)
        end = np.concatenate((self._end, text.end))
        before_ms = np.concatenate((self._before_ms, text.before_ms))
        after_ms = np.concatenate((self._after_ms, text.after_ms))
        packet = np.searchsorted(end, sentences.start, side="right")
        self._keep(len(text.text), end, before_ms, after_ms)
        return replace(stretch, told=TimedSentences(sentences, before_ms[packet], after_ms[packet]))

    @property
    def counts(self) -> NmeaCounts:
        """Sentences so far."""
        return self._reader.counts

    def _keep(self, size: int, end: IntArray, before_ms: IntArray, after_ms: IntArray) -> None:
        """Keep the times of the packets that hold the unfinished sentence; their ends count from the next text."""
        needed = end > size - self._reader.unfinished
        self._end, self._before_ms, self._after_ms = end[needed] - size, before_ms[needed], after_ms[needed]
