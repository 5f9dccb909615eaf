"""The decode stage: from an upload's bytes to the measurements of its trips, and a report of how that went."""

from __future__ import annotations

import json
from collections.abc import Iterator
from dataclasses import dataclass
from datetime import UTC, datetime
from typing import Any

from sqlalchemy.orm import Session

from app.errors import PonthyError
from app.exports.parquet import recording_parquet
from app.imports.detect import detect_format, explain_unknown
from app.imports.signals import SignalMapping, read_signals
from app.jobs import service as jobs
from app.science.errors import SignalsError
from app.science.logger.decode import ImageDecoder
from app.science.logger.recording import Recording
from app.storage.blobs import Blobs
from app.storage.keys import stage_key
from app.storage.resources import Resources
from app.trips import repository
from app.trips.keys import recording_file, report_file
from app.trips.models import Trip

HEAD_BYTES = 64 * 1024
MEGA = 1e6


@dataclass(frozen=True, slots=True)
class Segment:
    """One trip found in an upload, as the decode report lists it."""

    started_at_utc_s: float | None
    duration_s: float
    samples: int
    warnings: tuple[str, ...]


def decode(resources: Resources, fleet_id: str, trip_id: str, progress: jobs.Progress) -> jobs.Store:
    """Decode the upload of a trip, unless that was done before with this code.

    All trips of the upload are written, one at a time, so memory is bounded by the longest trip; two workers that do
    it at once write the same bytes under the same names. Trips without a row
    get one when the result is stored, with a job that goes on where this stage ends.

    Raises
    ------
    ScienceError
        When nothing in the upload is usable.
    PonthyError
        When the upload, decoded by today's code, no longer has this trip.
    """
    with resources.database.transaction(fleet_id, read_only=True) as session:
        trip = repository.trip(session, trip_id)
    if trip is None:
        raise jobs.JobCancelled
    key = stage_key("decode", input=trip.input_sha256, mapping=trip.mapping, code=resources.settings.code_version)
    if not resources.blobs.exists(report_file(trip, key)):
        _decode_all(resources.blobs, trip, key, progress)
    document = json.loads(resources.blobs.get(report_file(trip, key)))
    segments = [Segment(**segment | {"warnings": tuple(segment["warnings"])}) for segment in document["segments"]]
    if trip.segment >= len(segments):
        message = (
            f"Decoded again, the file has {len(segments)} trips and no longer trip {trip.segment + 1}: the decoder "
            "splits it otherwise by now. Delete this trip; what it held is in the others."
        )
        raise PonthyError("segment-gone", message, 409)
    return lambda session: _store(session, trip_id, key, segments)


def _decode_all(blobs: Blobs, trip: Trip, key: str, progress: jobs.Progress) -> None:
    source = _Source(blobs, trip, progress)
    segments: list[dict[str, Any]] = []
    for recording in source.recordings():
        blobs.put(recording_file(trip, key, len(segments)), recording_parquet(recording))
        segments.append(
            {
                "started_at_utc_s": recording.started_at_utc_s,
                "duration_s": recording.duration_s,
                "samples": recording.sample_count,
                "warnings": list(recording.warnings),
            }
        )
        source.found(len(segments))
    document = {"format": source.form, "bytes": trip.input_bytes, "segments": segments, "report": source.report}
    blobs.put(report_file(trip, key), json.dumps(document).encode())


class _Source:
    """The upload as a sequence of recordings, telling its progress on the way."""

    def __init__(self, blobs: Blobs, trip: Trip, progress: jobs.Progress) -> None:
        self._blobs = blobs
        self._trip = trip
        self._progress = progress
        self._read_bytes = 0
        self._trips = 0
        self._head = next(blobs.stream(trip.input_key, HEAD_BYTES), b"")
        self.form = detect_format(self._head, trip.filename)
        self.report: dict[str, Any] | None = None

    def recordings(self) -> Iterator[Recording]:
        """Give the trips one by one."""
        if self.form == "logger":
            decoder = ImageDecoder()
            yield from decoder.trips(self._chunks())
            self.report = decoder.report.to_dict()
        elif self.form == "signals":
            mapping = None if self._trip.mapping is None else SignalMapping.from_dict(self._trip.mapping)
            yield read_signals(b"".join(self._chunks()), filename=self._trip.filename, mapping=mapping)
        else:
            raise SignalsError(explain_unknown(self._head, self._trip.filename))

    def found(self, trips: int) -> None:
        """Note how many trips there are by now."""
        self._trips = trips
        self._tell()

    def _chunks(self) -> Iterator[bytes]:
        for piece in self._blobs.stream(self._trip.input_key):
            self._read_bytes += len(piece)
            self._tell()
            yield piece

    def _tell(self) -> None:
        share = self._read_bytes / max(self._trip.input_bytes, 1)
        trips = f", {self._trips} trip{'s' if self._trips > 1 else ''} found" if self._trips else ""
        self._progress(share, f"{self._read_bytes / MEGA:.1f} of {self._trip.input_bytes / MEGA:.1f} MB{trips}")


def _store(session: Session, trip_id: str, key: str, segments: list[Segment]) -> None:
    first = repository.trip(session, trip_id, lock=True)
    if first is None:
        return
    _describe(first, key, segments[first.segment])
    known = {trip.segment for trip in repository.of_upload(session, first.upload_id)}
    for number, segment in enumerate(segments):
        if number in known:
            continue
        trip = _further_trip(first, number)
        _describe(trip, key, segment)
        session.add(trip)
        session.flush()
        title = f"{trip.filename}, trip {number + 1}"
        jobs.create_trip_job(session, trip_id=trip.id, car_id=trip.car_id, title=title, done=("decode",))


def _further_trip(first: Trip, number: int) -> Trip:
    stem = first.name.removesuffix(f" ({first.segment + 1})")
    return Trip(
        car_id=first.car_id,
        upload_id=first.upload_id,
        segment=number,
        input_key=first.input_key,
        input_sha256=first.input_sha256,
        input_bytes=first.input_bytes,
        mapping=first.mapping,
        name=f"{stem[:190]} ({number + 1})",
        filename=first.filename,
        options=dict(first.options),
    )


def _describe(trip: Trip, key: str, segment: Segment) -> None:
    trip.decode_key = key
    trip.duration_s = segment.duration_s
    if segment.started_at_utc_s is not None:
        trip.started_at = datetime.fromtimestamp(segment.started_at_utc_s, UTC)
