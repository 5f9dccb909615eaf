"""Where trips begin and end, as a person would say it."""

from __future__ import annotations

import numpy as np
import pytest

from app.science.errors import DecodeError
from app.science.logger.decode import DecodedImage, ImageDecoder
from tests.science.logger import packet_writer as write

MINUTE = 60_000


def decode(packets: list[bytes], **options: float) -> DecodedImage:
    decoder = ImageDecoder(**options)  # type: ignore[arg-type]
    return DecodedImage(tuple(decoder.trips([b"".join(packets)])), decoder.report)


def parked(begin_ms: int, end_ms: int, step_ms: int = 100) -> list[bytes]:
    """The logger runs on: only the accelerometer speaks."""
    return [write.acc(ms) for ms in range(begin_ms, end_ms, step_ms)]


def idling(begin_ms: int, end_ms: int) -> list[bytes]:
    """The engine turns, the wheels don't."""
    return [packet for ms in range(begin_ms, end_ms, 100) for packet in (write.acc(ms), write.injector(ms + 1, 8_000))]


def spans(image: DecodedImage) -> list[tuple[float, float]]:
    """Begin and end of each trip, on the logger's clock."""
    return [(t.start_s + t.clock_origin_ms / 1e3, t.end_s + t.clock_origin_ms / 1e3) for t in image.report.trips]


def test_one_drive_is_one_trip_on_the_loggers_own_clock() -> None:
    image = decode(write.drive(20_000, 2 * MINUTE))
    (trip,) = image.report.trips
    assert trip.clock_origin_ms == 0
    assert image.recordings[0]["ax_mps2"].t_s[0] == 20.0
    assert trip.power_on == 1
    assert image.recordings[0].duration_s == pytest.approx(100.0, abs=0.1)


def test_a_restart_of_the_logger_parts_trips() -> None:
    image = decode(write.drive(0, MINUTE) + write.drive(30, MINUTE) + write.drive(5, MINUTE))
    assert image.report.clock.restarts == 2
    assert [t.power_on for t in image.report.trips] == [1, 2, 3]
    assert [t.clock_origin_ms for t in image.report.trips] == [0, 0, 0]
    assert [r["ax_mps2"].t_s[0] for r in image.recordings] == [0.0, 0.03, 0.005]
    offsets = [(t.offset, t.end_offset) for t in image.report.trips]
    assert offsets == sorted(offsets)


def test_a_long_idle_at_a_barrier_is_the_same_trip() -> None:
    image = decode(write.drive(0, MINUTE) + idling(MINUTE, 13 * MINUTE) + write.drive(13 * MINUTE, 14 * MINUTE))
    assert len(image.recordings) == 1


def test_a_short_stop_of_the_engine_is_the_same_trip() -> None:
    image = decode(write.drive(0, MINUTE) + parked(MINUTE, 5 * MINUTE) + write.drive(5 * MINUTE, 6 * MINUTE))
    assert len(image.recordings) == 1
    assert image.report.left_out == ()


def test_a_logger_that_runs_on_while_parked_parts_trips_and_keeps_a_minute_around_them() -> None:
    night = parked(MINUTE, 61 * MINUTE)
    image = decode(
        write.drive(0, MINUTE) + night + write.drive(61 * MINUTE, 62 * MINUTE) + parked(62 * MINUTE, 90 * MINUTE)
    )
    (first_begin, first_end), (second_begin, second_end) = spans(image)
    assert first_begin == 0.0
    assert first_end == pytest.approx(120.0, abs=0.2)
    assert second_begin == pytest.approx(60 * 60.0, abs=0.2)
    assert second_end == pytest.approx(63 * 60.0, abs=0.2)
    assert image.recordings[1]["ax_mps2"].t_s[0] == 0.0  # the second trip of a power-on begins at zero
    assert [(round(x.from_s), round(x.to_s)) for x in image.report.left_out] == [(120, 3600), (3780, 5400)]
    assert "2 stretches in which the car was off" in image.report.warnings[-1]


def test_how_long_off_is_off_can_be_set() -> None:
    packets = write.drive(0, MINUTE) + parked(MINUTE, 4 * MINUTE) + write.drive(4 * MINUTE, 5 * MINUTE)
    assert len(decode(packets).recordings) == 1
    image = decode(packets, off_after_s=120.0, margin_s=10.0)
    assert [round(end) for _, end in spans(image)] == [70, 300]
    assert len(decode(packets, off_after_s=600.0).recordings) == 1


