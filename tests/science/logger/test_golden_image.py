"""A small image, byte by byte as Sebesta 2010, App. C.1.4–C.1.5 describes it."""

from __future__ import annotations

import numpy as np
import pytest

from app.science.logger.decode import decode_image

IMAGE = bytes.fromhex(
    # start, type 1 (accelerometer), length 11 = 10 message bytes and the sum
    "FF 01 0B"
    " E8 03 00 00"  # 1000 ms, least significant byte first
    " 64 00"  # x:   100 milli-g
    " FF FF"  # y:    -1 milli-g: start bytes inside a message
    " 18 FC"  # z: -1000 milli-g
    " 6C"  # 0B+E8+03+00+00+64+00+FF+FF+18+FC = 46C
    # type 3 (Vss), length 6: 1002 ms and 5 × 125 µs
    " FF 03 06 EA 03 00 00 05 F8"
    # type 4 (injector), length 7: 1005 ms, 10000 × 250 ns = 2.5 ms
    " FF 04 07 ED 03 00 00 10 27 2E"
    # type 2 (GPS), length 13: text cut anywhere
    " FF 02 0D 24 47 50 47 47 41 2C 31 32 33 35 31 BF"  # "$GPGGA,12351" and its sum
    # type 5 (skew), length 6: at 1010 ms the logger was 3 ms late
    " FF 05 06 F2 03 00 00 03 FE"
    # type 0 (error), length 9: "SD busy" and a newline
    " FF 00 09 53 44 20 62 75 73 79 0A 8D"
    # type 3: 1016 ms and 4 × 125 µs
    " FF 03 06 F8 03 00 00 04 05"
    # type 1 at 1025 ms: 0, 0, -1001 milli-g
    " FF 01 0B 01 04 00 00 00 00 00 00 17 FC 23" + " 00" * 20
    # the card's unwritten rest
)


def test_every_byte_is_accounted_for() -> None:
    report = decode_image(IMAGE).report
    assert report.packets == {"error": 1, "accelerometer": 2, "gps": 1, "vss": 2, "injector": 1, "skew": 1}
    assert report.bytes == len(IMAGE)
    assert report.packet_bytes == len(IMAGE) - 20
    assert report.zero_tail_bytes == 20
    assert report.byte_order == "little"
    assert report.resyncs == ()
    assert report.bad_checksums == 0
    assert report.error_messages == ("SD busy",)
    assert (report.skew.count, report.skew.total_ms, report.skew.listed[0].t_s) == (1, 3, 1.010)


def test_counts_become_si_units_on_the_loggers_clock() -> None:
    (recording,) = decode_image(IMAGE).recordings
    np.testing.assert_allclose(recording["ax_mps2"].t_s, [1.000, 1.025])
    np.testing.assert_allclose(recording["ax_mps2"].value, [0.980665, 0.0])
    np.testing.assert_allclose(recording["ay_mps2"].value, [-0.00980665, 0.0])
    np.testing.assert_allclose(recording["az_mps2"].value, [-9.80665, -9.81645665])
    np.testing.assert_allclose(recording["vss_tick"].t_s, [1.002625, 1.0165])
    np.testing.assert_array_equal(recording["vss_tick"].value, [1.0, 1.0])
    np.testing.assert_allclose(recording["injector_pulse_s"].t_s, [1.005])
    np.testing.assert_allclose(recording["injector_pulse_s"].value, [0.0025])
    assert recording.texts == {"nmea": "$GPGGA,12351"}
    assert recording.warnings == ()


def test_damaged_first_checksum_costs_that_packet_only() -> None:
    damaged = bytearray(IMAGE)
    damaged[13] ^= 0x01
    decoded = decode_image(bytes(damaged))
    assert decoded.report.packets["accelerometer"] == 1
    assert decoded.report.packets["vss"] == 2
    assert decoded.report.bad_checksums == 1
    assert [(r.offset, r.skipped_bytes) for r in decoded.report.resyncs] == [(0, 14)]
    assert decoded.report.warnings[0] == (
        "The image is damaged in 1 place, the first at byte 0: 14 bytes skipped, all packets around kept."
    )


@pytest.mark.parametrize("kept", range(1, 9))
def test_truncated_last_packet_is_said(kept: int) -> None:
    image = IMAGE.rstrip(b"\0")[: -14 + kept]
    decoded = decode_image(image)
    seen = min(kept, 5)  # bytes 6 to 8 of this packet are zeros, which might as well be the card's unwritten rest
    assert decoded.report.packets["accelerometer"] == 1
    assert decoded.report.truncated_tail_bytes == seen
    assert f"cut off after {seen} byte{'s' * (seen > 1)}." in " ".join(decoded.report.warnings)
