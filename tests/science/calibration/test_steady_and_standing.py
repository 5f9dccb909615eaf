"""Drives that tell nothing: a car that stands, and one that never changes its speed."""

from __future__ import annotations

import numpy as np
import pytest

from app.science.calibration.calibrate import proposals, trip_evidence
from app.science.logger.recording import Recording, series
from app.science.vehicle.model import Vehicle


def recorded(speed_mps: float, seed: int = 5) -> Recording:
    """Ten minutes straight on at one speed, by ticks and by a receiver with its usual noise."""
    rng = np.random.default_rng(seed)
    t, fixes = np.arange(0.0, 600.0, 0.025), np.arange(0.0, 600.0, 0.2)
    axes = {
        name: series(t, mean + 0.1 * rng.standard_normal(len(t)))
        for name, mean in (("ax_mps2", 0.1), ("ay_mps2", -0.05), ("az_mps2", -9.8))
    }
    receiver = {
        "lat_deg": series(fixes, 49.6 + fixes * speed_mps / 111_200.0),
        "lon_deg": series(fixes, np.full(len(fixes), 6.1)),
        "gnss_speed_mps": series(fixes, np.abs(speed_mps + 0.08 * rng.standard_normal(len(fixes)))),
        "utc_s": series(fixes, 1.7e9 + fixes),
    }
    if speed_mps > 1.5:
        receiver["heading_deg"] = series(fixes, 0.3 * rng.standard_normal(len(fixes)))
    ticks = np.arange(1.0, 600.0 * speed_mps / 0.27) * 0.27 / max(speed_mps, 1e-9)
    wheels = {"vss_tick": series(ticks, np.ones(len(ticks)))} if speed_mps else {}
    return Recording(axes | receiver | wheels, 1.7e9)


@pytest.mark.parametrize("speed_mps", [0.0, 25.0])
def test_nothing_is_proposed(speed_mps: float) -> None:
    vehicle = Vehicle()
    found = proposals([trip_evidence(recorded(speed_mps), vehicle)], vehicle)
    assert [one.name for one in found if one.is_applicable] == []
    assert {"mounting", "vss_m_per_tick", "gps_latency"} <= {one.name for one in found if one.confidence == "weak"}


def test_an_empty_recording_says_what_it_lacks() -> None:
    found = proposals([trip_evidence(Recording({}), Vehicle())], Vehicle())
    assert all(one.confidence == "weak" and not one.changes for one in found)
    assert len(found) == 7
    assert proposals([], Vehicle()) == ()
