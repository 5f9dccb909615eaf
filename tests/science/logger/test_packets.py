"""Finding packets, whole and damaged, against a slow reference and against what was written."""

from __future__ import annotations

import itertools

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from app.science.logger.packets import PacketScanner, Scan
from tests.science.logger import packet_writer as write
from tests.science.logger import references

MESSAGES = st.one_of(
    st.binary(min_size=10, max_size=10).map(lambda m: (1, m)),
    st.binary(min_size=5, max_size=5).map(lambda m: (3, m)),
    st.binary(min_size=6, max_size=6).map(lambda m: (4, m)),
    st.binary(min_size=5, max_size=5).map(lambda m: (5, m)),
    st.binary(min_size=1, max_size=254).map(lambda m: (2, m)),
    st.text(alphabet=[chr(c) for c in range(32, 127)], min_size=1, max_size=80).map(lambda m: (0, m.encode())),
)
"""Any message of any type, so start bytes and whole packets may stand inside them."""


def scan_pieces(image: bytes, cuts: list[int]) -> list[Scan]:
    scanner = PacketScanner()
    edges = [0, *sorted(min(cut, len(image)) for cut in cuts), len(image)]
    scans = [scanner.scan(image[a:b]) for a, b in itertools.pairwise(edges)]
    return [*scans, scanner.scan(b"", final=True)]


def stamped(scans: list[Scan]) -> list[tuple[int, int, bytes]]:
    """Stamped packets as (offset, type, message), their messages put together again."""
    found = []
    for scan in scans:
        p = scan.packets
        for kind, raw, words, offset in zip(p.kind, p.raw_ms, p.words, p.offset, strict=True):
            size = {1: 10, 3: 5, 4: 6, 5: 5}[int(kind)]
            found.append((int(offset), int(kind), (raw.tobytes() + words.tobytes())[:size]))
    return found


def texts(scans: list[Scan]) -> list[bytes]:
    return [
        scan.packets.text[a:b].tobytes()
        for scan in scans
        for a, b in zip([0, *scan.packets.text_end[:-1]], scan.packets.text_end, strict=False)
    ]


def agrees_with_reference(image: bytes, cuts: list[int]) -> None:
    scans, slow = scan_pieces(image, cuts), references.scan(image)
    assert stamped(scans) == [p for p in slow.packets if p[1] not in (0, 2)]
    assert texts(scans) == [message for _, kind, message in slow.packets if kind == 2]
    assert [e for s in scans for e in s.errors] == [m.decode().strip() for _, k, m in slow.packets if k == 0]
    resyncs = [(int(a), int(b)) for s in scans for a, b in s.resyncs]
    assert resyncs == slow.resyncs[: len(resyncs)]  # the reference also lists what stands behind the last packet
    assert len(slow.resyncs) - len(resyncs) <= 1


@given(st.lists(MESSAGES, max_size=30), st.lists(st.integers(0, 4000), max_size=5))
def test_what_was_written_is_read_wherever_it_is_cut(messages: list[tuple[int, bytes]], cuts: list[int]) -> None:
    image = b"".join(write.packet(kind, message) for kind, message in messages)
    scans = scan_pieces(image, cuts)
    assert [message for _, _, message in stamped(scans)] == [m for kind, m in messages if kind in (1, 3, 4, 5)]
    assert texts(scans) == [m for kind, m in messages if kind == 2]
    assert sum(int(s.counts[:6].sum()) for s in scans) == len(messages)
    assert sum(len(s.resyncs) for s in scans) == 0


@given(
    st.lists(MESSAGES, max_size=20),
    st.lists(st.tuples(st.integers(0, 4000), st.integers(0, 20), st.binary(max_size=20)), max_size=6),
    st.lists(st.integers(0, 4000), max_size=5),
)
def test_damaged_images_are_read_as_the_reference_reads_them(
    messages: list[tuple[int, bytes]], damage: list[tuple[int, int, bytes]], cuts: list[int]
) -> None:
    image = b"".join(write.packet(kind, message) for kind, message in messages)
    for at, removed, inserted in damage:
        image = image[:at] + inserted + image[at + removed :]
    agrees_with_reference(image, cuts)


