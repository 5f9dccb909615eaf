"""The logger image decoder: bytes in, one recording per trip out."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import dataclass, replace

from app.science.errors import DecodeError
from app.science.logger.assemble import assemble
from app.science.logger.clock import LoggerClock
from app.science.logger.packets import PacketScanner, Scan
from app.science.logger.recording import Recording
from app.science.logger.report import DecodeReport
from app.science.logger.tally import Tally
from app.science.logger.timed_nmea import TimedNmea
from app.science.logger.trips import Trip, TripSplitter
from app.science.logger.words import trip_warnings, why_nothing

__all__ = ["BLOCK_BYTES", "DecodeReport", "DecodedImage", "ImageDecoder", "decode_image"]

BLOCK_BYTES = 1 << 21
"""Bytes decoded at a time, so that what comes out doesn't depend on how the image is cut into chunks."""


class ImageDecoder:
    """Decodes a logger image of any size in bounded memory, one trip at a time.

    The format is that of Sebesta 2010, App. C.1.4–C.1.5, in either byte order. Damage costs the packets it touches.

    Parameters
    ----------
    off_after_s : float
        The car is off where no wheel ticks and no injector opens for longer than this, seconds.
    margin_s : float
        Standstill kept before and after a trip, seconds.
    longest_trip_bytes : int
        A drive whose packets take more memory than this is cut (about five hours of driving by default).

    Attributes
    ----------
    report : DecodeReport
        Account of what has been read so far; complete when `trips` is exhausted or has raised.
    """

    def __init__(
        self, *, off_after_s: float = 300.0, margin_s: float = 60.0, longest_trip_bytes: int = 128 << 20
    ) -> None:
        self._scanner, self._clock, self._nmea = PacketScanner(), LoggerClock(), TimedNmea()
        self._splitter = TripSplitter(off_after_s, margin_s, longest_trip_bytes)
        self._tally = Tally(self._scanner, self._clock, self._nmea, self._splitter)

    @property
    def report(self) -> DecodeReport:
        """Account of what has been read so far."""
        return self._tally.report()

    def trips(self, chunks: Iterable[bytes]) -> Iterator[Recording]:
        """Decode an image, handing out each trip when it has ended.

        Parameters
        ----------
        chunks : iterable of bytes
            The image in order, cut anywhere.

        Yields
        ------
        Recording
            Signals ``ax_mps2``, ``ay_mps2``, ``az_mps2`` (raw sensor axes), ``vss_tick``, ``injector_pulse_s`` (as
            measured, before the injector's lag), and from the receiver ``lat_deg``, ``lon_deg``, ``alt_m``, ``hdop``,
            ``satellites``, ``gnss_speed_mps``, ``heading_deg`` (while moving) and ``utc_s``; its sentences as text
            ``nmea``.

        Raises
        ------
        DecodeError
            At the end, when there was no drive in the image.
        """
        found = 0
        for recording in map(self._recording, self._found(chunks)):
            found += 1
            yield recording
        if not found:
            report = self.report
            raise DecodeError(why_nothing(report, self._tally.head), self._scanner.solid_end)

    def _recording(self, trip: Trip) -> Recording:
        made = assemble(trip)
        noted = self._tally.add_trip(trip, made)
        tally, clock = self._tally, self._clock
        warnings = trip_warnings(noted, tally.resyncs, clock.gaps, clock.rejected, tally.cut_tail)
        return replace(made.recording, warnings=warnings)

    def _found(self, chunks: Iterable[bytes]) -> Iterator[Trip]:
        """Run the stages block by block."""
        for block in blocks(chunks):
            self._tally.add_block(block)
            yield from self._split(self._scanner.scan(block), final=False)
        yield from self._split(self._scanner.scan(b"", final=True), final=True)
        yield from self._splitter.finish()

    def _split(self, scan: Scan, *, final: bool) -> Iterator[Trip]:
        self._tally.add_scan(scan)
        for stretch in self._clock.time(scan.packets, final=final):
            self._tally.add_stretch(stretch)
            yield from self._splitter.add(self._nmea.read(stretch))


def blocks(chunks: Iterable[bytes]) -> Iterator[bytes | memoryview]:
    """Cut and join chunks to blocks of `BLOCK_BYTES`; only the last one is shorter."""
    parts: list[memoryview] = []
    missing = BLOCK_BYTES
    for chunk in chunks:
        view = memoryview(chunk)
        while len(view) >= missing:
            parts.append(view[:missing])
            yield parts[0] if len(parts) == 1 else b"".join(parts)
            view, parts, missing = view[missing:], [], BLOCK_BYTES
        if len(view):
            parts.append(view)
            missing -= len(view)
    if parts:
        yield b"".join(parts)


@dataclass(frozen=True, slots=True)
class DecodedImage:
    """All trips of an image that fits into memory.

    Attributes
    ----------
    recordings : tuple of Recording
    report : DecodeReport
    """

    recordings: tuple[Recording, ...]
    report: DecodeReport


def decode_image(data: bytes) -> DecodedImage:
    """Decode a whole image at once; for large ones use `ImageDecoder`.

    Parameters
    ----------
    data : bytes

    Returns
    -------
    DecodedImage

    Raises
    ------
    DecodeError
        When there is no drive in it.
    """
    decoder = ImageDecoder()
    recordings = tuple(decoder.trips([data]))
    return DecodedImage(recordings, decoder.report)
