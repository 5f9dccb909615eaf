"""What a car's earlier trips say of its accelerometer's biases: against a least-squares answer, and its limits."""

from __future__ import annotations

import numpy as np
import pytest

from app.science.observer.carry_over import (
    LOAD_SD_MPS2_PER_KG,
    START_SD_MPS2,
    TRIP_TO_TRIP_SD_MPS2,
    BiasPrior,
    FinalBias,
    bias_prior,
)


def trip(i: float, sd: float = 0.01, load_kg: float = 75.0) -> FinalBias:
    return FinalBias((i, 0.0, -i), (sd, sd, sd), load_kg)


def test_without_a_trip_that_measured_them_nothing_is_said() -> None:
    assert bias_prior([], 75.0) is None
    assert bias_prior([trip(0.1, sd=0.25)], 75.0) is None


def test_one_trip_is_believed_as_far_as_trips_differ() -> None:
    prior = bias_prior([trip(0.12)], 75.0)
    assert prior is not None
    assert prior.mean == pytest.approx((0.12, 0.0, -0.12))
    assert prior.sd == pytest.approx([np.hypot(np.hypot(0.01, TRIP_TO_TRIP_SD_MPS2), TRIP_TO_TRIP_SD_MPS2)] * 3)


def test_the_mean_is_the_least_squares_one() -> None:
    """Of trips that agree, so that the change from trip to trip stays a little below what was expected of it."""
    value, sd = np.array([0.10, 0.11, 0.12]), np.array([0.01, 0.05, 0.1])
    prior = bias_prior([trip(v, s) for v, s in zip(value, sd, strict=True)], 75.0)
    assert prior is not None
    change = 4 * TRIP_TO_TRIP_SD_MPS2**2
    first = np.linalg.lstsq(*_whitened(value, sd**2 + TRIP_TO_TRIP_SD_MPS2**2), rcond=None)[0][0]
    change = (change + float(np.sum((value - first) ** 2))) / 6
    design, seen = _whitened(value, sd**2 + change)
    mean = np.linalg.lstsq(design, seen, rcond=None)[0][0]
    assert prior.mean[0] == pytest.approx(mean, rel=1e-12)
    assert prior.sd[0] == pytest.approx(np.sqrt(1.0 / float((design.T @ design)[0, 0]) + change), rel=1e-12)


def _whitened(value: np.ndarray, variance: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    return (1.0 / np.sqrt(variance))[:, None], value / np.sqrt(variance)


def test_trips_that_agree_narrow_it_and_trips_that_scatter_widen_it() -> None:
    one, agreeing, scattered = (
        bias_prior(trips, 75.0)
        for trips in ([trip(0.1)], [trip(0.1)] * 12, [trip(0.1 + 0.2 * (-1) ** n) for n in range(12)])
    )
    assert one is not None
    assert agreeing is not None
    assert scattered is not None
    assert agreeing.sd[0] < 0.6 * one.sd[0]
    assert agreeing.sd[1] == pytest.approx(agreeing.sd[0])
    assert 0.15 < scattered.sd[0] < 0.25
    assert scattered.sd[1] == pytest.approx(agreeing.sd[1])  # sideways they agreed


def test_another_load_widens_pitch_most() -> None:
    same, heavier = (bias_prior([trip(0.1)], load) for load in (75.0, 275.0))
    assert same is not None
    assert heavier is not None
    added = np.sqrt(np.square(heavier.sd) - np.square(same.sd))
    assert added == pytest.approx(200.0 * np.array(LOAD_SD_MPS2_PER_KG))


def test_a_trip_with_the_same_load_counts_more() -> None:
    prior = bias_prior([trip(0.0), trip(0.1, load_kg=475.0)], 75.0)
    assert prior is not None
    assert 0.0 < prior.mean[0] < 0.01


def test_it_is_never_wider_than_not_knowing() -> None:
    prior = bias_prior([trip(0.1), trip(-0.9), trip(0.9)], 75.0)
    assert prior is not None
    assert max(prior.sd) == START_SD_MPS2


def test_an_axis_nobody_measured_starts_as_ever() -> None:
    prior = bias_prior([FinalBias((0.1, 0.1, 0.1), (0.01, 0.29, 0.01), 75.0)], 75.0)
    assert prior is not None
    assert (prior.mean[1], prior.sd[1]) == (0.0, START_SD_MPS2)
    assert isinstance(prior, BiasPrior)
