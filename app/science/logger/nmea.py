"""Receiver text (NMEA 0183) as numbers: GGA, RMC, GSA and VTG of any talker; every other sentence is only counted."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from app.science.arrays import AnyArray, FloatArray, IntArray
from app.science.logger import nmea_kernels as k

SHORTEST_SENTENCE = 9  # a dollar sign, an address of three, a comma, the star, two digits, with something between


@dataclass(frozen=True, slots=True)
class Sentences:
    """Numbers of the sentences that carry position, time, speed or precision, in the order of the text.

    Attributes
    ----------
    kind : array of uint8, shape (n,)
        ``GGA``, ``RMC``, ``GSA`` or ``VTG`` of `app.science.logger.nmea_kernels`.
    start : array, shape (n,)
        Index of the dollar sign in the text.
    values : array, shape (n, VALUES)
        Columns ``TIME_OF_DAY`` (s), ``DAY`` (days since 1970), ``LAT``, ``LON`` (degrees, north and east positive),
        ``ALT`` (m above the geoid), ``HDOP``, ``SATELLITES``, ``QUALITY`` (0: no position), ``SPEED`` (m/s) and
        ``COURSE`` (degrees); NaN where the sentence doesn't say.
    """

    kind: AnyArray
    start: IntArray
    values: FloatArray

    def __len__(self) -> int:
        return len(self.kind)


@dataclass(frozen=True, slots=True)
class NmeaCounts:
    """What a receiver's text held.

    Attributes
    ----------
    sentences : dict of str to int
        Sentences whose checksum is right, by type (``GGA``, …; proprietary ones by maker, ``PMTK``; ``other``).
    bad_checksum : int
        Sentences whose checksum is wrong.
    malformed : int
        Sentences without a checksum, with foreign bytes inside, too few fields or an impossible position.
    no_fix : int
        GGA and RMC sentences in which the receiver says that it has no position.
    """

    sentences: dict[str, int] = field(default_factory=dict)
    bad_checksum: int = 0
    malformed: int = 0
    no_fix: int = 0


@dataclass(frozen=True, slots=True)
class ParsedNmea:
    """All numbers and counts of one text."""

    sentences: Sentences
    counts: NmeaCounts


class NmeaReader:
    """Reads receiver text that comes in pieces cut anywhere."""

    def __init__(self) -> None:
        self._bins = np.zeros(k.TYPE_BINS, np.int64)
        self._counts = np.zeros(k.COUNTS, np.int64)
        self._rest = np.empty(0, np.uint8)

    def read(self, text: AnyArray) -> Sentences:
        """Return the sentences that end in this piece.

        Parameters
        ----------
        text : array of uint8, shape (n,)
            The next piece.

        Returns
        -------
        Sentences
            Their ``start`` counts from the first byte of this piece, so it is negative for a sentence begun earlier.
        """
        joined = np.concatenate((self._rest, text))
        room = len(joined) // SHORTEST_SENTENCE + 1
        kind, start = np.empty(room, np.uint8), np.empty(room, np.int64)
        values = np.empty((room, k.VALUES))
        self._counts[k.ROWS] = 0
        done = k.read_sentences(joined, kind, start, values, self._bins, self._counts)
        rows = int(self._counts[k.ROWS])
        begun = len(self._rest)
        self._rest = joined[done:].copy()
        return Sentences(kind[:rows].copy(), start[:rows] - begun, values[:rows].copy())

    def forget(self) -> None:
        """Drop the unfinished sentence: the power went, its end will never come."""
        self._rest = self._rest[:0]

    @property
    def unfinished(self) -> int:
        """Bytes of the unfinished sentence at the end."""
        return len(self._rest)

    @property
    def counts(self) -> NmeaCounts:
        """Counts since the reader was made."""
        return NmeaCounts(
            {type_name(int(key)): int(self._bins[key]) for key in np.flatnonzero(self._bins)},
            int(self._counts[k.BAD_CHECKSUMS]),
            int(self._counts[k.MALFORMED]),
            int(self._counts[k.NO_FIX]),
        )


def parse_nmea(text: bytes) -> ParsedNmea:
    """Parse a whole text.

    Checksums are verified; bytes outside sentences (binary messages, comments, line ends) are passed over.

    Parameters
    ----------
    text : bytes
        Sentences as the receiver sent them.

    Returns
    -------
    ParsedNmea
    """
    reader = NmeaReader()
    sentences = reader.read(np.frombuffer(text, np.uint8))
    return ParsedNmea(sentences, reader.counts)


def type_name(key: int) -> str:
    """Return the name of a counting bin: ``GGA``, ``PMTK`` or ``other``."""
    if key == k.OTHER_TYPE:
        return "other"
    prefix, key = ("P", key - k.TYPES) if key >= k.TYPES else ("", key)
    return prefix + "".join(chr(k.A + key // k.LETTERS**power % k.LETTERS) for power in (2, 1, 0))
