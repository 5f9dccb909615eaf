"""Results in words, for people who read a terminal."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from app.cli.output import table

MOST_PLACES = 10


def process_text(summary: Mapping[str, Any], out: Path) -> str:
    """Say what ``process`` found."""
    rows = [["states", "km", "min", "litres", "l/100 km", "points", "nis", "verdict"]]
    rows += [_trip_row(trip) for trip in summary["trips"]]
    lines = [table(rows), *summary["reasons"], *(f"warning: {warning}" for warning in summary["warnings"])]
    return "\n".join([*lines, f"written to {out} in {summary['timing_s']['total']:.1f} s"])


def _trip_row(trip: Mapping[str, Any]) -> list[str]:
    kilometres = None if trip["distance_m"] is None else trip["distance_m"] / 1000.0
    litres = trip["fuel_l"]
    consumption = 100.0 * litres / kilometres if litres and kilometres else None
    return [
        trip["states"],
        _number(kilometres, 1),
        _number(trip["duration_s"] / 60.0, 1),
        _number(litres, 2),
        _number(consumption, 1),
        str(trip["operating_points"]),
        _number(trip["nis"], 2),
        trip["verdict"],
    ]


def _number(value: float | None, digits: int) -> str:
    return "-" if value is None else f"{value:.{digits}f}"


def decode_text(report: Mapping[str, Any]) -> str:
    """Say what ``decode`` found; of many damaged places the rest stand in the JSON report."""
    packets = ", ".join(f"{count} {kind}" for kind, count in report["packets"].items() if count)
    lines = [
        f"{report['bytes']} bytes, {report['byte_order']}-endian: {report['packet_bytes']} in packets, "
        f"{report['zero_tail_bytes']} unwritten zeros at the end",
        f"packets: {packets or 'none'}",
        f"damage: {report['bad_checksums']} bad checksums, {report['bad_headers']} bad headers, "
        f"{report['resync_count']} resyncs over {report['skipped_bytes']} bytes, {report['gap_count']} gaps",
        *_places(report["resyncs"]),
    ]
    trips = (
        f"trip {trip['number']}: bytes {trip['offset']} to {trip['end_offset']}, "
        f"{trip['end_s'] - trip['start_s']:.0f} s, {sum(trip['samples'].values())} samples"
        for trip in report["trips"]
    )
    return "\n".join([*lines, *trips, *(f"warning: {warning}" for warning in report["warnings"])])


def _places(resyncs: Sequence[Mapping[str, int]]) -> list[str]:
    places = [f"{place['skipped_bytes']} bytes at {place['offset']}" for place in resyncs[:MOST_PLACES]]
    more = f", and {len(resyncs) - MOST_PLACES} more places" if len(resyncs) > MOST_PLACES else ""
    return [f"skipped: {', '.join(places)}{more}"] if places else []
