"""``./ponthy decode``: what a logger image holds, and what is damaged in it."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from app.cli.inputs import chunks
from app.cli.options import AsJson, ExistingFile
from app.cli.output import note, say, write_json


def decode(
    image: ExistingFile,
    out: Annotated[
        Path | None, typer.Option(file_okay=False, help="Also write report.json and trip-N.parquet.")
    ] = None,
    as_json: AsJson = False,
) -> None:
    """Say what a logger image holds.

    Packets by type, bytes, bad checksums, gaps and resyncs with their byte offsets. With --out, each trip's
    measurements become a signals table that `process` reads.
    """
    from app.cli.reports import decode_text
    from app.exports.parquet import recording_parquet
    from app.science.logger.decode import ImageDecoder

    decoder = ImageDecoder()
    if out is not None:
        out.mkdir(parents=True, exist_ok=True)
    for number, recording in enumerate(decoder.trips(chunks(image)), start=1):
        note(f"trip {number}: {recording.duration_s:.0f} s, {recording.sample_count} samples")
        if out is not None:
            (out / f"trip-{number}.parquet").write_bytes(recording_parquet(recording))
    report = decoder.report.to_dict()
    if out is not None:
        write_json(out / "report.json", report)
    say(report, as_json, decode_text(report))
