"""The decoder's findings in plain words."""

from __future__ import annotations

from collections.abc import Sequence

from app.science.logger.filetype import looks_like
from app.science.logger.kernels import LONGEST_PACKET
from app.science.logger.report import DecodeReport, Gap, Resync, TripReport

FEWEST_SHARE = 0.01
"""Bytes in packets, of all that aren't zero, below which a file isn't a logger image: accidents of an 8-bit sum."""
NOTABLE_SKEW_MS = 50


def many(count: int, one: str, more: str = "") -> str:
    """Return ``1 packet`` or ``2,000 packets``."""
    return f"{count:,} {one if count == 1 else more or one + 's'}"


def image_warnings(report: DecodeReport) -> tuple[str, ...]:
    """Say what a person should know about a whole image."""
    said = []
    if report.byte_order == "big":
        said.append("Numbers are stored most significant byte first; their order was told from the time stamps.")
    if report.resync_count:
        first = report.resyncs[0]
        said.append(
            f"The image is damaged in {many(report.resync_count, 'place')}, the first at byte {first.offset:,}: "
            f"{many(report.skipped_bytes, 'byte')} skipped, all packets around kept."
        )
    if report.truncated_tail_bytes:
        said.append(f"The last packet is cut off after {many(report.truncated_tail_bytes, 'byte')}.")
    clock = report.clock
    if clock.jumps_rejected:
        said.append(
            f"{many(clock.jumps_rejected, 'packet')} left out because the packets behind contradict the time stamp."
        )
    if clock.backward_steps:
        said.append(f"The logger's clock was set back {many(clock.backward_steps, 'time')}; time went on from there.")
    if clock.wraps:
        said.append(f"The logger's 32-bit clock ran over {many(clock.wraps, 'time')}; time was counted on.")
    if report.gap_count:
        longest = max(gap.to_s - gap.from_s for gap in report.gaps)
        said.append(f"The logger was silent {many(report.gap_count, 'time')}, for {longest:.1f} s at most.")
    if report.skew.largest_ms >= NOTABLE_SKEW_MS:
        said.append(f"The logger came late to its work by up to {report.skew.largest_ms} ms, as it noted itself.")
    if report.error_messages:
        said.append(
            f"The logger noted {many(report.packets['error'], 'error')}, the first one: {report.error_messages[0]!r}."
        )
    if report.nmea.bad_checksum + report.nmea.malformed:
        said.append(
            f"{many(report.nmea.bad_checksum + report.nmea.malformed, 'GPS sentence')} left out: "
            f"{report.nmea.bad_checksum:,} with a wrong checksum, {report.nmea.malformed:,} malformed."
        )
    if report.left_out_count:
        said.append(
            f"{many(report.left_out_count, 'stretch', 'stretches')} in which the car was off: "
            f"no wheel ticked and no injector opened. They belong to no trip."
        )
    return tuple(said)


def trip_warnings(
    trip: TripReport, resyncs: Sequence[Resync], gaps: Sequence[Gap], rejected: Sequence[int], cut_tail: Resync | None
) -> tuple[str, ...]:
    """Say what a person should know about one trip.

    Parameters
    ----------
    trip : TripReport
    resyncs, gaps : sequence
        Of the whole image.
    rejected : sequence of int
        Offsets of packets left out for their time stamps, of the whole image.
    cut_tail : Resync or None
        The packet within which the image breaks off.
    """
    said = []
    damage = [place for place in resyncs if trip.offset <= place.offset <= trip.end_offset]
    if damage:
        said.append(
            f"The image is damaged in {many(len(damage), 'place')} of this trip, the first at byte "
            f"{damage[0].offset:,}: {many(sum(place.skipped_bytes for place in damage), 'byte')} skipped."
        )
    silent = [gap.to_s - gap.from_s for gap in gaps if trip.offset < gap.offset <= trip.end_offset]
    if silent:
        said.append(f"The logger was silent {many(len(silent), 'time')}, for {max(silent):.1f} s at most.")
    contradicted = sum(trip.offset <= offset <= trip.end_offset for offset in rejected)
    if contradicted:
        said.append(f"{many(contradicted, 'packet')} left out because the packets behind contradict the time stamp.")
    if trip.gnss_outliers:
        said.append(f"{many(trip.gnss_outliers, 'GPS fix', 'GPS fixes')} left out: UTC doesn't fit the logger's clock.")
    if cut_tail and cut_tail.offset - trip.end_offset < 2 * LONGEST_PACKET:
        said.append("The image breaks off within a packet: the end of this drive may be missing.")
    if trip.is_cut:
        said.append("The drive goes on in the next trip: it was too long to be held in one piece.")
    return tuple(said)


def why_nothing(report: DecodeReport, head: bytes) -> str:
    """Say why an image gave no trip, and what to do.

    Parameters
    ----------
    report : DecodeReport
    head : bytes
        The first bytes of the image.
    """
    if report.bytes == 0:
        return "The file is empty (0 bytes). Copy the image from the logger's card again."
    solid = report.bytes - report.zero_tail_bytes
    if solid == 0:
        return (
            f"All {report.bytes:,} bytes are zero: the logger has written nothing to this card. "
            f"Check its power and its card, then drive."
        )
    if report.packet_bytes < FEWEST_SHARE * solid:
        kind = looks_like(head)
        return (
            f"This is no logger image: {many(sum(report.packets.values()), 'packet')} in {many(solid, 'byte')}"
            f"{f'; it looks like {kind}' if kind else ''}. Upload the file copied from the logger's card."
        )
    found = ", ".join(f"{count:,} {name}" for name, count in report.packets.items() if count)
    return (
        f"There is no drive in this image: it holds packets ({found}), but no wheel tick, no injector pulse and no "
        f"GPS speed above walking pace with a time stamp that can be believed. Check the logger's wiring."
    )
