"""The kernels against filters written down plainly: dense matrices, and filterpy's."""

from __future__ import annotations

from itertools import pairwise

import numpy as np
import pytest

from app.cli.bench.dense_battery import (
    by_state,
    extended_dense,
    seen,
    step_by_state,
    stepped,
    unscented_filterpy,
)
from app.science.arrays import FloatArray
from app.science.battery.curve import OpenCircuit
from app.science.battery.kalman.extended_kernels import extended
from app.science.battery.kalman.layout import STATES, Noise, Rows, Trace
from app.science.battery.kalman.unscented_kernels import unscented

POLYNOMIAL = OpenCircuit(coefficients=(3.1, 0.6, -0.9, 0.7, 0.1), soc_range=(0.1, 0.9))
TABLE = OpenCircuit(points=((0.0, 3.0), (0.2, 3.45), (0.5, 3.6), (0.8, 3.9), (1.0, 4.2)))
MEAN = np.array([np.log(7200.0), np.log(0.01), np.log(2700.0), np.log(0.011), 0.55, 0.002, 0.01])
SD = np.array([0.2, 0.5, 0.5, 0.5, 0.1, 0.01, 0.02])
NOISE = Noise(4e-6, 1e-4, np.array([1e-9, 1e-8, 1e-8, 1e-8, 0.0, 0.0, 1e-12]), 5.0, MEAN[:4] - 9.0, MEAN[:4] + 9.0)


def some_rows(count: int, *, gaps: bool = False) -> Rows:
    """Return rows of a cell that is not quite as it is thought to be, at a changing temperature."""
    rng = np.random.default_rng(7)
    t_s = np.cumsum(rng.choice([0.5, 1.0, 3.0], count))
    current = 3.0 * np.sin(t_s / 9.0) - 0.5 + rng.normal(0.0, 0.3, count)
    current[40:60] = 0.0
    factors = [1.0 + depth * np.sin(t_s / 50.0) for depth in (0.1, 0.2, -0.05)]
    volts = np.empty(count)
    state = MEAN + 0.2 * SD
    for k in range(count):
        volts[k] = seen(state, TABLE.pieces, current[k], factors[0][k]) + rng.normal(0.0, 2e-3)
        if k + 1 < count:
            state = stepped(state, current[k], t_s[k + 1] - t_s[k], (factors[1][k], factors[2][k]))
    if gaps:
        volts[20:25] = np.nan
        volts[30] += 1.0
    return Rows(t_s, current, volts, *factors)


def empty_trace(count: int) -> Trace:
    return Trace(np.empty(count), np.empty(count), np.empty((count, STATES)), np.empty((count, STATES)))


@pytest.mark.parametrize("curve", [POLYNOMIAL, TABLE])
def test_the_extended_filter_is_the_one_of_dense_matrices(curve: OpenCircuit) -> None:
    rows = some_rows(400, gaps=True)
    trace, mean, covariance = empty_trace(400), MEAN.copy(), np.diag(SD**2)
    dense = extended_dense(rows, curve.pieces, NOISE, MEAN, np.diag(SD**2))
    extended(rows, 0, 400, 0, curve.pieces, NOISE, mean, covariance, np.zeros(0), np.arange(400), trace)
    np.testing.assert_allclose(trace.means, dense.mean, rtol=1e-9, atol=1e-10)
    np.testing.assert_allclose(trace.variances, np.diagonal(dense.covariance, axis1=1, axis2=2), rtol=1e-7)
    np.testing.assert_allclose(covariance, dense.covariance[-1], rtol=1e-6, atol=1e-12)


def test_the_unscented_filter_is_filterpys() -> None:
    rows = some_rows(300)
    wide = NOISE._replace(gate=1e9)
    trace, mean, covariance = empty_trace(300), MEAN.copy(), np.diag(SD**2)
    reference = unscented_filterpy(rows, TABLE.pieces, wide, MEAN, np.diag(SD**2))
    unscented(rows, 0, 300, 0, TABLE.pieces, wide, mean, covariance, np.arange(300), trace)
    np.testing.assert_allclose(trace.means, reference.mean, rtol=1e-7, atol=1e-9)
    np.testing.assert_allclose(trace.variances, np.diagonal(reference.covariance, axis1=1, axis2=2), rtol=1e-6)


def test_two_stretches_are_one() -> None:
    rows = some_rows(300, gaps=True)
    results: list[FloatArray] = []
    for bounds in ((0, 300), (0, 117, 300)):
        mean, covariance = MEAN.copy(), np.diag(SD**2)
        for first, last in pairwise(bounds):
            extended(
                rows, first, last, 0, TABLE.pieces, NOISE, mean, covariance, np.zeros(0),
                np.arange(300), empty_trace(300),
            )  # fmt: skip
        results.append(np.concatenate([mean, covariance.ravel()]))
    np.testing.assert_array_equal(results[0], results[1])


def test_linearising_about_the_truth_of_a_linear_model_changes_nothing() -> None:
    # With a straight curve, parameters that are known and no error of the sensor, the model is linear.
    line = OpenCircuit(coefficients=(3.2, 0.7))
    rows, constant = some_rows(200), NOISE._replace(walks=np.zeros(STATES))
    sd = np.array([0.0, 0.0, 0.0, 0.0, 0.1, 0.01, 0.0])
    means = []
    for nominal in (np.zeros(0), MEAN + np.array([0.0, 0.0, 0.0, 0.0, 0.2, -0.01, 0.0])):
        mean, covariance = MEAN.copy(), np.diag(sd**2)
        extended(rows, 0, 200, 0, line.pieces, constant, mean, covariance, nominal, np.arange(200), empty_trace(200))
        means.append(mean)
    np.testing.assert_allclose(means[1], means[0], rtol=1e-10, atol=1e-12)


def test_rows_before_the_start_are_compared_and_not_learnt_from() -> None:
    rows = some_rows(100)
    trace, mean, covariance = empty_trace(100), MEAN.copy(), np.diag(SD**2)
    extended(rows, 0, 100, 100, TABLE.pieces, NOISE, mean, covariance, np.zeros(0), np.arange(100), trace)
    assert np.isfinite(trace.residual_v).all()
    np.testing.assert_array_equal(mean[:4], MEAN[:4])
    moved = np.sum((rows.current_a[:-1] - MEAN[6]) * np.diff(rows.t_s) / rows.capacity_factor[:-1]) / 7200.0
    assert mean[4] == pytest.approx(0.55 + moved, rel=1e-12)


@pytest.mark.parametrize("extra", [0.0, 0.004])
def test_the_references_derivatives_are_those_of_its_model(extra: float) -> None:
    state, step = np.append(MEAN, extra), 1e-6
    for j in range(STATES + 1):
        up, down = state.copy(), state.copy()
        up[j], down[j] = up[j] + step, down[j] - step
        numeric = (seen(up, TABLE.pieces, 2.0) - seen(down, TABLE.pieces, 2.0)) / (2.0 * step)
        plain = by_state(np.append(MEAN, 0.0), TABLE.pieces, 2.0 - extra)
        assert plain[j] == pytest.approx(numeric, abs=1e-7)
        numerics = (stepped(up, 2.0, 3.0) - stepped(down, 2.0, 3.0)) / (2.0 * step)
        np.testing.assert_allclose(step_by_state(np.append(MEAN, 0.0), 2.0 - extra, 3.0)[:, j], numerics, atol=1e-8)
