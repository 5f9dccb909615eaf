"""Trends through points whose truth is known."""

from __future__ import annotations

import numpy as np
import pytest

from app.science.battery.life import remaining
from app.science.battery.trend import fit_trend

YEAR = 365.25


def test_a_line_is_that_of_weighted_least_squares() -> None:
    rng = np.random.default_rng(3)
    x = np.sort(rng.uniform(0.0, 700.0, 80))
    sd = rng.uniform(0.005, 0.02, 80)
    y = 2.0 - 2e-4 * x + sd * rng.standard_normal(80)
    line = next(one for one in fit_trend(x, y, sd).lines if one.shape == "linear")
    slope, level = np.polyfit(x - x[0], y, 1, w=1.0 / sd)
    assert line.coefficients == pytest.approx([level, slope], rel=0.02)
    _, covariance = np.polyfit(x - x[0], y, 1, w=1.0 / sd, cov="unscaled")
    assert np.sqrt(line.covariance[1, 1]) == pytest.approx(np.sqrt(covariance[0, 0]), rel=0.35)


def test_wild_points_bend_nothing() -> None:
    rng = np.random.default_rng(5)
    x = np.linspace(0.0, 365.0, 40)
    y = 1.0 - 0.05 * x / YEAR + 0.005 * rng.standard_normal(40)
    y[[7, 35]] += [0.4, -0.5]
    trend = fit_trend(x, y, np.full(40, 0.005))
    assert YEAR * trend.slope(x[-1:])[0] == pytest.approx(-0.05, abs=3.0 * YEAR * trend.slope_sd(x[-1:])[0])
    assert trend.at(x[-1:])[0] == pytest.approx(0.95, abs=0.01)


@pytest.mark.parametrize("shape", ["linear", "square root"])
def test_the_band_covers_what_it_says_and_the_shape_is_found(shape: str) -> None:
    rng, inside, found, slopes = np.random.default_rng(11), [], 0, 0
    for _ in range(60):
        x = np.sort(rng.uniform(0.0, 4.0 * YEAR, 120))
        x -= x[0]

        def truth(at: np.ndarray) -> np.ndarray:
            return 1.0 - 0.05 * (at / YEAR if shape == "linear" else np.sqrt(at / YEAR))

        trend = fit_trend(x, truth(x) + 0.008 * rng.standard_normal(120), np.full(120, 0.008))
        everywhere = np.linspace(0.0, 1.5 * x[-1], 60)
        inside.append(np.mean(np.abs(trend.at(everywhere) - truth(everywhere)) < 2.0 * trend.sd(everywhere)))
        found += trend.likeliest.shape == shape
        last = x[-1:]
        steepness = (truth(last + 0.01) - truth(last)) / 0.01
        slopes += bool(abs(trend.slope(last) - steepness)[0] < 2.0 * trend.slope_sd(last)[0])
    assert 0.90 <= np.mean(inside) <= 0.99
    assert found >= 54
    assert slopes >= 52


def test_scatter_that_lasts_widens_the_band() -> None:
    rng = np.random.default_rng(2)
    x = np.arange(100.0)
    lasting = np.convolve(rng.standard_normal(119), np.ones(20) / 20.0, "valid")
    honest = fit_trend(x, 1.0 + 0.01 * rng.standard_normal(100), np.full(100, 0.01))
    wandering = fit_trend(x, 1.0 + 0.2 * lasting, np.full(100, 0.01))
    assert honest.likeliest.together == honest.likeliest.deviation == 0.0
    assert wandering.likeliest.together > 0.7
    assert wandering.likeliest.deviation == pytest.approx(float(np.std(0.2 * lasting)), rel=0.4)
    assert wandering.sd(x[-1:])[0] > 4.0 * honest.sd(x[-1:])[0]


def test_how_long_until_a_limit() -> None:
    x = np.linspace(0.0, 4.0 * YEAR, 200)
    y = 1.0 - 0.03 * x / YEAR + 0.003 * np.random.default_rng(4).standard_normal(200)
    trend = fit_trend(x, y, np.full(200, 0.003))
    left = remaining(trend, 0.8, falling=True)
    truth = 0.2 / 0.03 * YEAR - x[-1]
    assert left.verdict == "expected"
    assert left.low is not None
    assert left.ahead is not None
    assert left.high is not None
    assert left.low < truth < left.high
    assert left.ahead == pytest.approx(truth, rel=0.05)
    assert remaining(trend, 0.95, falling=True).verdict == "reached"
    assert remaining(trend, -3.0, falling=True).verdict == "not in sight"
    grown = remaining(fit_trend(x, 2.0 - y, np.full(200, 0.003)), 1.2, falling=False)
    assert grown.ahead == pytest.approx(left.ahead, rel=1e-6)


def test_a_flat_and_vague_history_tells_no_life() -> None:
    x = np.linspace(0.0, 20.0, 6)
    trend = fit_trend(x, np.full(6, 0.9) + 1e-4 * x, np.full(6, 0.05))
    left = remaining(trend, 0.85, falling=True)
    assert left.verdict == "unknown"
    assert left.ahead is left.high is None


def test_what_points_are_off_by_together_widens_the_level_and_not_the_slope() -> None:
    x = np.linspace(0.0, 100.0, 30)
    y, sd = 1.0 - 1e-3 * x, np.full(30, 0.01)
    alone, shared = fit_trend(x, y, sd), fit_trend(x, y, sd, 0.05)
    assert shared.sd(x) == pytest.approx(np.hypot(alone.sd(x), 0.05))
    assert shared.slope_sd(x) == pytest.approx(alone.slope_sd(x))
