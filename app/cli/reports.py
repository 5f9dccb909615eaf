"""Results in words, for people who read a terminal."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

from app.cli.output import table


def process_text(summary: Mapping[str, Any], out: Path) -> str:
    """Say what ``process`` found."""
    rows = [["trip", "km", "min", "litres", "l/100 km", "points", "nis", "verdict"]]
    for trip in summary["trips"]:
        kilometres, litres = trip["distance_m"] / 1000.0, trip["fuel_l"]
        rows.append(
            [
                trip["states"],
                f"{kilometres:.1f}",
                f"{trip['duration_s'] / 60:.1f}",
                f"{litres:.2f}",
                f"{100.0 * litres / kilometres:.1f}" if kilometres else "-",
                str(trip["operating_points"]),
                f"{trip['nis']:.2f}",
                trip["verdict"],
            ]
        )
    lines = [table(rows), *summary["reasons"], *(f"warning: {warning}" for warning in summary["warnings"])]
    return "\n".join([*lines, f"written to {out} in {summary['timing_s']['total']:.1f} s"])


def decode_text(report: Mapping[str, Any]) -> str:
    """Say what ``decode`` found; every damaged place with its byte offset stands in the JSON report."""
    packets = ", ".join(f"{count} {kind}" for kind, count in report["packets"].items() if count)
    lines = [
        f"{report['bytes']} bytes, {report['byte_order']}-endian: {report['packet_bytes']} in packets, "
        f"{report['zero_tail_bytes']} unwritten zeros at the end",
        f"packets: {packets or 'none'}",
        f"damage: {report['bad_checksums']} bad checksums, {report['bad_headers']} bad headers, "
        f"{report['resync_count']} resyncs over {report['skipped_bytes']} bytes, {report['gap_count']} gaps",
    ]
    trips = (
        f"trip {trip['number']}: bytes {trip['offset']} to {trip['end_offset']}, "
        f"{trip['end_s'] - trip['start_s']:.0f} s, {sum(trip['samples'].values())} samples"
        for trip in report["trips"]
    )
    return "\n".join([*lines, *trips, *(f"warning: {warning}" for warning in report["warnings"])])
