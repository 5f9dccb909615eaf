"""Sentences of one moment become one fix."""

from __future__ import annotations

from collections.abc import Callable
from datetime import UTC, datetime
from pathlib import Path

import numpy as np

from app.science.logger.fixes import merge_fixes
from app.science.logger.nmea import parse_nmea
from tests.science.logger import packet_writer as write

MIDNIGHT = datetime(2010, 6, 15, tzinfo=UTC).timestamp()


def test_sentences_of_one_moment_are_one_fix() -> None:
    text = (
        write.gga(3600.2, 7.0, 31.0, alt_m=287.5)
        + write.sentence("GPGSA,A,3,01,02,,,,,,,,,,,1.7,1.4,0.9")
        + write.rmc(3600.2, 7.0, 31.0, knots=36.0)
        + write.sentence("GPVTG,99.0,T,,M,99.00,N,99.00,K,A")
        + write.rmc(3600.4, 7.001, 31.0, knots=37.0)
    )
    fixes = merge_fixes(parse_nmea(text).sentences)
    assert fixes.utc_s.tolist() == [MIDNIGHT + 3600.2, MIDNIGHT + 3600.4]
    assert fixes.first.tolist() == [0, 4]
    assert fixes.valid.tolist() == [True, True]
    np.testing.assert_allclose(fixes.speed_mps, [36 * 1852 / 3600, 37 * 1852 / 3600])  # RMC's, not VTG's
    np.testing.assert_allclose(fixes.lat_deg, [48 + 7 / 60, 48 + 7.001 / 60])
    assert fixes.alt_m[0] == 287.5
    assert np.isnan(fixes.alt_m[1])
    assert fixes.hdop.tolist() == [0.9, 0.9]  # GGA's, and it holds on


def test_speed_comes_from_vtg_when_nothing_else_tells_it() -> None:
    text = write.gga(1.0, 7.0, 31.0) + write.sentence("GPVTG,84.4,T,,M,36.00,N,66.67,K,A")
    fixes = merge_fixes(parse_nmea(text).sentences)
    np.testing.assert_allclose(fixes.speed_mps, [36 * 1852 / 3600])
    assert fixes.course_deg.tolist() == [84.4]
    assert not fixes.has_date
    assert fixes.utc_s.tolist() == [1.0]


def test_one_denial_makes_a_moment_invalid() -> None:
    text = write.gga(1.0, 7.0, 31.0, quality=0) + write.rmc(1.0, 7.0, 31.0)
    text += write.gga(2.0, 7.0, 31.0) + write.rmc(2.0, 7.0, 31.0, ok="V")
    text += write.gga(3.0, 7.0, 31.0) + write.rmc(3.0, 7.0, 31.0)
    assert merge_fixes(parse_nmea(text).sentences).valid.tolist() == [False, False, True]


def test_time_goes_on_over_midnight() -> None:
    before = [write.gga(86_399.6 + 0.2 * i, 7.0, 31.0) for i in range(2)]
    after = [write.gga(0.2 * i, 7.0, 31.0) + write.rmc(0.2 * i, 7.0, 31.0, date="160610") for i in range(3)]
    fixes = merge_fixes(parse_nmea(b"".join([*before, *after])).sentences)
    np.testing.assert_allclose(fixes.utc_s - MIDNIGHT, 86_399.6 + 0.2 * np.arange(5), atol=1e-6)


def test_a_single_wrong_date_changes_nothing() -> None:
    dates = ["150610", "150610", "150680", "150610"]
    text = b"".join(write.rmc(float(t), 7.0, 31.0, date=date) for t, date in enumerate(dates))
    fixes = merge_fixes(parse_nmea(text).sentences)
    np.testing.assert_allclose(fixes.utc_s, MIDNIGHT + np.arange(4.0))


def test_no_text_gives_no_fix() -> None:
    fixes = merge_fixes(parse_nmea(b"").sentences)
    assert len(fixes) == 0
    assert len(merge_fixes(parse_nmea(write.sentence("GPGSA,A,3,01,,,,,,,,,,,,1.7,1.4,0.9")).sentences)) == 0


def test_a_real_receiver_at_standstill(shared_data: Callable[[str], Path]) -> None:
    """A u-blox M9N at 1 Hz on a roof: evenly spaced, one place within metres."""
    log = (shared_data("gpsd-receiver-logs") / "ublox-neo-m9n-nmea.log").read_bytes()
    fixes = merge_fixes(parse_nmea(log).sentences)
    assert len(fixes) == 61
    assert fixes.valid.all()
    np.testing.assert_allclose(np.diff(fixes.utc_s), 1.0)
    assert np.ptp(fixes.lat_deg) * 111_200 < 5.0
    assert fixes.speed_mps.max() < 0.5
