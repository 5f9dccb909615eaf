"""The logger's clock against a slow reference, and case by case."""

from __future__ import annotations

import itertools

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from app.science.logger.clock import LoggerClock, is_big_endian
from app.science.logger.packets import PacketScanner
from app.science.logger.stretch import Stretch
from tests.science.logger import packet_writer as write
from tests.science.logger import references

CARD_FULL_MS = 2**32


def timed(image: bytes, cuts: list[int] | None = None) -> tuple[list[Stretch], LoggerClock]:
    scanner, clock = PacketScanner(), LoggerClock()
    edges = [0, *sorted(min(cut, len(image)) for cut in cuts or []), len(image)]
    stretches = [s for a, b in itertools.pairwise(edges) for s in clock.time(scanner.scan(image[a:b]).packets)]
    stretches += clock.time(scanner.scan(b"", final=True).packets, final=True)
    return stretches, clock


def ticks_at(stamps: list[int]) -> bytes:
    return b"".join(write.vss(stamp) for stamp in stamps)


def times_of(stamps: list[int]) -> list[tuple[int, int]]:
    stretches, _ = timed(ticks_at(stamps))
    return [(s.run, int(t)) for s in stretches for t in s.timed.t_ms]


STEPS = st.one_of(
    st.integers(0, 40),
    st.integers(-300, 300),
    st.integers(-20_000, 20_000),
    st.integers(-(2**33), 2**33),
    st.sampled_from([3_600_000, 3_600_001, -10_000, -10_001, 60_000, 60_001, 250, 251, -250, -251]),
)


@given(
    st.sampled_from([0, 40, 4_999, 5_000, 700_000, 2**31 - 5, 2**32 - 100]),
    st.lists(STEPS, max_size=60),
    st.lists(st.integers(0, 600), max_size=4),
)
def test_any_time_stamps_are_followed_as_the_reference_follows_them(
    begin: int, steps: list[int], cuts: list[int]
) -> None:
    stamps = [stamp % CARD_FULL_MS for stamp in itertools.accumulate(steps, initial=begin)]
    padding = list(range(stamps[-1] % 1000, stamps[-1] % 1000 + 1280, 10))  # enough to tell the byte order
    slow = references.follow_clock(stamps + padding)
    stretches, clock = timed(ticks_at(stamps + padding), cuts)
    if clock.big_endian:
        return
    assert [(s.run, int(t)) for s in stretches for t in s.timed.t_ms] == [t for t in slow.times if t is not None]
    counts = clock.counts
    assert (counts.restarts, counts.wraps, counts.backward_steps) == (slow.restarts, slow.wraps, slow.backward)
    assert counts.jumps_rejected == slow.times.count(None)


@given(st.integers(0, 2**32 - 1), st.lists(st.integers(1, 200), min_size=4, max_size=80))
def test_byte_order_is_told_from_the_time_stamps(begin: int, steps: list[int]) -> None:
    stamps = np.array([s % CARD_FULL_MS for s in itertools.accumulate(steps, initial=begin)], np.uint32)
    assert is_big_endian(stamps) is False
    assert is_big_endian(stamps.byteswap()) is True


def test_nothing_tells_the_byte_order_of_one_packet() -> None:
    assert is_big_endian(np.array([77], np.uint32)) is None


def test_a_far_stamp_that_its_followers_contradict_is_left_out() -> None:
    good = list(range(0, 3000, 25))
    assert times_of([*good[:50], 86_400_000, *good[50:]]) == [(0, t) for t in good]


def test_a_corrupted_burst_is_left_out() -> None:
    good = list(range(0, 3000, 25))
    bad = [4_000_000_000, 123_456_789, 123_456_790, 123_456_791, 0, 7, 1_000_000]
    _, clock = timed(ticks_at([*good[:50], *bad, *good[50:]]))
    assert clock.counts.jumps_rejected == 7
    assert times_of([*good[:50], *bad, *good[50:]]) == [(0, t) for t in good]


def test_a_corrupted_first_stamp_does_not_take_the_clock_with_it() -> None:
    good = list(range(1000, 3000, 25))
    assert times_of([3_000_000_000, *good]) == [(0, t) for t in good]


def test_a_jump_its_followers_share_is_a_gap() -> None:
    stamps = [*range(0, 2000, 25), *range(122_000, 124_000, 25)]
    stretches, clock = timed(ticks_at(stamps))
    assert [int(t) for s in stretches for t in s.timed.t_ms] == stamps
    (gap,) = clock.gaps
    assert (gap.offset, gap.from_s, gap.to_s) == (80 * 9, 1.975, 122.0)


