"""Counts kept while an image is decoded."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from app.science.logger import kernels as k
from app.science.logger.assemble import Assembled
from app.science.logger.clock import LoggerClock
from app.science.logger.packets import TYPE_NAMES, PacketScanner, Scan
from app.science.logger.report import MOST_LISTED, DecodeReport, Resync, Skew, SkewReport, TripReport
from app.science.logger.stretch import Stretch
from app.science.logger.timed_nmea import TimedNmea
from app.science.logger.trips import Trip, TripSplitter
from app.science.logger.words import image_warnings

HEAD_BYTES = 1024


class Tally:
    """Adds up what the stages of the decoder found.

    Parameters
    ----------
    scanner, clock, reader, splitter
        The stages, asked for their own counts.
    """

    def __init__(self, scanner: PacketScanner, clock: LoggerClock, reader: TimedNmea, splitter: TripSplitter) -> None:
        self._scanner, self._clock, self._reader, self._splitter = scanner, clock, reader, splitter
        self.head = b""
        self._bytes = 0
        self._counts = np.zeros(k.COUNTS, np.int64)
        self.resyncs: list[Resync] = []
        self._skipped = 0
        self._errors: list[str] = []
        self._skews: list[Skew] = []
        self._skew_count, self._skew_total, self._skew_largest = 0, 0, 0
        self._trips: list[TripReport] = []
        self._trip_count = 0

    def add_block(self, block: bytes | memoryview) -> None:
        """Count bytes, and keep the first ones in case this is no image at all."""
        if len(self.head) < HEAD_BYTES:
            self.head += bytes(block[: HEAD_BYTES - len(self.head)])
        self._bytes += len(block)

    def add_scan(self, scan: Scan) -> None:
        """Count packets and damage."""
        self._counts += scan.counts
        self._skipped += int(scan.resyncs[:, 1].sum())
        room = MOST_LISTED - len(self.resyncs)
        self.resyncs += [Resync(offset, size) for offset, size in scan.resyncs[:room].tolist()]
        self._errors += scan.errors[: MOST_LISTED - len(self._errors)]

    def add_stretch(self, stretch: Stretch) -> None:
        """Count the logger's own notices of being late."""
        rows = np.flatnonzero(stretch.timed.kind == k.SKEW)
        if len(rows) == 0:
            return
        late_ms = stretch.timed.words[rows, 0]
        self._skew_count += len(rows)
        self._skew_total += int(late_ms.sum())
        self._skew_largest = max(self._skew_largest, int(late_ms.max()))
        listed = rows[: MOST_LISTED - len(self._skews)]
        self._skews += [Skew(int(stretch.timed.t_ms[row]) / 1e3, int(stretch.timed.words[row, 0])) for row in listed]

    def add_trip(self, trip: Trip, made: Assembled) -> TripReport:
        """Note a trip."""
        self._trip_count += 1
        stamped = [piece.timed.offset for piece in trip.pieces if len(piece.timed)]
        signals, gnss = made.recording.signals, made.gnss
        report = TripReport(
            number=self._trip_count,
            power_on=trip.pieces[0].run + 1,
            offset=int(stamped[0][0]),
            end_offset=int(stamped[-1][-1]),
            clock_origin_ms=made.clock_origin_ms,
            start_s=min(float(s.t_s[0]) for s in signals.values()),
            end_s=max(float(s.t_s[-1]) for s in signals.values()),
            started_at_utc_s=made.recording.started_at_utc_s,
            samples={name: len(s) for name, s in signals.items()},
            gnss_rate_ppm=None if gnss is None else gnss.rate_ppm,
            gnss_latency_spread_s=None if gnss is None else gnss.latency_spread_s,
            gnss_outliers=0 if gnss is None else int(np.count_nonzero(~gnss.used)),
            is_cut=trip.is_cut,
        )
        if len(self._trips) < MOST_LISTED:
            self._trips.append(report)
        return report

    def report(self) -> DecodeReport:
        """Return the account of everything so far."""
        counts, tail = self._counts, self._tail()
        splitter, clock = self._splitter, self._clock
        report = DecodeReport(
            bytes=self._bytes,
            packet_bytes=int(counts[k.PACKET_BYTES]),
            zero_tail_bytes=self._bytes - self._scanner.solid_end,
            truncated_tail_bytes=self.cut_tail.skipped_bytes if self.cut_tail else 0,
            byte_order={None: "little (assumed)", False: "little", True: "big"}[clock.big_endian],
            packets={name: int(counts[kind]) for kind, name in enumerate(TYPE_NAMES)},
            bad_checksums=int(counts[k.BAD_SUMS]),
            bad_headers=int(counts[k.BAD_HEADERS]),
            resync_count=int(counts[k.RESYNCS]) + (tail is not None),
            skipped_bytes=self._skipped + (tail.skipped_bytes if tail else 0),
            resyncs=(*self.resyncs, *([tail] if tail and len(self.resyncs) < MOST_LISTED else [])),
            gap_count=clock.gap_count,
            gaps=tuple(clock.gaps),
            untimed_text_bytes=clock.untimed_text_bytes,
            clock=clock.counts,
            skew=SkewReport(self._skew_count, self._skew_total, self._skew_largest, tuple(self._skews)),
            error_messages=tuple(self._errors),
            nmea=self._reader.counts,
            left_out_count=splitter.left_out_count,
            left_out=tuple(splitter.left_out),
            trip_count=self._trip_count,
            trips=tuple(self._trips),
        )
        return replace(report, warnings=image_warnings(report))

    @property
    def cut_tail(self) -> Resync | None:
        """The last packet when the image breaks off within it; None before the end."""
        tail = self._tail()
        return tail if tail and tail.skipped_bytes < k.LONGEST_PACKET else None

    def _tail(self) -> Resync | None:
        """Bytes behind the last packet that are neither packets nor zeros; only at the end is this damage."""
        lost_at = self._scanner.lost_at
        return None if lost_at is None else Resync(lost_at, self._scanner.solid_end - lost_at)
