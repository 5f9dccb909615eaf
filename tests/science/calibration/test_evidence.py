"""Fits that are honest about noise with a memory, and trips put together."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.signal import lfilter

from app.science.calibration.blocks import blocks_of, fit, sd_over_speed
from app.science.calibration.evidence import Estimate, TripEvidence, combine


def coloured(n: int, keep: float, rng: np.random.Generator) -> np.ndarray:
    return np.asarray(lfilter([1.0], [1.0, -keep], rng.standard_normal(n)))


def test_the_claimed_uncertainty_holds_with_coloured_noise_and_outliers() -> None:
    rng = np.random.default_rng(4)
    t = np.arange(0.0, 600.0, 0.1)
    block = blocks_of(t, 20.0)
    pulls, naive = [], []
    for _ in range(200):
        cause = coloured(len(t), 0.98, rng)
        y = 2.0 * cause + coloured(len(t), 0.95, rng)
        y[rng.integers(0, len(t), 30)] += 100.0
        found = fit(cause[:, None], y, block)
        pulls.append((found.value[0] - 2.0) / np.sqrt(found.covariance[0, 0]))
        naive.append(np.std(found.residual) / np.linalg.norm(cause) / np.sqrt(found.covariance[0, 0]))
    assert 0.75 < np.std(pulls) < 1.2
    assert np.median(naive) < 0.6


def test_one_block_that_knows_everything_is_not_believed() -> None:
    rng = np.random.default_rng(6)
    t = np.arange(0.0, 300.0, 0.1)
    cause = np.where(t < 20.0, np.sin(t), 0.0)
    y = cause + 0.1 * rng.standard_normal(len(t))
    found = fit(np.column_stack([cause]), y, blocks_of(t, 20.0))
    assert np.sqrt(found.covariance[0, 0]) > 0.1


def test_scatter_follows_the_speed() -> None:
    rng = np.random.default_rng(7)
    speed = rng.uniform(0.0, 30.0, 20_000)
    sd = sd_over_speed((0.1 + 0.03 * speed) * rng.standard_normal(len(speed)), speed)
    assert sd[np.argmin(np.abs(speed - 21.0))] == pytest.approx(0.73, rel=0.15)
    assert sd[np.argmin(np.abs(speed - 4.0))] == pytest.approx(0.22, rel=0.15)


def trip(value: float, sd: float) -> TripEvidence:
    return TripEvidence({"clock_skew": Estimate.of(np.array([value]), np.array([[sd**2]]))})


def test_trips_count_by_what_they_know() -> None:
    seen = combine([trip(1.0, 0.1), trip(1.05, 0.2)], "clock_skew")
    assert seen is not None
    assert seen.value[0] == pytest.approx(1.01)
    assert seen.sd[0] == pytest.approx(0.1 / np.sqrt(1.25))


def test_trips_that_disagree_widen_the_uncertainty() -> None:
    seen = combine([trip(1.0, 0.1), trip(3.0, 0.1)], "clock_skew")
    assert seen is not None
    assert seen.sd[0] == pytest.approx(1.0)
    assert combine([TripEvidence()], "clock_skew") is None