def test_the_clock_runs_over_after_49_days() -> None:
    stamps = range(CARD_FULL_MS - 1000, CARD_FULL_MS + 1000, 25)
    stretches, clock = timed(ticks_at(list(stamps)))
    assert [int(t) for s in stretches for t in s.timed.t_ms] == list(stamps)
    assert clock.counts.wraps == 1
    assert clock.counts.restarts == 0


@pytest.mark.parametrize("last_ms", [8_000, 3_000_000, 3_000_000_000])
def test_a_clock_that_begins_anew_is_a_restart(last_ms: int) -> None:
    stamps = [*range(last_ms - 2000, last_ms, 25), *range(12, 2000, 25)]
    stretches, clock = timed(ticks_at(stamps))
    assert clock.counts.restarts == 1
    assert sorted({s.run for s in stretches}) == [0, 1]
    assert next(s for s in stretches if s.run == 1).first_ms == 12


def test_a_clock_set_back_a_little_goes_on() -> None:
    stamps = [*range(60_000, 62_000, 25), *range(59_000, 61_000, 25)]
    stretches, clock = timed(ticks_at(stamps))
    t_ms = np.concatenate([s.timed.t_ms for s in stretches])
    assert clock.counts.backward_steps == 1
    assert {s.run for s in stretches} == {0}
    assert np.all(np.diff(t_ms) >= 0)
    assert t_ms[-1] - t_ms[0] == 1975 + 1975


def test_sources_a_little_out_of_turn_keep_their_times() -> None:
    image = write.acc(1000) + write.injector(996) + write.acc(1025) + write.vss(1024) + write.acc(1050)
    (stretch,), clock = timed(image)
    assert stretch.timed.t_ms.tolist() == [1000, 996, 1025, 1024, 1050]
    assert clock.counts.jumps_rejected == 0


def test_text_stands_between_the_packets_around_it() -> None:
    image = write.gps(b"a") + write.vss(1000) + write.gps(b"b") + write.gps(b"c") + write.vss(1040) + write.gps(b"d")
    (stretch,), _ = timed(image)
    assert stretch.text.text.tobytes() == b"abcd"
    assert stretch.text.end.tolist() == [1, 2, 3, 4]
    assert stretch.text.before_ms.tolist() == [1000, 1000, 1000, 1040]
    assert stretch.text.after_ms.tolist() == [1000, 1040, 1040, 1040]


def test_a_pulse_is_written_when_it_ends() -> None:
    (stretch,), _ = timed(write.vss(1000) + write.gps(b"a") + write.injector(1001, 40_000) + write.vss(1020))
    assert stretch.text.after_ms.tolist() == [1012]


def test_text_at_a_restart_is_not_stretched_over_it() -> None:
    before = [write.vss(ms) for ms in range(50_000, 51_000, 25)]
    after = [write.vss(ms) for ms in range(10, 1000, 25)]
    stretches, _ = timed(b"".join([*before, write.gps(b"x"), *after]))
    assert [(s.run, s.text.before_ms.tolist(), s.text.after_ms.tolist()) for s in stretches] == [
        (0, [50_975], [50_975]),
        (1, [], []),
    ]


def test_endless_text_without_a_clock_is_not_hoarded() -> None:
    scanner, clock = PacketScanner(), LoggerClock()
    block = write.gps(b"x" * 250) * 2000
    for _ in range(20):
        assert list(clock.time(scanner.scan(block).packets)) == []
    assert clock.untimed_text_bytes > 15 * 2000 * 250


@given(st.lists(st.integers(1500, 5600), max_size=6))
def test_text_has_the_same_times_wherever_the_image_is_cut(cuts: list[int]) -> None:
    image = b"".join(write.vss(1000 + 20 * i) + write.gps(bytes([65 + i % 26])) for i in range(400))
    stretches, _ = timed(image, cuts)
    assert b"".join(s.text.text.tobytes() for s in stretches) == bytes(65 + i % 26 for i in range(400))
    before_ms = np.concatenate([s.text.before_ms for s in stretches])
    after_ms = np.concatenate([s.text.after_ms for s in stretches])
    assert before_ms.tolist() == list(range(1000, 9000, 20))
    assert after_ms.tolist() == [*range(1020, 9000, 20), 8980]
