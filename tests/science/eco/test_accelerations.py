"""Rises of the speed that are worth the name."""

from __future__ import annotations

import numpy as np
import pytest

from app.science.eco.accelerations import rises


def test_a_rise_is_its_brisk_part() -> None:
    """From 5 to 15 m/s in ten seconds, then drifting up by another 5 m/s over a minute."""
    t = np.arange(0.0, 90.0, 0.1)
    v = np.interp(t, [0.0, 10.0, 20.0, 80.0, 90.0], [5.0, 5.0, 15.0, 20.0, 5.0])
    ((first, last),) = rises(t, v, 1.0)
    assert t[[first, last]] == pytest.approx([10.0, 20.0], abs=0.11)


def test_drifting_up_is_no_acceleration() -> None:
    t = np.arange(0.0, 60.0, 0.1)
    assert rises(t, 10.0 + 10.0 * t / 60.0, 1.0) == []


def test_a_short_hesitation_ends_no_rise_and_a_stop_does() -> None:
    t = np.arange(0.0, 40.0, 0.1)
    v = np.interp(t, [0.0, 8.0, 9.0, 16.0, 20.0, 30.0, 40.0], [2.0, 8.0, 7.8, 14.0, 0.0, 8.0, 8.0])
    found = [(round(float(t[i])), round(float(t[j]))) for i, j in rises(t, v, 1.0)]
    assert found == [(0, 16), (21, 30)]
