"""Where measurements of a battery come from: a trip that recorded them, or a file that was sent."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from datetime import UTC, datetime, timedelta
from functools import partial

from sqlalchemy.orm import Session

from app.batteries import repository
from app.batteries.models import BatteryFile, Work
from app.science.battery.record import BatteryRecord
from app.storage.blobs import Blobs
from app.trips import service as trips


@dataclass(frozen=True, slots=True)
class Span:
    """When measurements began and ended; where that is not known, both are when they came."""

    began_at: datetime
    ended_at: datetime
    is_known: bool


@dataclass(frozen=True, slots=True)
class Source:
    """One trip or one file.

    Attributes
    ----------
    name : str
    trip_id, file_id : str or None
        One of them.
    key : str
        Names the measurements.
    zero_at : datetime
        When their time is zero, as far as is known without reading them.
    is_known : bool
        Whether somebody said so; else a clock among the measurements goes first.
    read : callable
        Gives the record; None for a trip whose car told nothing of its battery.
    """

    name: str
    trip_id: str | None
    file_id: str | None
    key: str
    zero_at: datetime
    is_known: bool
    read: Callable[[], BatteryRecord | None]

    @property
    def id(self) -> str:
        """Identifier of the trip or the file."""
        return self.trip_id or self.file_id or ""

    def span(self, record: BatteryRecord) -> Span:
        """Return when a record begins and ends; where nobody knows, it is a moment: when it came."""
        clock_s = record.started_at_utc_s
        if not self.is_known and clock_s is None:
            return Span(self.zero_at, self.zero_at, is_known=False)
        zero = self.zero_at if self.is_known or clock_s is None else datetime.fromtimestamp(clock_s, UTC)
        first, last = (zero + timedelta(seconds=float(t_s)) for t_s in (record.t_s[0], record.t_s[-1]))
        return Span(first, last, is_known=True)


def of_trip(blobs: Blobs, trip: trips.DecodedTrip) -> Source:
    """Return a trip as a source."""
    return Source(trip.name, trip.trip_id, None, trip.key, trip.began, trip.has_clock, partial(_recorded, blobs, trip))


def of_file(blobs: Blobs, file: BatteryFile) -> Source:
    """Return a file as a source; without a clock it counts from when it came."""
    zero_at = file.began_at or file.created_at
    return Source(file.name, None, file.id, file.sha256, zero_at, file.began_at is not None, partial(sent, blobs, file))


def of_battery(session: Session, blobs: Blobs, battery_id: str, car_id: str) -> list[Source]:
    """Return everything that may tell of a battery: the car's trips and the files that were sent."""
    files = repository.files_for(session, battery_id, Work.ESTIMATE)
    return [of_trip(blobs, trip) for trip in trips.decoded_trips(session, car_id)] + [
        of_file(blobs, file) for file in files
    ]


def sent(blobs: Blobs, file: BatteryFile) -> BatteryRecord:
    """Return the record in a file that was sent; raises `SignalsError`."""
    from app.imports.battery import read_battery  # for workers only, as it brings what the web server has no room for

    return read_battery(blobs.get(file.blob_key), file.name)


def _recorded(blobs: Blobs, trip: trips.DecodedTrip) -> BatteryRecord | None:
    from app.science.battery.streams import has_battery, record_of  # as above

    recording = trips.signals_of(blobs, trip, ("battery_current_a", "battery_voltage_v"))
    return record_of(recording) if has_battery(recording) else None