def test_a_gap_longer_than_off_parts_trips() -> None:
    """The logger slept with its clock running on."""
    image = decode(write.drive(0, MINUTE) + write.drive(31 * MINUTE, 32 * MINUTE))
    assert len(image.recordings) == 2
    assert image.report.gap_count == 1


def test_a_gap_shorter_than_off_stays_inside_the_trip_and_is_said() -> None:
    image = decode(write.drive(0, MINUTE) + write.drive(3 * MINUTE, 4 * MINUTE))
    (recording,) = image.recordings
    (gap,) = image.report.gaps
    assert (round(gap.from_s), round(gap.to_s)) == (60, 180)
    assert recording.warnings == ("The logger was silent 1 time, for 120.0 s at most.",)


def test_a_power_on_without_a_drive_is_left_out_and_said() -> None:
    image = decode(parked(0, 3 * MINUTE) + write.drive(10, MINUTE) + parked(0, MINUTE))
    assert len(image.recordings) == 1
    assert image.report.trips[0].power_on == 2
    assert [(x.from_s, round(x.to_s)) for x in image.report.left_out] == [(0.0, 180), (0.0, 60)]


def test_waiting_before_the_drive_is_cut_to_a_minute_when_it_is_long() -> None:
    image = decode(parked(0, 20 * MINUTE) + write.drive(20 * MINUTE, 21 * MINUTE))
    (trip,) = image.report.trips
    assert trip.start_s == pytest.approx(19 * 60.0, abs=0.2)
    assert trip.clock_origin_ms == 0  # still the first trip of the power-on, within the first hour


def test_a_short_wait_before_the_drive_belongs_to_it() -> None:
    image = decode(parked(0, 4 * MINUTE) + write.drive(4 * MINUTE, 5 * MINUTE))
    assert image.report.trips[0].start_s == 0.0
    assert image.report.left_out == ()


def test_a_second_trip_within_the_first_hour_begins_at_zero() -> None:
    image = decode(write.drive(0, MINUTE) + parked(MINUTE, 20 * MINUTE) + write.drive(20 * MINUTE, 21 * MINUTE))
    assert [t.start_s for t in image.report.trips] == [0.0, 0.0]
    assert [t.clock_origin_ms for t in image.report.trips] == [0, 19 * MINUTE + 100]


def test_a_sentence_cut_off_by_the_power_is_not_completed_by_the_next_power_on() -> None:
    text = write.gga(43_200.0, 7.0, 31.0)
    first, second = write.drive(0, MINUTE), write.drive(40, MINUTE)
    whole = decode(first + second).report.nmea
    torn = decode([*first, write.gps(text[:30]), *second[:3], write.gps(text[30:]), *second[3:]]).report.nmea
    assert torn == whole


def test_a_first_trip_late_on_the_clock_begins_at_zero() -> None:
    image = decode(write.drive(2 * 60 * MINUTE, 121 * MINUTE))
    (trip,) = image.report.trips
    assert trip.clock_origin_ms == 2 * 60 * MINUTE
    assert trip.start_s == 0.0


def test_without_ticks_and_pulses_a_moving_gps_makes_a_trip() -> None:
    packets = [p for p in write.drive(0, 2 * MINUTE) if p[1] in (1, 2)]
    image = decode(packets)
    assert set(image.recordings[0]) >= {"lat_deg", "ax_mps2"}
    still = [p for p in packets if p[1] == 1] + [write.gps(write.rmc(43_200.0, 7.0, 31.0, knots=0.3))]
    with pytest.raises(DecodeError, match="no drive in this image"):
        decode(still)


def test_an_endless_drive_is_cut_and_goes_on() -> None:
    packets = write.drive(0, 60 * MINUTE)
    image = decode(packets, longest_trip_bytes=6 << 20)
    assert len(image.recordings) == 3
    assert image.recordings[0].warnings == (
        "The drive goes on in the next trip: it was too long to be held in one piece.",
    )
    ticks = np.concatenate(
        [r["vss_tick"].t_s + t.clock_origin_ms / 1e3 for r, t in zip(image.recordings, image.report.trips, strict=True)]
    )
    (whole,) = decode(packets).recordings
    np.testing.assert_allclose(ticks, whole["vss_tick"].t_s, atol=1e-9)
