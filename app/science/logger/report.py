"""What the decoder has to say about an image, besides the trips in it."""

from __future__ import annotations

from dataclasses import asdict, dataclass, field
from typing import Any

from app.science.logger.nmea import NmeaCounts

MOST_LISTED = 1_000
"""Entries kept of each list; the totals count on."""


@dataclass(frozen=True, slots=True)
class Resync:
    """A place where packets stopped.

    Attributes
    ----------
    offset : int
        First byte that doesn't belong to a packet.
    skipped_bytes : int
        Bytes until the next packet, zeros at the end not counted.
    """

    offset: int
    skipped_bytes: int


@dataclass(frozen=True, slots=True)
class Gap:
    """A silence of more than a second with the logger's clock running on.

    Attributes
    ----------
    offset : int
        Offset of the first packet after it.
    from_s, to_s : float
        On the logger's clock, seconds since power-on.
    """

    offset: int
    from_s: float
    to_s: float


@dataclass(frozen=True, slots=True)
class ClockCounts:
    """What happened to the logger's clock.

    Attributes
    ----------
    restarts : int
        Times it began anew: the logger lost power.
    wraps : int
        Times 32 bits of milliseconds ran over (every 49.7 days).
    jumps_rejected : int
        Packets left out because the ones behind them contradict their time stamp.
    backward_steps : int
        Times it was set back a little and went on from there.
    """

    restarts: int = 0
    wraps: int = 0
    jumps_rejected: int = 0
    backward_steps: int = 0


@dataclass(frozen=True, slots=True)
class Skew:
    """The logger's own notice that it came late to its work.

    Attributes
    ----------
    t_s : float
        Seconds since power-on.
    late_ms : int
    """

    t_s: float
    late_ms: int


@dataclass(frozen=True, slots=True)
class SkewReport:
    """All such notices: how many, how late together and at worst, and the first ones."""

    count: int = 0
    total_ms: int = 0
    largest_ms: int = 0
    listed: tuple[Skew, ...] = ()


@dataclass(frozen=True, slots=True)
class LeftOut:
    """A piece of a power-on that belongs to no trip.

    Attributes
    ----------
    offset : int
        Offset of its first packet.
    from_s, to_s : float
        Seconds since power-on.
    """

    offset: int
    from_s: float
    to_s: float


@dataclass(frozen=True, slots=True)
class TripReport:
    """One trip of the image.

    Attributes
    ----------
    number : int
        Counted from 1.
    power_on : int
        Which power-on of the logger it lies in, counted from 1.
    offset, end_offset : int
        Offsets of its first and last packet.
    clock_origin_ms : int
        Milliseconds since power-on at which the recording's ``t_s`` is zero.
    start_s, end_s : float
        First and last packet on the recording's own clock.
    started_at_utc_s : float or None
        UTC of time zero.
    samples : dict of str to int
        Number of samples by signal.
    gnss_rate_ppm, gnss_latency_spread_s : float or None
        How much faster than UTC the logger's clock ran; how unevenly the receiver's text arrived.
    gnss_outliers : int
        Fixes left out because their UTC doesn't fit the logger's clock.
    is_cut : bool
        The drive goes on in the next trip; it was too long for one.
    """

    number: int
    power_on: int
    offset: int
    end_offset: int
    clock_origin_ms: int
    start_s: float
    end_s: float
    started_at_utc_s: float | None
    samples: dict[str, int]
    gnss_rate_ppm: float | None
    gnss_latency_spread_s: float | None
    gnss_outliers: int
    is_cut: bool


@dataclass(frozen=True, slots=True)
class DecodeReport:
    """Account of a whole image, or of what has been read of it so far.

    Attributes
    ----------
    bytes : int
        Length of the image.
    packet_bytes, zero_tail_bytes, truncated_tail_bytes : int
        Bytes in packets; unwritten zeros at the end; beginning of a packet whose end is missing at the end.
    byte_order : str
        ``little``, ``big`` or, when no time stamps tell, ``little (assumed)``.
    packets : dict of str to int
        Packets by type.
    bad_checksums, bad_headers : int
        Packets given up for a wrong sum, and for an unknown type or an impossible length.
    resyncs : tuple of Resync
        The first `MOST_LISTED` of ``resync_count``, which together skipped ``skipped_bytes``.
    gaps : tuple of Gap
        The first of ``gap_count``.
    untimed_text_bytes : int
        Receiver text left out because no time stamp stands anywhere near it.
    clock : ClockCounts
    skew : SkewReport
    error_messages : tuple of str
        The logger's own, the first of ``packets["error"]``.
    nmea : NmeaCounts
    left_out : tuple of LeftOut
        Where the car was off, the first of ``left_out_count``.
    trips : tuple of TripReport
        The first of ``trip_count``.
    warnings : tuple of str
        All of the above that a person should know, in words.
    """

    bytes: int = 0
    packet_bytes: int = 0
    zero_tail_bytes: int = 0
    truncated_tail_bytes: int = 0
    byte_order: str = "little (assumed)"
    packets: dict[str, int] = field(default_factory=dict)
    bad_checksums: int = 0
    bad_headers: int = 0
    resync_count: int = 0
    skipped_bytes: int = 0
    resyncs: tuple[Resync, ...] = ()
    gap_count: int = 0
    gaps: tuple[Gap, ...] = ()
    untimed_text_bytes: int = 0
    clock: ClockCounts = field(default_factory=ClockCounts)
    skew: SkewReport = field(default_factory=SkewReport)
    error_messages: tuple[str, ...] = ()
    nmea: NmeaCounts = field(default_factory=NmeaCounts)
    left_out_count: int = 0
    left_out: tuple[LeftOut, ...] = ()
    trip_count: int = 0
    trips: tuple[TripReport, ...] = ()
    warnings: tuple[str, ...] = ()

    def to_dict(self) -> dict[str, Any]:
        """Return the same as plain dicts, lists and numbers, ready for JSON."""
        plain = asdict(self)
        return {name: list(value) if isinstance(value, tuple) else value for name, value in plain.items()}