@given(st.binary(max_size=3000), st.lists(st.integers(0, 3000), max_size=3))
def test_any_bytes_are_read_as_the_reference_reads_them(image: bytes, cuts: list[int]) -> None:
    agrees_with_reference(image, cuts)


@given(st.lists(st.sampled_from([0xFF, 0, 1, 2, 3, 4, 5, 6, 7, 11]), max_size=2000).map(bytes))
def test_bytes_made_of_headers_are_read_as_the_reference_reads_them(image: bytes) -> None:
    agrees_with_reference(image, [700])


def test_zeros_between_packets_are_not_damage() -> None:
    scans = scan_pieces(write.vss(5) + bytes(100_000) + write.vss(20), [])
    assert [offset for offset, _, _ in stamped(scans)] == [0, 100_009]
    assert sum(len(s.resyncs) for s in scans) == 0


def test_damage_before_zeros_is_measured_without_them() -> None:
    half = write.acc(10)[:6]
    scans = scan_pieces(write.vss(5) + half + bytes(5000) + write.vss(20), [])
    assert [(int(a), int(b)) for s in scans for a, b in s.resyncs] == [(9, 4)]  # the time stamp 10, 0 ends in a zero


@pytest.mark.parametrize("kind", [6, 7, 0x80, 0xFE, 0xFF])
def test_unknown_types_are_passed_over(kind: int) -> None:
    image = write.vss(5) + write.packet(kind, b"12345") + write.vss(20)
    scans = scan_pieces(image, [])
    assert len(stamped(scans)) == 2
    assert sum(int(s.counts[7]) for s in scans) == 1


def test_a_flipped_type_bit_does_not_make_readings_into_an_error_message() -> None:
    image = bytearray(write.acc(70_000) + write.vss(70_003))
    image[1] = 0
    scans = scan_pieces(bytes(image), [])
    assert [kind for _, kind, _ in stamped(scans)] == [3]
    assert [e for s in scans for e in s.errors] == []


def test_an_accidental_sum_gives_way_to_the_packet_it_would_swallow() -> None:
    """Four bytes of an accelerometer packet are lost, and what follows happens to complete its sum."""
    good = write.vss(1000, 7) + write.vss(1015)
    accident = next(
        bytes([0xFF, 1, 11]) + bytes([x, 0, 0, 0, y, 0])
        for x in range(256)
        for y in range(256)
        if (11 + x + y + sum(good[:4])) % 256 == good[4]
    )
    scans = scan_pieces(write.vss(985) + accident + good, [])
    assert [message for _, _, message in stamped(scans)] == [
        write.vss(985)[3:-1],
        write.vss(1000, 7)[3:-1],
        write.vss(1015)[3:-1],
    ]


@pytest.mark.parametrize("seed", range(8))
def test_damage_costs_only_the_packets_it_touches(seed: int) -> None:
    """Every packet no flip, hole or insertion touched is found, and no more than a few are invented."""
    rng = np.random.default_rng(seed)
    packets = write.drive(0, 60_000)
    places = np.sort(rng.choice(len(packets), 40, replace=False))
    pieces, untouched = list(packets), set(range(len(packets))) - set(places.tolist())
    for i in places.tolist():
        data = bytearray(pieces[i])
        at = int(rng.integers(len(data)))
        how = rng.integers(4)
        if how == 0:
            data[at] ^= 1 << int(rng.integers(8))
        elif how == 1:
            del data[at : at + int(rng.integers(1, 30))]
        elif how == 2:
            data[at:at] = rng.integers(0, 256, int(rng.integers(1, 40)), dtype=np.uint8).tobytes()
        else:
            data = data[:at]
        pieces[i] = bytes(data)
    scans = scan_pieces(b"".join(pieces), rng.integers(0, 100_000, 3).tolist())
    starts = np.cumsum([0, *map(len, pieces)])
    expected = [(int(starts[i]), packets[i][1], packets[i][3:-1]) for i in sorted(untouched) if packets[i][1] != 2]
    found = stamped(scans)
    assert set(expected) <= set(found)
    assert len(found) - len(expected) <= 40
    expected_texts = [packets[i][3:-1] for i in sorted(untouched) if packets[i][1] == 2]
    assert len(texts(scans)) >= len(expected_texts)
    assert sum(len(s.resyncs) for s in scans) <= 40
