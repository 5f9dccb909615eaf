"""Fixes on the logger's clock: the known truth is put in, delayed and drifting, and must come out."""

from __future__ import annotations

import numpy as np
import pytest

from app.science.arrays import FloatArray
from app.science.logger.gnss_clock import align_fixes

UTC_0 = 1_276_603_200.0


def arrivals(t_s: FloatArray, latency_s: float, jitter_s: float, seed: int = 0) -> FloatArray:
    """Late by a constant and by an exponentially distributed rest."""
    return t_s + latency_s + np.random.default_rng(seed).exponential(jitter_s, len(t_s))


@pytest.mark.parametrize("rate_ppm", [0.0, 50.0, -8000.0])
@pytest.mark.parametrize("minutes", [0.5, 3.0, 60.0])
def test_the_varying_latency_goes_the_constant_one_stays(rate_ppm: float, minutes: float) -> None:
    utc = UTC_0 + np.arange(0.0, 60 * minutes, 0.2)
    truth = 12.0 + (utc - UTC_0) * (1 + 1e-6 * rate_ppm)
    times = align_fixes(utc, arrivals(truth, 0.08, 0.02))
    assert times.used.all()
    np.testing.assert_allclose(times.t_s - 0.08, truth, atol=0.015)
    assert np.sqrt(np.mean((times.t_s - 0.08 - truth) ** 2)) < 0.005
    if minutes >= 3.0:
        assert times.rate_ppm == pytest.approx(rate_ppm, abs=60.0)
    assert 0.03 < times.latency_spread_s < 0.09


def test_a_clock_whose_rate_wanders_is_followed() -> None:
    """An RC oscillator that warms up: one per cent off at first, three tenths of a per cent later."""
    utc = UTC_0 + np.arange(0.0, 3600.0, 0.2)
    x = utc - UTC_0
    truth = 5.0 + 1.003 * x + 0.007 * 600.0 * (1 - np.exp(-x / 600.0))
    times = align_fixes(utc, arrivals(truth, 0.05, 0.01))
    np.testing.assert_allclose(times.t_s - 0.05, truth, atol=0.03)
    np.testing.assert_allclose(times.t_s[x > 300] - 0.05, truth[x > 300], atol=0.015)


def test_fixes_stay_even_through_an_outage() -> None:
    x = np.concatenate([np.arange(0.0, 600.0, 0.2), np.arange(900.0, 1500.0, 0.2)])
    times = align_fixes(UTC_0 + x, arrivals(x, 0.05, 0.03))
    np.testing.assert_allclose(np.diff(times.t_s), np.diff(x), atol=0.003, rtol=2e-5)


def test_wrong_utc_is_left_out() -> None:
    x = np.arange(0.0, 300.0, 0.2)
    arrival = arrivals(x, 0.05, 0.01)
    utc = UTC_0 + x
    utc[700] += 3600.0
    utc[701] -= 15.0
    times = align_fixes(utc, arrival)
    assert np.flatnonzero(~times.used).tolist() == [700, 701]
    np.testing.assert_allclose(times.t_s[times.used] - 0.05, np.delete(x, [700, 701]), atol=0.01)


@pytest.mark.parametrize("count", [1, 2, 3, 9, 11])
def test_few_fixes_are_enough(count: int) -> None:
    x = np.arange(count) * 1.0
    times = align_fixes(UTC_0 + x, x + 7.0)
    np.testing.assert_allclose(times.t_s, x + 7.0, atol=1e-6)


def test_no_fix_is_no_trouble() -> None:
    times = align_fixes(np.empty(0), np.empty(0))
    assert len(times.t_s) == 0
