"""What a file is, by its first bytes."""

from __future__ import annotations

import gzip

import pytest

from app.imports.detect import detect_format, explain_unknown, holds_packets


def packet(kind: int, message: bytes) -> bytes:
    """App. C.1.4: FF, type, length of message and sum, message, sum modulo 256 from the length on."""
    counted = bytes([len(message) + 1]) + message
    return b"\xff" + bytes([kind]) + counted + bytes([sum(counted) % 256])


IMAGE = b"".join(packet(1, i.to_bytes(4, "little") + bytes([1, 0, 2, 0, 255, 3])) for i in range(40))


@pytest.mark.parametrize(
    ("head", "name", "expected"),
    [
        (IMAGE, "trip.dat", "logger"),
        (IMAGE, "no-name", "logger"),
        (b"\x13\x00\xff\x07 torn" + IMAGE, "trip.bin", "logger"),
        (packet(2, b"$GPGGA,120000.0,,,,,0,,,,,,,,*6A\r\n") + packet(3, bytes(5)), "x", "logger"),
        (bytes(1000), "trip.dat", "logger"),
        (b"t_s,speed_mps\n0,1\n", "a.csv", "signals"),
        (b"zeit;tempo\n0;1,5\n1;2,5\n", "a.csv", "signals"),
        (gzip.compress(b"t_s,signal,value\n0,speed_mps,1\n"), "a.csv.gz", "signals"),
        (b"PAR1\x15\x04", "a.parquet", "signals"),
        ("t_s,speed_mps\n0,1\n".encode("utf-16"), "a.csv", "signals"),
        (b"lat_deg,lon_deg,alt_m,way\n49,6,300,1\n", "elevation.csv", "elevation"),
        (b"t_s,lat_deg,lon_deg,alt_m\n0,49,6,300\n", "gnss.csv", "signals"),
        (b'<?xml version="1.0"?>\n<ponthy_config>', "car.xml", "car_xml"),
        (b"", "a.csv", "unknown"),
        (b"\xff\xd8\xff\xe0\x00\x10JFIF", "photo.dat", "unknown"),
        (b"Dear reader, this is prose, with commas.\nAnd more of it, and more.\n", "a.txt", "unknown"),
    ],
)
def test_the_first_bytes_tell(head: bytes, name: str, expected: str) -> None:
    assert detect_format(head, name) == expected


@pytest.mark.parametrize(
    ("head", "words"),
    [
        (b"\xff\xd8\xff\xe0\x00\x10JFIF", "This is a JPEG picture"),
        (b"\x89PNG\r\n\x1a\n", "This is a PNG picture"),
        (b"PK\x03\x04", "ZIP archive"),
        (b"MDF     4.11", "MDF measurement file; export it"),
        (b"%PDF-1.7", "a PDF document"),
        (b"", "The file is empty"),
        (bytes(100), "100 zero bytes"),
        (gzip.compress(b"%PDF-1.7"), "Unpacked, this is a PDF document"),
        (b"\x1f\x8b\x08\x00", "empty|damaged"),
        (b"<gpx><trk/></gpx>", "a GPX track"),
        (b"<car/>", "XML, but not of a car"),
        (b"# receiver\n$GPGGA,120000.0,,,\n", "NMEA sentences"),
        (b'{"a": 1}', "JSON text"),
        (b"\x01\x02\x03\x00", "binary data without a packet"),
        (b"Just words\n", "text without columns"),
    ],
)
def test_an_unknown_file_is_described(head: bytes, words: str) -> None:
    assert detect_format(head, "upload") == "unknown"
    with pytest.raises(AssertionError, match=words):
        raise AssertionError(explain_unknown(head, "upload"))


def test_a_wrong_sum_is_no_packet() -> None:
    torn = bytearray(IMAGE[:30])
    torn[10] ^= 1
    assert holds_packets(IMAGE)
    assert not holds_packets(bytes(torn[:14]))
    assert not holds_packets(b"\xff" * 5000)
