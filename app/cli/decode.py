"""``./ponthy decode``: what a logger image holds, and what is damaged in it."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from app.cli.inputs import chunks
from app.cli.options import AsJson, ExistingFile
from app.cli.output import note, say, write_json

if TYPE_CHECKING:
    from app.science.logger.report import DecodeReport


def decode(
    image: ExistingFile,
    out: Annotated[
        Path | None, typer.Option(file_okay=False, help="Also write report.json and trip-N.parquet.")
    ] = None,
    as_json: AsJson = False,
) -> None:
    """Say what a logger image holds.

    Packets by type, bytes, bad checksums, gaps and resyncs with their byte offsets. With --out, each trip's
    measurements become a signals table that `process` reads. An image without a drive is reported on all the same.
    """
    from app.exports.parquet import recording_parquet
    from app.science.errors import DecodeError
    from app.science.logger.decode import ImageDecoder

    decoder = ImageDecoder()
    if out is not None:
        out.mkdir(parents=True, exist_ok=True)
    try:
        for number, recording in enumerate(decoder.trips(chunks(image)), start=1):
            note(f"trip {number}: {recording.duration_s:.0f} s, {recording.sample_count} samples")
            if out is not None:
                (out / f"trip-{number}.parquet").write_bytes(recording_parquet(recording))
    except DecodeError:
        say_report(decoder.report, out, as_json)
        raise
    say_report(decoder.report, out, as_json)


def say_report(found: DecodeReport, out: Path | None, as_json: bool) -> None:
    """Print a decode report, and write it where that was asked for."""
    from app.cli.reports import decode_text

    report = found.to_dict()
    if out is not None:
        write_json(out / "report.json", report)
    say(report, as_json, decode_text(report))
