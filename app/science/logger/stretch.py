"""Timed packets of one power-on."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from app.science.arrays import AnyArray, BoolArray, IntArray
from app.science.logger.nmea import Sentences
from app.science.logger.nmea_kernels import VALUES


@dataclass(frozen=True, slots=True)
class Timed:
    """Stamped packets with a time that can be believed.

    Attributes
    ----------
    t_ms : array, shape (n,)
        Milliseconds since power-on, in the order of the image; nearly sorted, as sources interleave.
    kind, words, offset : arrays, shapes (n,), (n, 3), (n,)
        Type, 16-bit values, offset in the image.
    """

    t_ms: IntArray
    kind: AnyArray
    words: AnyArray
    offset: IntArray

    def __len__(self) -> int:
        return len(self.t_ms)


@dataclass(frozen=True, slots=True)
class Text:
    """GPS packets.

    Attributes
    ----------
    text : array of uint8, shape (b,)
        Their messages one after the other.
    end : array, shape (g,)
        Where each message ends.
    before_ms, after_ms : array, shape (g,)
        Time stamp of the packet before each, and when the one behind was written; equal when none is behind it in this
        power-on.
    """

    text: AnyArray
    end: IntArray
    before_ms: IntArray
    after_ms: IntArray


@dataclass(frozen=True, slots=True)
class TimedSentences:
    """Sentences with the times between which the packet with their dollar sign stands."""

    sentences: Sentences
    before_ms: IntArray
    after_ms: IntArray


@dataclass(frozen=True, slots=True)
class Stretch:
    """A piece of one power-on."""

    run: int
    timed: Timed
    text: Text
    told: TimedSentences

    @property
    def size(self) -> int:
        """Bytes the arrays take."""
        arrays = (self.timed.t_ms, self.timed.kind, self.timed.words, self.timed.offset)
        told = (self.told.sentences.values, self.told.before_ms, self.told.after_ms)
        return sum(a.nbytes for a in (*arrays, self.text.text, self.text.end, *told))

    @property
    def first_ms(self) -> int:
        """Time of its earliest packet; only for a stretch that has stamped packets."""
        return int(self.timed.t_ms.min())

    @property
    def last_ms(self) -> int:
        """Time of its latest packet; only for a stretch that has stamped packets."""
        return int(self.timed.t_ms.max())

    def between(self, from_ms: float, to_ms: float) -> Stretch:
        """Return copies of what lies at or after ``from_ms`` and before or at ``to_ms``."""
        rows = within(self.timed.t_ms, from_ms, to_ms)
        texts = within(self.text.before_ms, from_ms, to_ms)
        told = within(self.told.before_ms, from_ms, to_ms)
        size = np.diff(self.text.end, prepend=0)
        s = self.told.sentences
        return Stretch(
            self.run,
            Timed(self.timed.t_ms[rows], self.timed.kind[rows], self.timed.words[rows], self.timed.offset[rows]),
            Text(
                self.text.text[np.repeat(texts, size)],
                np.cumsum(size[texts]),
                self.text.before_ms[texts],
                self.text.after_ms[texts],
            ),
            TimedSentences(
                Sentences(s.kind[told], s.start[told], s.values[told]),
                self.told.before_ms[told],
                self.told.after_ms[told],
            ),
        )


def within(t_ms: IntArray, from_ms: float, to_ms: float) -> BoolArray:
    """Mark the times in a closed interval."""
    return np.asarray((t_ms >= from_ms) & (t_ms <= to_ms))


NO_SENTENCES = TimedSentences(
    Sentences(np.empty(0, np.uint8), np.empty(0, np.int64), np.empty((0, VALUES))),
    np.empty(0, np.int64),
    np.empty(0, np.int64),
)
