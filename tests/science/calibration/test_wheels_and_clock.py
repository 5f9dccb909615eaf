"""Metres per tick, the receiver's latency and the clock's skew."""

from __future__ import annotations

from dataclasses import replace

import pytest

from app.science.calibration.calibrate import proposals, trip_evidence
from app.science.calibration.proposal import Proposal
from app.science.logger.recording import Recording, series
from app.science.vehicle.model import Vehicle
from tests.science.calibration.virtual_trips import drive, faster_clock


def proposed(recording: Recording, vehicle: Vehicle, name: str) -> Proposal | None:
    found = proposals([trip_evidence(recording, vehicle)], vehicle)
    return next((one for one in found if one.name == name), None)


@pytest.mark.parametrize("seed", [311, 312])
def test_an_hour_tells_metres_per_tick_within_a_thousandth(seed: int) -> None:
    virtual = drive(seed, 3600.0)
    wrong = replace(virtual.vehicle, vss_m_per_tick=0.25)
    found = proposed(virtual.recording, wrong, "vss_m_per_tick")
    assert found is not None
    (change,) = found.changes
    assert (found.confidence, change.field, change.before) == ("sure", "vss/calibration@metersPerTick", 0.25)
    assert change.after == pytest.approx(virtual.vehicle.vss_m_per_tick, rel=0.0005)
    assert change.after == pytest.approx(virtual.vehicle.vss_m_per_tick, abs=3.0 * change.sd)


def test_it_does_not_depend_on_what_the_file_says() -> None:
    virtual = drive(321, 600.0)
    seen = [
        trip_evidence(virtual.recording, replace(virtual.vehicle, vss_m_per_tick=metres)).estimates["metres_per_tick"]
        for metres in (0.25, 0.29)
    ]
    assert seen[0].value[0] == pytest.approx(seen[1].value[0], rel=3e-4)


def test_positions_alone_do_as_well_as_corners_allow() -> None:
    virtual = drive(312, 3600.0)
    seen = trip_evidence(virtual.recording.without({"gnss_speed_mps"}), virtual.vehicle).estimates["metres_per_tick"]
    assert seen.value[0] == pytest.approx(virtual.vehicle.vss_m_per_tick, rel=0.005)
    assert 0.004 < seen.sd[0] / seen.value[0] < 0.007


def test_a_speed_that_reads_high_gets_a_scale() -> None:
    virtual = drive(312, 3600.0)
    told = virtual.recording["gnss_speed_mps"]
    high = Recording({"speed_mps": series(told.t_s - 0.3, 1.02 * told.value), "gnss_speed_mps": told})
    found = proposed(high, virtual.vehicle, "vss_m_per_tick")
    assert found is not None
    (change,) = found.changes
    assert change.field == "vss/calibration@speedScale"
    assert change.after == pytest.approx(1.0 / 1.02, rel=0.001)


@pytest.mark.parametrize("latency_s", [0.05, 0.6])
def test_a_late_receiver_is_told(latency_s: float) -> None:
    virtual = drive(341, 900.0, latency_s=latency_s)
    seen = trip_evidence(virtual.recording, virtual.vehicle).estimates["gps_latency"]
    assert seen.value[0] == pytest.approx(latency_s, abs=0.03)


def test_a_fast_clock_is_told_and_taken_out_of_the_ticks() -> None:
    virtual = drive(312, 3600.0)
    vehicle = virtual.vehicle
    recording = faster_clock(virtual.recording, 3000.0)
    found = proposed(recording, vehicle, "clock_skew")
    assert found is not None
    assert found.changes[0].after == pytest.approx(3000.0, abs=5.0)
    assert not found.is_applicable
    assert proposed(recording, vehicle, "vss_m_per_tick") is None


def test_without_a_receiver_that_is_said() -> None:
    virtual = drive(321, 600.0)
    deaf = virtual.recording.without({"lat_deg", "lon_deg", "gnss_speed_mps", "utc_s"})
    for name in ("vss_m_per_tick", "gps_latency", "clock_skew"):
        found = proposed(deaf, virtual.vehicle, name)
        assert found is not None
        assert (found.confidence, found.changes) == ("weak", ())
        assert "receiver" in found.evidence[0]
