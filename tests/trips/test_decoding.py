"""The decode stage: every trip of an upload becomes a trip, once."""

from __future__ import annotations

from dataclasses import replace

import pytest

from app.accounts.models import DEFAULT_FLEET_ID as FLEET
from app.errors import PonthyError
from app.exports.parquet import recording_parquet
from app.imports.signals import read_signals
from app.jobs import service as jobs
from app.science.errors import ScienceError
from app.science.logger.decode import ImageDecoder
from app.science.virtualcar.simulate import join_images, simulate
from app.science.virtualcar.specification import ImageSettings, Simulation
from app.trips import repository
from app.trips.decoding import decode
from app.trips.keys import recording_file
from app.trips.stored import report_of
from tests.yards import Yard, silent

SHORT = Simulation(duration_s=75.0, route="town", image=ImageSettings(zero_padding_bytes=0))
CARD = join_images([simulate(replace(SHORT, seed=seed)) for seed in (21, 22, 23)])


def decoded(yard: Yard, trip_id: str) -> None:
    yard.write(decode(yard.resources, FLEET, trip_id, silent))


def trips_of(yard: Yard, trip_id: str) -> list[str]:
    with yard.resources.database.transaction(FLEET, read_only=True) as session:
        return [trip.id for trip in repository.of_upload(session, yard.trip(trip_id).upload_id)]


def test_each_trip_on_a_card_becomes_a_trip_with_a_job_that_goes_on(yard: Yard) -> None:
    first = yard.new_trip("card", CARD, "card.dat")
    decoded(yard, first)
    trips = trips_of(yard, first)
    assert [yard.trip(trip).name for trip in trips] == ["card", "card (2)", "card (3)"]
    expected = list(ImageDecoder().trips([CARD]))
    for number, (trip_id, recording) in enumerate(zip(trips, expected, strict=True)):
        trip = yard.trip(trip_id)
        assert (trip.segment, trip.duration_s) == (number, recording.duration_s)
        assert trip.started_at is not None
        assert trip.started_at.timestamp() == pytest.approx(recording.started_at_utc_s, abs=1e-5)
        stored = yard.resources.blobs.get(recording_file(trip, str(trip.decode_key), number))
        assert stored == recording_parquet(recording)
        assert set(read_signals(stored, filename="x.parquet")) == set(recording)
    with yard.resources.database.transaction(FLEET, read_only=True) as session:
        newest = jobs.newest_of_trips(session, trips)
    assert {job.current_stage for job in newest.values()} == {"observe"}
    assert set(newest) == set(trips[1:])  # the first one's job is whoever called


def test_doing_it_again_makes_nothing_new(yard: Yard) -> None:
    first = yard.new_trip("card", CARD, "card.dat")
    decoded(yard, first)
    before = trips_of(yard, first)
    yard.resources.blobs.delete(yard.trip(first).input_key)  # what is decoded already isn't read again
    for trip_id in before:
        decoded(yard, trip_id)
    assert trips_of(yard, first) == before


def test_the_report_tells_what_was_found(yard: Yard) -> None:
    trip_id = yard.new_trip("card", CARD, "card.dat")
    with pytest.raises(PonthyError, match="not been decoded"):
        report_of(yard.resources.blobs, yard.trip(trip_id))
    decoded(yard, trip_id)
    report = report_of(yard.resources.blobs, yard.trip(trip_id))
    assert (report["format"], report["bytes"], len(report["segments"])) == ("logger", len(CARD), 3)
    assert report["report"]


def test_a_table_of_signals_is_one_trip(yard: Yard) -> None:
    rows = "\n".join(f"{t},{20 + t / 10},{2000 + t}" for t in range(100))
    trip_id = yard.new_trip("table", f"t_s,speed_mps,engine_speed_rpm\n{rows}\n".encode(), "drive.csv")
    decoded(yard, trip_id)
    assert yard.trip(trip_id).duration_s == 99.0
    assert report_of(yard.resources.blobs, yard.trip(trip_id))["format"] == "signals"


@pytest.mark.parametrize(
    ("filename", "data"), [("picture.png", b"\x89PNG\r\n\x1a\n" + bytes(5000)), ("zeros.dat", bytes(100_000))]
)
def test_what_holds_no_trip_is_refused_with_a_reason(yard: Yard, filename: str, data: bytes) -> None:
    trip_id = yard.new_trip("bad", data, filename)
    with pytest.raises(ScienceError) as refused:
        decode(yard.resources, FLEET, trip_id, silent)
    assert len(str(refused.value)) > 20
    assert trips_of(yard, trip_id) == [trip_id]


def test_a_segment_that_todays_decoder_no_longer_finds_is_named(yard: Yard) -> None:
    trip_id = yard.new_trip("card", CARD, "card.dat")
    yard.write(lambda session: setattr(repository.trip(session, trip_id), "segment", 3))
    with pytest.raises(PonthyError, match="no longer trip 4"):
        decode(yard.resources, FLEET, trip_id, silent)


def test_progress_tells_bytes_and_trips(yard: Yard) -> None:
    told: list[tuple[float, str | None]] = []
    decode(yard.resources, FLEET, yard.new_trip("card", CARD, "card.dat"), lambda f, d=None: told.append((f, d)))
    assert [fraction for fraction, _ in told] == sorted(fraction for fraction, _ in told)
    assert told[-1][0] == 1.0
    assert "3 trips found" in str(told[-1][1])


def test_a_stop_between_pieces_leaves_nothing_half_done(yard: Yard) -> None:
    def stop(fraction: float, detail: str | None = None) -> None:
        raise jobs.JobCancelled

    trip_id = yard.new_trip("card", CARD, "card.dat")
    with pytest.raises(jobs.JobCancelled):
        decode(yard.resources, FLEET, trip_id, stop)
    assert yard.trip(trip_id).decode_key is None
    decoded(yard, trip_id)
    assert len(trips_of(yard, trip_id)) == 3
